"""Segments once more, disturbed: what teaches a motion to come back.

Thirty segments show where the gripper goes, and hardly what to do a centimetre beside of it, where
every learned motion gets to sooner or later. So the path is shown again with the hand pushed off it
now and then, and actions that take it back: each step undoes a third of what is left. DART (Laskey
et al. 2017) injects such noise while a person demonstrates; here it is added to what was shown.
"""

from typing import NamedTuple

import numpy as np

from prime_core.arrays import Array, Flags, Floats

COPIES = 4  # of each segment, besides itself
EVERY = 8  # steps from one disturbance to the next, on average
RETURN = 0.3  # of the way back that a step goes
GREATEST = 0.02  # [m] standard deviation far from the goal
LEAST = 0.01  # [m] the same at the goal
NEARER = 0.15  # of the distance to the goal: between the two
BACK, BACK_YAW = 0.002, 0.03  # [m, rad] off the path up to which the hand is back on it
YAW = 0.1  # [rad] standard deviation


class Path(NamedTuple):
    """A path of the gripper.

    Attributes:
        positions: [m], ``(N, 3)``.
        yaws: [rad], ``(N,)``.
        actions: Motor actions, ``(N, 6)``.
    """

    positions: Floats
    yaws: Floats
    actions: Floats


def disturbed(path: Path, goal: Array, free: Flags, generator: np.random.Generator) -> Path:
    """Return a path with the hand pushed off it now and then.

    Args:
        path: As it was shown.
        goal: Where it leads [m], ``(3,)``.
        free: In which frames it may be pushed, ``(N,)``: not where fingers close on something.
        generator: Of the disturbances.
    """
    count = len(path.positions)
    distances = np.linalg.norm(path.positions - goal, axis=1)
    spreads = np.clip(NEARER * distances, LEAST, GREATEST)
    pushes = generator.normal(size=(count, 4)) * np.column_stack((*[spreads] * 3, [YAW] * count))
    pushes[(generator.random(count) > 1 / EVERY) | ~free] = 0.0
    off = np.zeros((count, 4))
    left = np.zeros(4)
    for row, push in enumerate(pushes):
        left = left + push
        off[row] = left
        left = (1 - RETURN) * left
    actions = path.actions.copy()
    actions[:, :4] -= RETURN * off
    beside = (np.linalg.norm(off[:, :3], axis=1) > BACK) | (np.abs(off[:, 3]) > BACK_YAW)
    actions[beside, 5] = -1.0  # it is not over before the hand is back
    return Path(path.positions + off[:, :3], path.yaws + off[:, 3], actions)
