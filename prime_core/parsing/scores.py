"""Scores the segments that a demonstration could be cut into."""

import numpy as np
from numpy.typing import NDArray

from prime_core.arrays import Indices
from prime_core.contracts.idm import InverseDynamicsModel
from prime_core.contracts.parser import PairScores, ParserConfig

CHUNK = 65536
"""Pairs scored at once; bounds the memory."""


def all_pairs(frames: int, minimum_steps: int, maximum_steps: int) -> Indices:
    """Return start and end of all segments within the limits, ``(n, 2)``, by start, then end."""
    starts = np.arange(frames)[:, None]
    ends = starts + np.arange(minimum_steps, maximum_steps + 1)[None, :]
    inside = ends < frames
    return np.stack((np.broadcast_to(starts, ends.shape)[inside], ends[inside]), axis=1)


def score_pairs(
    idm: InverseDynamicsModel, features: NDArray[np.float32], config: ParserConfig
) -> PairScores:
    """Score all pairs of a demonstration's frames, in batches.

    Args:
        idm: Gives log p(primitive | s, s') and, for ``score: joint``, the density of the most
            likely parameters.
        features: Of the demonstration's frames, from ``idm.encode``, ``(N, features)``.
        config: The limits, and which score.

    Returns:
        The scores, for a parser.
    """
    # No segment is longer than the demonstration, whatever the limit is.
    maximum_steps = max(config.minimum_steps, min(config.maximum_steps, len(features) - 1))
    pairs = all_pairs(len(features), config.minimum_steps, maximum_steps)
    classes = len(idm.space.names) + 1
    lengths = maximum_steps - config.minimum_steps + 1
    scores = np.full((len(features), lengths, classes), -np.inf)
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
