"""Ends of rollouts that are as good as the rollout's own: the hand moves on, the objects stay."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from prime_core.contracts.scene import Scene

LATEST = 60  # steps after a rollout; a person's hand is away from what it put down by then
MOVED = 0.02  # [m] by which a rollout must have moved an object to tell of it
STAYED = 0.002  # [m] within which objects stay where they are


def draw_late_ends(
    scenes: Sequence[Scene],
    rollouts: Sequence[tuple[int, int, int]],
    generator: np.random.Generator,
) -> NDArray[np.int64]:
    """Draw a later frame for each rollout that moved an object and let it lie.

    In demonstrations a segment of a place or a push often takes in the hand's way back. What was
    done then shows in where the objects are, as long as they stay there, and not in where the
    gripper is.

    Args:
        scenes: Of the episode.
        rollouts: Start frame, end frame and primitive of each rollout.
        generator: Of all random draws.

    Returns:
        A frame for each rollout, ``(n,)``: its own end where no later one says the same.
    """
    ends = []
    for start, end, _ in rollouts:
        latest = _latest(scenes, start, end)
        ends.append(int(generator.integers(end, latest + 1)))
    return np.array(ends, dtype=np.int64)


def _latest(scenes: Sequence[Scene], start: int, end: int) -> int:
    """Return the last frame up to which nothing is held and all objects stay."""
    moves = scenes[end].object_positions - scenes[start].object_positions
    if scenes[end].holding or np.linalg.norm(moves, axis=1).max(initial=0.0) < MOVED:
        return end
    latest = end
    for frame in range(end + 1, min(end + LATEST, len(scenes) - 1) + 1):
        moves = scenes[frame].object_positions - scenes[end].object_positions
        if scenes[frame].holding or np.linalg.norm(moves, axis=1).max(initial=0.0) > STAYED:
            break
        latest = frame
    return latest
