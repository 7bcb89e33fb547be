"""The network of ``bc-rnn``: an LSTM with a mixture of Gaussians of the next motor action."""

import torch
from torch import Tensor, nn
from torch.nn import functional

from prime_policies.motor.fitting import Design, MotorNetwork
from prime_policies.motor.scaling import Scaling
from prime_policies.motor.settings import BcRnnSettings
from prime_policies.motor.windows import WindowBatch
from prime_policies.networks.mixture import Mixture, log_density

Memory = tuple[Tensor, Tensor]
"""State of the recurrent layers: hidden and cell state."""


class BcRnn(MotorNetwork):
    """p(action | what was seen in this window so far), normalised.

    Args:
        features: Numbers of an instant.
        actions: Numbers of an action.
        settings: How large it is.

    Attributes:
        scaling: Of features and actions.
    """

    def __init__(self, features: int, actions: int, settings: BcRnnSettings) -> None:
        super().__init__()
        self._shape = (settings.components, actions)
        self._minimum_deviation = settings.minimum_deviation
        self.scaling = Scaling(features, actions)
        self.recurrent = nn.LSTM(features, settings.hidden, settings.layers, batch_first=True)
        self.head = nn.Linear(settings.hidden, settings.components * (1 + 2 * actions))

    def forward(self, features: Tensor, memory: Memory | None = None) -> tuple[Mixture, Memory]:
        """Return the mixture of each step's action, and the memory after the last one.

        Args:
            features: Of windows, ``(n, T, features)``.
            memory: Of the steps before; None where there are none.

        Returns:
            A batch of ``n * T`` mixtures, of actions normalised to [-1, 1], and the memory.
        """
        hidden, memory = self.recurrent(self.scaling.inputs(features), memory)
        components, actions = self._shape
        numbers = self.head(hidden.flatten(end_dim=1))
        logits, means, spreads = numbers.split(
            (components, components * actions, components * actions), dim=1
        )
        deviations = functional.softplus(spreads) + self._minimum_deviation
        mixture = Mixture(
            logits,
            means.tanh().unflatten(1, self._shape),
            deviations.unflatten(1, self._shape),
            numbers.new_zeros(actions),
        )
        return mixture, memory

    def loss(self, batch: WindowBatch, generator: torch.Generator) -> Tensor:
        """Return the mean negative log likelihood of the actions; there is no noise."""
        mixture, _ = self(batch.features)
        return -log_density(mixture, self.scaling.targets(batch.actions).flatten(end_dim=1)).mean()


def bc_rnn(settings: BcRnnSettings) -> Design[BcRnn]:
    """Return what is trained as ``bc-rnn``."""

    def build(features: int, actions: int) -> BcRnn:
        return BcRnn(features, actions, settings)

    return Design("bc-rnn", 1, settings, build, settings.horizon)
