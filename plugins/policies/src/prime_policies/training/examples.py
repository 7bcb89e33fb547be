"""Examples to draw batches from, made of labelled observations."""

from collections.abc import Sequence

import numpy as np
import torch
from torch import Tensor

from prime_core.arrays import Array, Floats
from prime_core.contracts.training import Labels
from prime_core.errors import DatasetError
from prime_policies.networks.network import Batch


class Examples:
    """Examples to draw from.

    Args:
        features: Of all instants, ``(N, features)``.
        labels: Which of them are an example each, of what class, and how often it is drawn.
        poses: Frames of reference of each, ``(n, frames, 4)``; None where classes are learnt.
        targets: Of the parameters, ``(n, width)``; None where classes are learnt.

    Raises:
        DatasetError: If there are none.
    """

    def __init__(
        self,
        features: Tensor,
        labels: Labels,
        poses: Array | None = None,
        targets: Floats | None = None,
    ) -> None:
        if not len(labels) or labels.weights.sum() <= 0:
            raise DatasetError("there are no examples to train on: no rollout or segment was kept")
        nothing = np.zeros((len(labels), 0))
        self._features = features
        self._rows = torch.from_numpy(labels.rows.astype(np.int64))
        self._classes = torch.from_numpy(labels.classes.astype(np.int64))
        self._edges = np.cumsum(labels.weights)
        self._poses = torch.from_numpy(nothing if poses is None else poses).float()
        self._targets = torch.from_numpy(nothing if targets is None else targets).float()

    def draws(self, generator: np.random.Generator, count: int) -> Tensor:
        """Draw examples with replacement, by weight, ``(count,)``."""
        edges = self._edges
        places = np.searchsorted(edges, generator.random(count) * edges[-1], side="right")
        return torch.from_numpy(np.minimum(places, len(edges) - 1))

    def batch(self, chosen: Tensor | slice) -> Batch:
        """Return the examples of some numbers."""
        return Batch(
            self._features[self._rows[chosen]],
            self._classes[chosen],
            self._poses[chosen],
            self._targets[chosen],
        )

    def everything(self) -> Batch:
        """Return all examples."""
        return self.batch(slice(None))


def joined(parts: Sequence[Examples]) -> Batch:
    """Return all examples of several."""
    return Batch(*map(torch.cat, zip(*(item.everything() for item in parts), strict=True)))
