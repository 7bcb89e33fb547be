"""What is registered as the perception ``pose-network``."""

from pathlib import Path

from prime_core.contracts.observations import Observations
from prime_core.contracts.perception import Perception, PerceptionConfig
from prime_core.contracts.training import ModelContext, TrainingContext
from prime_policies.perception.settings import PoseNetworkSettings
from prime_policies.training.settings import TorchTrainable


class PoseNetworkConfig(TorchTrainable, PerceptionConfig, PoseNetworkSettings):
    """A network that tells each object's pose; the simulator's poses teach it."""

    def fit(self, seen: Observations, context: TrainingContext) -> Perception:
        """Train the network; see `PerceptionConfig`."""
        from prime_policies.perception.perception import PosePerception

        return PosePerception.fit(self, seen, context)

    def load(self, folder: Path, context: ModelContext) -> Perception:
        """Load the network; see `PerceptionConfig`."""
        from prime_policies.perception.perception import PosePerception

        return PosePerception.load(self, folder, context)
