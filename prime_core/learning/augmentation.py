"""Makes what a policy learns from: rollouts, and parsed demonstrations augmented step by step."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from prime_core.arrays import Flags, Floats, Indices
from prime_core.collection.rollouts import RolloutTable
from prime_core.configuration import Config
from prime_core.contracts.calls import OTHER
from prime_core.contracts.demonstration import ParsedDemonstration
from prime_core.contracts.idm import InverseDynamicsModel
from prime_core.contracts.observations import Observations
from prime_core.contracts.training import CallData, Labels
from prime_core.learning.training_pairs import balanced_weights

TYPE_FRAMES, PARAMETER_FRAMES = 50, 100
"""Frames of a segment at most that the two networks learn from (paper's release)."""


class AugmentationConfig(Config):
    """Settings of the stepwise augmentation (paper, section III-C)."""

    parameter_share: float = Field(0.3, gt=0, le=1)
    """Share of a segment, from its start, whose frames the parameter network learns all parameters
    from. Later on the gripper has turned to where it will be: who learns from that leaves it as it
    is. From frames after it only where displacements end is learnt. In the paper it is 1."""
    type_margin: int = Field(11, ge=0, le=10_000)
    """Steps at the end of a segment that the type network does not learn from."""


def rollout_calls(table: RolloutTable) -> CallData:
    """Return the starts of rollouts, labelled with the calls that were made there."""
    classes = table.rollouts[:, 2]
    starts = Labels(table.rows(table.rollouts[:, :1]), classes, balanced_weights(classes))
    return CallData(table.observations, starts, starts, table.parameters)


def augmented_calls(
    parsed: Sequence[ParsedDemonstration],
    idm: InverseDynamicsModel,
    config: AugmentationConfig,
    generator: np.random.Generator,
) -> CallData:
    """Label frames inside segments with the primitive call that leads to the segment's end.

    Segments of `other` are left out. Parameters are the IDM's for (s_l, s_end).

    Args:
        parsed: The parsed demonstrations.
        idm: Gives the parameters.
        config: How many frames.
        generator: Draws the frames.

    Returns:
        All labelled frames, each segment with the same weight for the types, each frame for
        the parameters.
    """
    space = idm.space
    types = _Columns()
    values = _Columns()
    parameters: list[Floats] = []
    under_way: list[Flags] = []
    offset = 0
    for item in parsed:
        features = idm.encode(item.demonstration.observations.only(idm.sees))
        for segment in item.segments:
            if segment.call.primitive == OTHER:
                continue
            label = space.names.index(segment.call.primitive)
            last = max(segment.start + 1, segment.end - config.type_margin)
            chosen = _draw(segment.start, last, TYPE_FRAMES, generator)
            types.add(chosen + offset, label, 1.0 / len(chosen))
            early = segment.start + max(1, round(config.parameter_share * segment.steps))
            first = _draw(segment.start, early, PARAMETER_FRAMES, generator)
            later = _draw(early, last, PARAMETER_FRAMES, generator)
            chosen = np.concatenate((first, later))
            values.add(chosen + offset, label, 1.0)
            under_way.append(chosen >= early)
            # Of a motion that is under way, the segment's start says best what it is.
            starts = np.where(chosen < early, chosen, segment.start)
            pairs = np.stack((starts, np.full_like(chosen, segment.end)), axis=1)
            parameters.append(idm.parameters(features, pairs, np.full_like(chosen, label))[0])
        offset += len(item.demonstration.observations)
    return CallData(
        observations=Observations.join([item.demonstration.observations for item in parsed]),
        types=types.labels(),
        parameters=values.labels(),
        values=np.concatenate([*parameters, np.empty((0, space.width))]),
        under_way=np.concatenate([*under_way, np.empty(0, dtype=bool)]),
    )


class _Columns:
    """Frames, labels and weights as they come."""

    def __init__(self) -> None:
        self._frames: list[Indices] = []
        self._labels: list[Indices] = []
        self._weights: list[NDArray[np.float64]] = []

    def add(self, frames: Indices, label: int, weight: float) -> None:
        self._frames.append(frames)
        self._labels.append(np.full(len(frames), label, dtype=np.int64))
        self._weights.append(np.full(len(frames), weight))

    def labels(self) -> Labels:
        nothing = np.empty(0, dtype=np.int64)
        return Labels(
            rows=np.concatenate([nothing, *self._frames])[:, None],
            classes=np.concatenate([nothing, *self._labels]),
            weights=np.concatenate([np.empty(0), *self._weights]),
        )


def _draw(first: int, end: int, count: int, generator: np.random.Generator) -> Indices:
    """Return the first frame and others before ``end``, ``count`` at most, in order."""
    frames = np.arange(first, end)
    if len(frames) <= count:
        return frames
    others = generator.choice(frames[1:], count - 1, replace=False)
    return np.sort(np.concatenate((frames[:1], others)))
