"""What models learn from, and how they tell their progress."""

from collections.abc import Callable
from dataclasses import dataclass

from prime_core.arrays import Floats, Indices
from prime_core.contracts.observations import Frames

Progress = Callable[[int, int], None]
"""Called with the number of finished items and the number of all items."""


def no_progress(done: int, total: int) -> None:
    """Ignore what is told."""


@dataclass(frozen=True, eq=False)
class PairData:
    """What an IDM learns from: labelled pairs of frames.

    Attributes:
        frames: The frames that the indices point into.
        type_pairs: Start and end frame, ``(n, 2)``.
        type_labels: Class of each (the last class is `other`), ``(n,)``.
        type_weights: Sampling weight of each, ``(n,)``.
        parameter_pairs: ``(m, 2)``.
        parameter_labels: Primitive of each, ``(m,)``.
        parameters: In their units, padded with zeros, ``(m, width)``.
        parameter_weights: ``(m,)``.
    """

    frames: Frames
    type_pairs: Indices
    type_labels: Indices
    type_weights: Floats
    parameter_pairs: Indices
    parameter_labels: Indices
    parameters: Floats
    parameter_weights: Floats


@dataclass(frozen=True, eq=False)
class PolicyData:
    """What a policy learns from: frames labelled with the primitive call to make there.

    Attributes:
        frames: The frames that the indices point into.
        type_frames: ``(n,)``.
        type_labels: Primitive of each, ``(n,)``.
        type_weights: Sampling weight of each, ``(n,)``.
        parameter_frames: ``(m,)``.
        parameter_labels: Primitive of each, ``(m,)``.
        parameters: In their units, padded with zeros, ``(m, width)``.
        parameter_weights: ``(m,)``.
    """

    frames: Frames
    type_frames: Indices
    type_labels: Indices
    type_weights: Floats
    parameter_frames: Indices
    parameter_labels: Indices
    parameters: Floats
    parameter_weights: Floats
