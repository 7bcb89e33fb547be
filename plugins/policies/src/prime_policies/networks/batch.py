"""A batch of examples, as networks take it."""

from typing import NamedTuple

from torch import Tensor


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
