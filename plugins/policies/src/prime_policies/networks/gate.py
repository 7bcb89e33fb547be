"""What a component of a mixture weighs because of where its mean is."""

import math

import torch
from torch import Tensor, nn

from prime_core.learning.parameter_layout import ParameterLayout

HIDDEN = 64  # units of a layer: it sees a handful of numbers


class Gate(nn.Module):
    """One perceptron for all components of a primitive, on a component's mean alone.

    Rollouts hold only what the arm can do. So it learns from them where a wall is in the hand's
    way, for whichever component would go there; a weight by the component's number would have to
    learn it for each anew.
    """

    def __init__(self, layout: ParameterLayout) -> None:
        super().__init__()
        self._turns = [
            2 * math.pi * scale / period if period else 0.0
            for scale, period in zip(layout.scales, layout.periods, strict=True)
        ]
        self.layers = nn.Sequential(
            nn.Linear(len(self._turns) + sum(turn > 0 for turn in self._turns), HIDDEN),
            nn.ReLU(),
            nn.Linear(HIDDEN, HIDDEN),
            nn.ReLU(),
            nn.Linear(HIDDEN, 1),
        )

    def forward(self, means: Tensor) -> Tensor:
        """Return what is added to the logits, ``(n, K)``, for means over the scales ``(n, K, D)``.

        No gradient reaches the means: they are where the targets are, not where it is likely.
        """
        columns = []
        for values, turn in zip(means.detach().unbind(dim=-1), self._turns, strict=True):
            angles = turn * values
            columns += [angles.sin(), angles.cos()] if turn else [values]
        return self.layers(torch.stack(columns, dim=-1))[..., 0]
