"""The ranges of what a policy over motor actions sees and does."""

from collections.abc import Sequence

import torch
from torch import Tensor, nn

from prime_policies.networks.trunk import CLIP, LEAST_SPREAD


class Scaling(nn.Module):
    """Normalises features as `Trunk` does, and actions to [-1, 1].

    Args:
        features: How many.
        actions: Numbers of an action.
    """

    def __init__(self, features: int, actions: int) -> None:
        super().__init__()
        self.mean, self.scale = (nn.Buffer(torch.zeros(features)) for _ in range(2))
        self.low, self.high = (nn.Buffer(torch.zeros(actions)) for _ in range(2))

    def measure(self, features: Sequence[Tensor], actions: Sequence[Tensor]) -> None:
        """Take the features' mean and spread, and the least and greatest of each action's number.

        Args:
            features: Of all steps that are learnt from, in parts, each ``(N, features)``.
            actions: Likewise, ``(N, A)``.
        """
        count = sum(map(len, features))
        mean = sum(part.sum(dim=0, dtype=torch.float64) for part in features) / count
        self.mean.copy_(mean)
        squares = ((part - self.mean).square_() for part in features)
        spread = sum(part.sum(dim=0, dtype=torch.float64) for part in squares) / count
        self.scale.copy_(spread.sqrt().clamp_min(LEAST_SPREAD))
        self.low.copy_(torch.stack([part.amin(dim=0) for part in actions]).amin(dim=0))
        self.high.copy_(torch.stack([part.amax(dim=0) for part in actions]).amax(dim=0))

    def inputs(self, features: Tensor) -> Tensor:
        """Return features ``(..., features)`` normalised."""
        return ((features - self.mean) / self.scale).clamp(-CLIP, CLIP)

    def targets(self, actions: Tensor) -> Tensor:
        """Return actions ``(..., A)`` in [-1, 1]; a number that never varies is 0."""
        middle, half = self._range()
        return (actions - middle) / torch.where(half > 0, half, 1.0)

    def actions(self, targets: Tensor) -> Tensor:
        """Return the actions that `targets` would be of, within their range."""
        middle, half = self._range()
        return torch.minimum(torch.maximum(middle + half * targets, self.low), self.high)

    def _range(self) -> tuple[Tensor, Tensor]:
        return (self.high + self.low) / 2, (self.high - self.low) / 2
