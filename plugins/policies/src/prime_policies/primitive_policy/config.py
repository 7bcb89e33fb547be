"""Settings of the policy ``prime``."""

from collections.abc import Sequence
from pathlib import Path

from pydantic import Field

from prime_core.contracts.policy import PrimitivePolicy, PrimitivePolicyConfig
from prime_core.contracts.training import CallData, ModelContext, TrainingContext
from prime_policies.training.settings import NetworkSettings


class PrimePolicyConfig(PrimitivePolicyConfig, NetworkSettings):
    """A classifier of the next primitive and a task-parameterised mixture of its parameters.

    Both are pretrained on the rollouts, if asked, and then fine-tuned on the demonstrations.
    """

    components: int = Field(12, ge=2)
    """Gaussians in a mixture of parameters. With pretraining, half of them start where parameters
    of rollouts gather, half where those of demonstrations do."""
    minimum_deviation: float = Field(0.02, gt=0)
    """Least standard deviation of a Gaussian, of parameters normalised to [-1, 1]: about what the
    parameters of parsed demonstrations are known to. With less, components learn by heart."""
    pretraining_epochs: int = Field(8, ge=1)
    """Epochs of each network on the rollouts."""
    finetuning_epochs: int = Field(10, ge=1)
    """Epochs of each network on the demonstrations; a checkpoint is kept after each."""
    finetuning_steps_per_epoch: int = Field(200, ge=1)
    """Steps of an epoch on the demonstrations."""

    def count_checkpoints(self) -> int:
        """Return one for each epoch of fine-tuning."""
        return self.finetuning_epochs

    def fit(
        self, rollouts: CallData | None, demonstrations: CallData, context: TrainingContext
    ) -> Sequence[Path]:
        """Train both networks, one after the other; see `PrimitivePolicyConfig`."""
        from prime_policies.primitive_policy.training import fit_policy

        return fit_policy(self, rollouts, demonstrations, context)

    def load(self, checkpoint: Path, context: ModelContext) -> PrimitivePolicy:
        """Load the two networks of a checkpoint; see `PrimitivePolicyConfig`."""
        from prime_policies.primitive_policy.training import load_policy

        return load_policy(self, checkpoint, context)
