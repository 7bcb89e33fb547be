"""Examples to train on, made from labelled frames and pairs of frames."""

import hashlib
import json
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from prime_core.arrays import Floats, Indices
from prime_core.errors import DatasetError
from prime_policies.networks import Examples

STRETCHES = 40  # of frames that are left out or not


@dataclass(frozen=True, eq=False)
class Source:
    """Examples to draw from.

    Attributes:
        features: Of all frames, ``(N, features)``.
        indices: The frames of each example, ``(n, frames seen at once)``.
        labels: ``(n,)``.
        targets: ``(n, D)``; ``(n, 0)`` where classes are learnt.
        weights: How often each is drawn, up to a factor, ``(n,)``.
    """

    features: Tensor
    indices: Tensor
    labels: Tensor
    targets: Tensor
    weights: Floats

    def draws(self, generator: np.random.Generator, count: int) -> Tensor:
        """Draw examples with replacement, by weight, ``(count,)``."""
        edges = np.cumsum(self.weights)
        places = np.searchsorted(edges, generator.random(count) * edges[-1], side="right")
        return torch.from_numpy(np.minimum(places, len(edges) - 1))

    def batch(self, rows: Tensor) -> Examples:
        """Return the examples of some rows."""
        return Examples(self.features[self.indices[rows]], self.labels[rows], self.targets[rows])


def classifier_source(
    features: Tensor, indices: Indices, labels: Indices, weights: NDArray[np.float64]
) -> Source:
    """Return examples of classes.

    Args:
        features: Of all frames, ``(N, features)``.
        indices: ``(n,)`` or ``(n, 2)``.
        labels: ``(n,)``.
        weights: ``(n,)``.
    """
    return _source(features, indices, labels, np.zeros((len(labels), 0)), weights)


def parameter_source(
    features: Tensor,
    indices: Indices,
    labels: Indices,
    targets: NDArray[np.float64],
    weights: NDArray[np.float64],
) -> Source:
    """Return examples of parameters, given as targets ``(n, D)``; see `classifier_source`."""
    return _source(features, indices, labels, targets, weights)


def _source(
    features: Tensor,
    indices: Indices,
    labels: Indices,
    targets: NDArray[np.float64],
    weights: NDArray[np.float64],
) -> Source:
    if not len(labels) or weights.sum() <= 0:
        raise DatasetError("there are no examples to train on: no rollout or segment was kept")
    return Source(
        features=features,
        indices=torch.from_numpy(indices.reshape(len(labels), -1).astype(np.int64)),
        labels=torch.from_numpy(labels.astype(np.int64)),
        targets=torch.from_numpy(targets.astype(np.float32)),
        weights=weights,
    )


def split(source: Source) -> tuple[Source, Source]:
    """Split examples into those to train on, and an eighth to measure with.

    Frames of one episode follow each other: what is left out are whole stretches of frames.
    """
    stretch = source.indices[:, 0] * STRETCHES // len(source.features)
    left_out = stretch % 8 == 3
    if bool(left_out.all()) or not bool(left_out.any()):
        return source, _rows(source, torch.zeros_like(left_out))
    return _rows(source, ~left_out), _rows(source, left_out)


def _rows(source: Source, chosen: Tensor) -> Source:
    return replace(
        source,
        indices=source.indices[chosen],
        labels=source.labels[chosen],
        targets=source.targets[chosen],
        weights=source.weights[chosen.numpy()],
    )


def fingerprint(card: dict[str, Any], seed: int, arrays: list[NDArray[Any]]) -> str:
    """Return what tells a training apart: its settings, its seed and its data."""
    digest = hashlib.blake2b(json.dumps([card, seed]).encode(), digest_size=16)
    for array in arrays:
        digest.update(repr((array.shape, array.dtype)).encode())
        digest.update(np.ascontiguousarray(array).data)
    return digest.hexdigest()
