"""Pairs of frames that no primitive explains."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from prime_core.collection.settings import CollectionConfig


def draw_other_pairs(
    frames: int,
    rollouts: Sequence[tuple[int, int, int]],
    config: CollectionConfig,
    generator: np.random.Generator,
) -> NDArray[np.int64]:
    """Draw pairs of frames that no rollout explains.

    A pair is left out where it ends with a rollout that covers its start: the primitive leads
    from there to the same end.

    Args:
        frames: Number of frames of the episode.
        rollouts: Start frame, end frame and primitive of each rollout.
        config: How many, and how long.
        generator: Of all random draws.

    Returns:
        Start and end frames, ``(k, 2)``, ``k`` at most ``config.other_pairs``.
    """
    shortest, longest = config.other_steps
    if frames <= shortest:
        return np.empty((0, 2), dtype=np.int64)
    lengths = generator.integers(shortest, min(longest, frames - 1) + 1, config.other_pairs)
    starts = (generator.random(config.other_pairs) * (frames - lengths)).astype(np.int64)
    ends = starts + lengths
    explained = np.zeros(config.other_pairs, dtype=np.bool_)
    for start, end, _ in rollouts:
        explained |= (starts >= start) & (starts < end) & (ends == end)
    return np.stack((starts, ends), axis=1)[~explained]
