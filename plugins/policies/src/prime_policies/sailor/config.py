"""What is registered as the policy ``sailor``."""

from collections.abc import Sequence
from pathlib import Path

from pydantic import field_validator

from prime_core.contracts.demonstration import Demonstration
from prime_core.contracts.policy import MotorPolicy
from prime_core.contracts.training import ModelContext, TrainingContext
from prime_core.errors import DatasetError
from prime_policies.motor.config import TrainedMotorConfig
from prime_policies.sailor.settings import SailorSettings


class SailorConfig(TrainedMotorConfig, SailorSettings):
    """Skills learnt from the rollouts, and a policy that says which one comes next.

    After SAILOR (Nasiriany et al. 2022).
    """

    pretrain: bool = True
    """Always: skills are learnt from the rollouts."""

    @field_validator("pretrain")
    @classmethod
    def _skills_are_learnt_from_rollouts(cls, pretrain: bool) -> bool:
        if not pretrain:
            raise ValueError(
                "found false: sailor learns its skills from the rollouts and nothing else, so it "
                "must be true. A policy that learns from demonstrations alone is bc-rnn"
            )
        return pretrain

    def fit(
        self,
        rollouts: Sequence[Demonstration] | None,
        demonstrations: Sequence[Demonstration],
        context: TrainingContext,
    ) -> Sequence[Path]:
        """Train the skills, then the policy; see `MotorPolicyConfig`."""
        from prime_policies.sailor.fitting import fit_sailor

        if rollouts is None:
            raise DatasetError("sailor learns its skills from rollouts, and was given none")
        return fit_sailor(self, rollouts, demonstrations, context)

    def load(self, checkpoint: Path, context: ModelContext) -> MotorPolicy:
        """Load policy and decoder of a checkpoint; see `MotorPolicyConfig`."""
        from prime_policies.sailor.fitting import load_sailor
        from prime_policies.sailor.policy import SailorPolicy

        return SailorPolicy(*load_sailor(self, checkpoint, context), self)
