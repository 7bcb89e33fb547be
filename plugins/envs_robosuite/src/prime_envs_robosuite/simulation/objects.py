"""Objects in a simulation: where they may start, and how they move."""

from dataclasses import dataclass

import numpy as np

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
