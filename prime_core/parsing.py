"""Parses demonstrations: scores all pairs of frames, cuts, and finds the parameters."""

from dataclasses import dataclass

import numpy as np

from prime_core.demonstration import Demonstration
from prime_core.frames import Frames
from prime_core.idm import Indices, InverseDynamicsModel
from prime_core.parser import PairScores, ParserConfig
from prime_core.primitive_calls import OTHER, PrimitiveCall, Segment

CHUNK = 65536
"""Pairs scored at once; bounds the memory."""


@dataclass(frozen=True, eq=False)
class ParsedDemonstration:
    """A demonstration and the segments that it was cut into, in order."""

    demonstration: Demonstration
    segments: tuple[Segment, ...]

    @property
    def primitives(self) -> int:
        """Number of segments that a primitive explains."""
        return sum(item.call.primitive != OTHER for item in self.segments)

    @property
    def other_steps(self) -> int:
        """Motor actions in segments that no primitive explains."""
        return sum(item.steps for item in self.segments if item.call.primitive == OTHER)


def all_pairs(frames: int, minimum_steps: int, maximum_steps: int) -> Indices:
    """Return start and end of all segments within the limits, ``(n, 2)``, by start, then end."""
    starts = np.arange(frames)[:, None]
    ends = starts + np.arange(minimum_steps, maximum_steps + 1)[None, :]
    inside = ends < frames
    return np.stack((np.broadcast_to(starts, ends.shape)[inside], ends[inside]), axis=1)


def score_pairs(idm: InverseDynamicsModel, frames: Frames, config: ParserConfig) -> PairScores:
    """Score all pairs of a demonstration's frames, in batches.

    Args:
        idm: Gives log p(primitive | s, s') and, for ``score: joint``, the density of the most
            likely parameters.
        frames: The demonstration's frames.
        config: The limits, and which score.

    Returns:
        The scores, for a parser.
    """
    features = idm.encode(frames)
    pairs = all_pairs(len(frames), config.minimum_steps, config.maximum_steps)
    classes = len(idm.space.names) + 1
    lengths = config.maximum_steps - config.minimum_steps + 1
    scores = np.full((len(frames), lengths, classes), -np.inf)
    for first in range(0, len(pairs), CHUNK):
        chunk = pairs[first : first + CHUNK]
        values = idm.score(features, chunk).astype(np.float64)
        if config.score == "joint":
            for label in range(classes - 1):
                labels = np.full(len(chunk), label, dtype=np.int64)
                values[:, label] += idm.parameters(features, chunk, labels)[1]
        offsets = chunk[:, 1] - chunk[:, 0] - config.minimum_steps
        scores[chunk[:, 0], offsets] = values
    return PairScores(scores, config.minimum_steps)


def parse_demonstration(
    demonstration: Demonstration, idm: InverseDynamicsModel, config: ParserConfig
) -> ParsedDemonstration:
    """Cut a demonstration into primitive calls.

    Args:
        demonstration: What to cut.
        idm: What to explain the pieces with.
        config: Which parser.

    Returns:
        The demonstration with its segments.
    """
    parsed = config.build().parse(score_pairs(idm, demonstration.frames, config))
    features = idm.encode(demonstration.frames)
    segments = []
    for item in parsed:
        if item.label == len(idm.space.names):
            call = PrimitiveCall(OTHER, np.empty(0))
        else:
            pair = np.array([[item.start, item.end]])
            values, _ = idm.parameters(features, pair, np.array([item.label]))
            width = len(idm.space.parameter_spaces[item.label])
            call = PrimitiveCall(idm.space.names[item.label], values[0, :width])
        segments.append(Segment(item.start, item.end, call, item.log_probability))
    return ParsedDemonstration(demonstration, tuple(segments))
