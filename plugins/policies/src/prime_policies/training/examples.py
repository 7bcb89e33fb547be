"""Examples to draw batches from, made of labelled observations."""

import hashlib
import json
from dataclasses import dataclass
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from prime_core.arrays import Array, Floats
from prime_core.contracts.training import CallData, Labels
from prime_core.errors import DatasetError
from prime_policies.networks.batch import Batch


@dataclass(frozen=True, eq=False)
class Examples:
    """Examples to draw from.

    Attributes:
        features: Of all instants, ``(N, features)``.
        rows: The instants of each example, ``(n, 1 or 2)``.
        labels: ``(n,)``.
        weights: How often each is drawn, up to a factor, ``(n,)``.
        poses: Frames of reference of each, ``(n, frames, 4)``; empty where classes are learnt.
        targets: ``(n, width)``; empty where classes are learnt.
    """

    features: Tensor
    rows: Tensor
    labels: Tensor
    weights: Floats
    poses: Tensor
    targets: Tensor

    @classmethod
    def of(
        cls,
        features: Tensor,
        labels: Labels,
        poses: Array | None = None,
        targets: Floats | None = None,
    ) -> "Examples":
        """Make examples of labelled rows.

        Raises:
            DatasetError: If there are none.
        """
        if not len(labels) or labels.weights.sum() <= 0:
            raise DatasetError("there are no examples to train on: no rollout or segment was kept")
        nothing = np.zeros((len(labels), 0))
        return cls(
            features=features,
            rows=torch.from_numpy(labels.rows.astype(np.int64)),
            labels=torch.from_numpy(labels.classes.astype(np.int64)),
            weights=labels.weights,
            poses=torch.from_numpy(nothing if poses is None else poses).float(),
            targets=torch.from_numpy(nothing if targets is None else targets).float(),
        )

    def draws(self, generator: np.random.Generator, count: int) -> Tensor:
        """Draw examples with replacement, by weight, ``(count,)``."""
        edges = np.cumsum(self.weights)
        places = np.searchsorted(edges, generator.random(count) * edges[-1], side="right")
        return torch.from_numpy(np.minimum(places, len(edges) - 1))

    def batch(self, chosen: Tensor | slice) -> Batch:
        """Return the examples of some numbers."""
        return Batch(
            self.features[self.rows[chosen]],
            self.labels[chosen],
            self.poses[chosen],
            self.targets[chosen],
        )


def fingerprint(card: dict[str, Any], seed: int, data: list[CallData]) -> str:
    """Return what tells a training apart: its settings, its seed and its data."""
    digest = hashlib.blake2b(json.dumps([card, seed]).encode(), digest_size=16)
    for array in (array for item in data for array in _arrays(item)):
        digest.update(repr((array.shape, array.dtype)).encode())
        digest.update(np.ascontiguousarray(array).data)
    return digest.hexdigest()


def _arrays(data: CallData) -> list[NDArray[Any]]:
    labels = [array for item in (data.types, data.parameters) for array in vars(item).values()]
    objects = data.observations.environment_state
    return [data.observations.state, *([] if objects is None else [objects]), *labels, data.values]
