"""The elbow of an arm, and how far it may be stretched.

Some arms can bend their elbow a little backward. Beyond the dead centre, where the arm is at
its longest, pulling the hand in bends the elbow further backward until it locks at its limit,
and no straight pull frees it. The last bit of length is a long way of the elbow, on which a
controller that watches the hand alone loses hold of it. So an arm slows down as it stretches,
and keeps its elbow well bent.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

RESERVE = 0.5
"""How far the elbow stays from its dead centre [rad].

Chosen on 16 reaches to the farthest poses that were not refused (PickPlace, robosuite's
controller), each followed by one back: with 0.15 rad 14 of those back failed, with 0.35 rad 4,
with 0.5 rad none.
"""
CREEP = 0.003  # [m] that the hand may always be told to move outward in a step
BRAKING = 0.6  # share of the length that is left, added to that
SWEEP = 181  # positions tried along each joint
CHANGE = 1e-3  # [m] of length that tells an elbow from other joints


@dataclass(frozen=True)
class Elbow:
    """The joint that changes an arm's length most.

    Attributes:
        joint: Its index.
        centre: Its position at the dead centre [rad].
        side: 1 if the arm folds below the centre, -1 if above.
        longest: The arm's length from shoulder to wrist at the centre [m].
    """

    joint: int
    centre: float
    side: float
    longest: float

    @classmethod
    def find(cls, ranges: Array, length: Callable[[Array], float]) -> "Elbow | None":
        """Look for the elbow.

        Args:
            ranges: Lowest and highest position of each joint [rad], ``(J, 2)``.
            length: Gives the arm's length [m] at joint positions ``(J,)``.

        Returns:
            The elbow, which folds to the wider side, or None if no joint changes the length.
        """
        middle = ranges.mean(axis=1)
        lengths = np.empty((len(ranges), SWEEP))
        sweeps = np.linspace(ranges[:, 0], ranges[:, 1], SWEEP, axis=1)
        for joint, sweep in enumerate(sweeps):
            for number, value in enumerate(sweep):
                joints = middle.copy()
                joints[joint] = value
                lengths[joint, number] = length(joints)
        elbow = int(np.argmax(np.ptp(lengths, axis=1)))
        if np.ptp(lengths[elbow]) < CHANGE:
            return None
        centre = float(sweeps[elbow, np.argmax(lengths[elbow])])
        side = 1.0 if centre > middle[elbow] else -1.0
        return cls(elbow, centre, side, float(lengths[elbow].max()))

    def narrow(self, ranges: Array) -> Array:
        """Return joint ranges ``(J, 2)`` [rad] in which the elbow folds."""
        result = np.array(ranges, dtype=np.float64)
        result[self.joint, int(self.side > 0)] = self.centre - self.side * RESERVE
        return result

    def is_locked(self, joints: Array) -> bool:
        """Whether the elbow is bent beyond its dead centre.

        Args:
            joints: Joint positions [rad], ``(J,)``.
        """
        return bool((joints[self.joint] - self.centre) * self.side > 0)

    def braked(self, move: Array, arm: Array) -> Array:
        """Shorten a move that stretches the arm.

        Args:
            move: Of the hand: x, y, z [m] and yaw [rad], ``(4,)``.
            arm: From shoulder to wrist [m], ``(3,)``.

        Returns:
            The move or a part of it, ``(4,)``.
        """
        length = float(np.linalg.norm(arm))
        direction = arm / length
        allowed = CREEP + BRAKING * max(self.longest - length, 0.0)
        return move * min(1.0, allowed / max(float(move[:3] @ direction), allowed))
