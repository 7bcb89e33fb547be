"""Objects in a simulation: where they may start, and how they move."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from prime_core.arrays import Array

Starts = Callable[[np.random.Generator], Array]
"""Draws where the objects start: positions [m], world frame, and quaternions, ``(k, 7)``."""

REST_SPEED = 0.05  # below which an object counts as lying still [m/s]
REST_TURNING = 0.5  # likewise [rad/s]


@dataclass(frozen=True)
class Placement:
    """Where an object may lie at the start; place and yaw are uniform.

    Attributes:
        low: Smallest x and y of the object's centre [m], world frame.
        high: Greatest x and y [m].
        height: z of the object's centre [m].
        quaternion: Its orientation at yaw 0, ``(4,)``, w-x-y-z.
        yaws: Smallest and greatest yaw [rad].
    """

    low: tuple[float, float]
    high: tuple[float, float]
    height: float
    quaternion: tuple[float, float, float, float] = (1.0, 0.0, 0.0, 0.0)
    yaws: tuple[float, float] = (0.0, 2.0 * np.pi)

    def draw(self, rng: np.random.Generator) -> Array:
        """Draw a place and a yaw: position [m] and quaternion, ``(7,)``."""
        import mujoco

        spot = rng.uniform(self.low, self.high)
        half = rng.uniform(*self.yaws) / 2
        turned = np.empty(4)
        yaw = np.array([np.cos(half), 0.0, 0.0, np.sin(half)])
        mujoco.mju_mulQuat(turned, yaw, np.array(self.quaternion))
        return np.array([*spot, self.height, *turned])


def uniform_starts(placements: Sequence[Placement]) -> Starts:
    """Return what draws each object's start from its own placement, one after another."""
    return lambda rng: np.stack([placement.draw(rng) for placement in placements])


@dataclass(frozen=True)
class ObjectMotion:
    """How fast an object moves.

    Attributes:
        speed: Of its centre [m/s].
        turning: Its rate of turn [rad/s].
    """

    speed: float
    turning: float

    @property
    def at_rest(self) -> bool:
        """Whether it lies still."""
        return self.speed < REST_SPEED and self.turning < REST_TURNING
