"""A network as the training loop sees it, and what it takes."""

from abc import ABC, abstractmethod
from typing import Any, NamedTuple

import torch
from torch import Tensor, nn


class Batch(NamedTuple):
    """Examples to learn from.

    Attributes:
        features: Of the instants that a network sees at once, ``(n, 1 or 2, features)``.
        labels: Class or primitive, ``(n,)`` int64.
        poses: Frames of reference, ``(n, frames, 4)``; empty where classes are learnt.
        targets: Of the parameters, padded, ``(n, width)``; empty where classes are learnt.
    """

    features: Tensor
    labels: Tensor
    poses: Tensor
    targets: Tensor


class Network(nn.Module, ABC):
    """What the training loop trains."""

    def rate_share(self, weight: str) -> float:
        """Return the share of the learning rate that a weight, told by its name, is trained at."""
        return 1.0

    @abstractmethod
    def loss(self, batch: Any, generator: torch.Generator) -> Tensor:
        """Return the mean loss of a batch; the generator is of noise."""
