"""What is registered as the policy ``prime``."""

from collections.abc import Sequence
from pathlib import Path

from prime_core.contracts.policy import PrimitivePolicy, PrimitivePolicyConfig
from prime_core.contracts.training import CallData, ModelContext, TrainingContext
from prime_policies.primitive_policy.settings import PrimePolicySettings


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
        from prime_policies.primitive_policy.training import fit_policy

        return fit_policy(self, rollouts if self.pretrain else None, demonstrations, context)

    def load(self, checkpoint: Path, context: ModelContext) -> PrimitivePolicy:
        """Load the two networks of a checkpoint; see `PrimitivePolicyConfig`."""
        from prime_policies.primitive_policy.training import load_policy

        return load_policy(self, checkpoint, context)
