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
        mean, spread = mean_and_spread(features)
        self.mean.copy_(mean)
        self.scale.copy_(spread.clamp_min(LEAST_SPREAD))
        low, high = least_and_greatest(actions)
        self.low.copy_(low)
        self.high.copy_(high)

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


def mean_and_spread(parts: Sequence[Tensor]) -> tuple[Tensor, Tensor]:
    """Return mean and standard deviation of each number, of all steps.

    Args:
        parts: Of the steps, each ``(N, numbers)``; no part is copied whole in double precision.
    """
    count = sum(map(len, parts))
    mean = torch.stack([part.sum(dim=0, dtype=torch.float64) for part in parts]).sum(dim=0) / count
    squares = ((part - mean.to(part.dtype)).square_() for part in parts)
    spread = torch.stack([part.sum(dim=0, dtype=torch.float64) for part in squares]).sum(dim=0)
    return mean, (spread / count).sqrt()


def least_and_greatest(parts: Sequence[Tensor]) -> tuple[Tensor, Tensor]:
    """Return least and greatest of each number, of all steps in parts ``(N, numbers)``."""
    least = torch.stack([part.amin(dim=0) for part in parts]).amin(dim=0)
    return least, torch.stack([part.amax(dim=0) for part in parts]).amax(dim=0)
