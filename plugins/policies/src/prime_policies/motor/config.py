"""What is registered as the policy ``bc-rnn``, and what it shares with others."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from prime_core.contracts.demonstration import Demonstration
from prime_core.contracts.policy import MotorPolicy, MotorPolicyConfig
from prime_core.contracts.training import ModelContext, TrainingContext
from prime_policies.motor.settings import BcRnnSettings
from prime_policies.training.settings import TorchTrainable


class TrainedMotorConfig(TorchTrainable, MotorPolicyConfig):
    """A policy over motor actions that the training loop trains and keeps checkpoints of.

    What is registered has `MotorTrainingSettings` beside it.
    """

    if TYPE_CHECKING:
        kept_epochs: list[int]

    def count_checkpoints(self) -> int:
        """Return how many are kept of the epochs on the demonstrations."""
        return len(self.kept_epochs)


class BcRnnConfig(TrainedMotorConfig, BcRnnSettings):
    """An LSTM with a mixture of Gaussians of the next motor action (Mandlekar et al. 2021).

    With ``pretrain`` it is BC-RNN (FT) of the paper: trained on all motor actions of the rollouts,
    then on the demonstrations.
    """

    def fit(
        self,
        rollouts: Sequence[Demonstration] | None,
        demonstrations: Sequence[Demonstration],
        context: TrainingContext,
    ) -> Sequence[Path]:
        """Train the network on windows of episodes; see `MotorPolicyConfig`."""
        from prime_policies.motor.bc_rnn import bc_rnn
        from prime_policies.motor.fitting import fit_network

        shown_before = rollouts if self.pretrain else None
        return fit_network(bc_rnn(self), shown_before, demonstrations, context)

    def load(self, checkpoint: Path, context: ModelContext) -> MotorPolicy:
        """Load the network of a checkpoint; see `MotorPolicyConfig`."""
        from prime_policies.motor.bc_rnn import bc_rnn
        from prime_policies.motor.fitting import load_network
        from prime_policies.motor.policy import BcRnnPolicy

        return BcRnnPolicy(*load_network(bc_rnn(self), checkpoint, context), self.horizon)
