"""What is registered as the policy ``bc-rnn``."""

from collections.abc import Sequence
from pathlib import Path

from prime_core.contracts.demonstration import Demonstration
from prime_core.contracts.policy import MotorPolicy, MotorPolicyConfig
from prime_core.contracts.training import ModelContext, TrainingContext
from prime_policies.motor.settings import BcRnnSettings


class BcRnnConfig(MotorPolicyConfig, BcRnnSettings):
    """An LSTM with a mixture of Gaussians of the next motor action (Mandlekar et al. 2021).

    With ``pretrain`` it is BC-RNN (FT) of the paper: trained on all motor actions of the rollouts,
    then on the demonstrations.
    """

    def count_checkpoints(self) -> int:
        """Return how many are kept of the epochs on the demonstrations."""
        return len(self.kept_epochs)

    def check_device(self, device: str) -> None:
        """Ask torch for it; see `TrainableConfig`."""
        from prime_policies.training.devices import torch_device

        torch_device(device)

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
