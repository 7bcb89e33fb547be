"""Collected episodes of plain numbers."""

import numpy as np

from prime_core.collection.recording import CollectedEpisode


def episode(number: int, held: bool = False, frames: int = 60) -> CollectedEpisode:
    """Return an episode with an object at x = number and two rollouts."""
    objects = np.zeros((frames, 8), dtype=np.float32)
    objects[:, 0], objects[:, 7] = number, held
    return CollectedEpisode(
        state=np.full((frames, 15), number, dtype=np.float32),
        environment_state=objects,
        actions=np.zeros((frames, 5), dtype=np.float32),
        rollouts=np.array([[0, 20, 0], [30, 55, 1]]),
        parameters=np.array([[0.1], [0.2]]) + number,
        others=np.array([[1, 9]]),
        late_ends=np.array([20, 55]),
    )
