"""Perceptrons on the features of one instant, or of a pair of them."""

from itertools import pairwise

import torch
from torch import Tensor, nn
from torch.nn import functional

CLIP = 5.0  # normalised features beyond it are outside of everything seen in training
LEAST_SPREAD = 1e-3  # of a feature: one that hardly varies would be all noise once normalised


class Trunk(nn.Module):
    """Normalises features, joins those of a pair, and passes them through a perceptron.

    A pair enters as [f, f', f' - f]. The first layer is linear in it, so its value is a sum of
    a part of either instant: `halves` gives the parts, and `finish` does the rest.

    Args:
        features: Number of features of an instant.
        pair: Whether it sees pairs.
        hidden: Widths of the hidden layers.
        noise: Standard deviation of the noise on normalised inputs while training.

    Attributes:
        width: Of the last hidden layer.
    """

    def __init__(self, features: int, pair: bool, hidden: tuple[int, ...], noise: float) -> None:
        super().__init__()
        self._pair, self._noise, self.width = pair, noise, hidden[-1]
        self.mean = nn.Buffer(torch.zeros(features))
        self.scale = nn.Buffer(torch.ones(features))
        self.difference_scale = nn.Buffer(torch.ones(features))
        self.first = nn.Linear(3 * features if pair else features, hidden[0])
        layers: list[nn.Module] = []
        for before, after in pairwise(hidden):
            layers += [nn.Linear(before, after), nn.ReLU()]
        self.rest = nn.Sequential(*layers)

    def measure(self, features: Tensor) -> None:
        """Take mean and spread of examples' features ``(n, 1 or 2, features)`` to normalise by."""
        seen = features.double()
        flat = seen.flatten(end_dim=1)
        self.mean.copy_(flat.mean(dim=0))
        self.scale.copy_(flat.std(dim=0, correction=0).clamp_min(LEAST_SPREAD))
        if self._pair:
            spread = (seen[:, 1] - seen[:, 0]).std(dim=0, correction=0)
            self.difference_scale.copy_(spread.clamp_min(LEAST_SPREAD))

    def forward(self, features: Tensor, generator: torch.Generator | None = None) -> Tensor:
        """Return the last hidden layer of features ``(n, 1 or 2, features)``.

        The generator is of the input noise; None for no noise.
        """
        inputs = self.inputs(features)
        if generator is not None and self._noise:
            noise = torch.randn(inputs.shape, generator=generator).to(inputs.device)
            inputs = inputs + self._noise * noise
        return self.finish(self.first(inputs))

    def inputs(self, features: Tensor) -> Tensor:
        """Return the normalised inputs, of pairs joined, ``(n, inputs)``."""
        normal = self._normalise(features)
        if not self._pair:
            return normal[:, 0]
        start, end = normal[:, 0], normal[:, 1]
        difference = (end - start) * (self.scale / self.difference_scale)
        return torch.cat((start, end, difference), dim=1)

    def halves(self, features: Tensor) -> tuple[Tensor, Tensor]:
        """Return what each instant adds to the first layer as the start and as the end of a pair.

        Of features ``(N, features)``, two times ``(N, hidden)``.
        """
        normal = self._normalise(features)
        start, end, difference = self.first.weight.chunk(3, dim=1)
        difference = difference * (self.scale / self.difference_scale)
        return normal @ (start - difference).T + self.first.bias, normal @ (end + difference).T

    def finish(self, first: Tensor) -> Tensor:
        """Return the last hidden layer from the first one's value before its rectifier."""
        return self.rest(functional.relu(first))

    def _normalise(self, features: Tensor) -> Tensor:
        return ((features - self.mean) / self.scale).clamp(-CLIP, CLIP)
