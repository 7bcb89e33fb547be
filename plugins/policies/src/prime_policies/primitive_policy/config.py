"""What is registered as the policy ``prime``."""

from collections.abc import Sequence
from pathlib import Path

from pydantic import Field

from prime_core.configuration import Count
from prime_core.contracts.policy import PrimitivePolicy, PrimitivePolicyConfig
from prime_core.contracts.training import CallData, ModelContext, TrainingContext
from prime_policies.training.settings import NetworkSettings


class PrimePolicySettings(NetworkSettings):
    """How its two networks are pretrained and fine-tuned."""

    kind = "prime"
    version = 4
    pair = False

    components: int = Field(12, ge=2, le=64)
    """Gaussians in a mixture of parameters. With pretraining, half of them start where parameters
    of rollouts gather, half where those of demonstrations do."""
    minimum_deviation: float = Field(0.02, ge=1e-4, le=1)
    """Least standard deviation of a Gaussian, of parameters normalised to [-1, 1]: about what the
    parameters of parsed demonstrations are known to. With less, components learn by heart."""
    input_noise: float = Field(0.3, ge=0, le=10)
    """Standard deviation of the noise on normalised inputs while training: demonstrations show few
    of the scenes that a policy comes to, and with less noise it is too sure of itself elsewhere."""
    pretraining_epochs: Count = 8
    """Epochs of each network on the rollouts."""
    finetuning_epochs: int = Field(10, ge=1, le=1000)
    """Epochs of each network on the demonstrations; a checkpoint is kept after each."""
    finetuning_steps_per_epoch: Count = 200
    """Steps of an epoch on the demonstrations."""


class PrimePolicyConfig(PrimitivePolicyConfig, PrimePolicySettings):
    """A classifier of the next primitive and a task-parameterised mixture of its parameters.

    Both are pretrained on the rollouts, if asked, and then fine-tuned on the demonstrations.
    """

    def count_checkpoints(self) -> int:
        """Return one for each epoch of fine-tuning."""
        return self.finetuning_epochs

    def fit(
        self, rollouts: CallData | None, demonstrations: CallData, context: TrainingContext
    ) -> Sequence[Path]:
        """Train both networks, one after the other; see `PrimitivePolicyConfig`."""
        from prime_policies.training.fitting import Phase, fit_networks

        epochs, steps = (self.finetuning_epochs,) * 2, self.finetuning_steps_per_epoch
        folders = [context.folder / f"checkpoint_{n + 1:02d}" for n in range(epochs[0])]
        phases = [Phase(demonstrations, epochs, steps, checkpoints=folders)]
        if rollouts is not None and self.pretrain:
            epochs = (self.pretraining_epochs,) * 2
            phases.insert(0, Phase(rollouts, epochs, self.steps_per_epoch, suffix=".pretrained"))
        fit_networks(self, phases, context)
        return folders

    def load(self, checkpoint: Path, context: ModelContext) -> PrimitivePolicy:
        """Load the two networks of a checkpoint; see `PrimitivePolicyConfig`."""
        from prime_policies.primitive_policy.policy import PrimePolicy
        from prime_policies.training.call_networks import CallNetworks

        return PrimePolicy(CallNetworks.load(self, checkpoint, context))
