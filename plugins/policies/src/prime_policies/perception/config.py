"""What is registered as the IDM ``mlp-gmm-images`` and the policy ``prime-images``."""

from collections.abc import Sequence
from pathlib import Path

from prime_core.contracts.idm import InverseDynamicsModel
from prime_core.contracts.observations import Modality
from prime_core.contracts.policy import PrimitivePolicy
from prime_core.contracts.training import CallData, ModelContext, TrainingContext
from prime_policies.idm.config import MlpGmmIdmConfig
from prime_policies.perception.settings import SEES, PerceptionSettings
from prime_policies.primitive_policy.config import PrimePolicyConfig


class ImageIdmConfig(MlpGmmIdmConfig):
    """``mlp-gmm`` on object poses that a network tells from images.

    The simulator's poses teach that network, on the frames of the rollouts; at work it has none.
    """

    kind = "mlp-gmm-images"

    perception: PerceptionSettings = PerceptionSettings()
    """How it sees."""

    @property
    def modalities(self) -> tuple[Modality, ...]:
        """Images, and the robot's state."""
        return SEES

    def fit(self, data: CallData, context: TrainingContext) -> InverseDynamicsModel:
        """Train the perception, then both networks on what it sees; see `IdmConfig`."""
        from prime_policies.perception.models import ImageIdm
        from prime_policies.perception.perception import Perception

        perception = Perception.fit(self.perception, data, context)
        return ImageIdm(perception, super().fit(perception.through(data), context))

    def load(self, folder: Path, context: ModelContext) -> InverseDynamicsModel:
        """Load all three networks; see `IdmConfig`."""
        from prime_policies.perception.models import ImageIdm
        from prime_policies.perception.perception import Perception

        perception = Perception.load(self.perception, folder, context)
        return ImageIdm(perception, super().load(folder, context))


class ImagePolicyConfig(PrimePolicyConfig):
    """``prime`` on object poses that a network tells from images.

    The simulator's poses teach that network: on the frames of the rollouts, or of the
    demonstrations where the policy is not pretrained. At work it has none.
    """

    kind = "prime-images"

    perception: PerceptionSettings = PerceptionSettings()
    """How it sees."""

    @property
    def modalities(self) -> tuple[Modality, ...]:
        """Images, and the robot's state."""
        return SEES

    def fit(
        self, rollouts: CallData | None, demonstrations: CallData, context: TrainingContext
    ) -> Sequence[Path]:
        """Train the perception, then both networks; see `PrimitivePolicyConfig`."""
        from prime_policies.perception.perception import Perception

        if rollouts is None or not self.pretrain:
            perception = Perception.fit(self.perception, demonstrations, context)
            seen = None
        else:
            perception = Perception.fit(self.perception, rollouts, context)
            seen = perception.through(rollouts)
        return super().fit(seen, perception.through(demonstrations), context)

    def load(self, checkpoint: Path, context: ModelContext) -> PrimitivePolicy:
        """Load the perception and the two networks of a checkpoint; see `PrimitivePolicyConfig`."""
        from prime_policies.perception.models import ImagePolicy
        from prime_policies.perception.perception import Perception

        perception = Perception.load(self.perception, checkpoint.parent, context)
        return ImagePolicy(perception, super().load(checkpoint, context))
