"""What all movements of the simulated teleoperator share: their types and options."""

from collections.abc import Generator
from dataclasses import dataclass

import numpy as np

from prime_core.contracts.environment import Action
from prime_core.contracts.scene import Scene

Movement = Generator[Action, Scene, Scene]
"""Yields motor actions, is sent the scene after each, and returns the last scene."""

Outcome = Generator[Action, Scene, tuple[Scene, bool]]
"""A movement that also returns whether it did what it was for."""

OPEN, CLOSE = -1.0, 1.0
UP = np.array([0.0, 0.0, 1.0])
TRIES = 4  # grasps, fittings or pushes that are made before an attempt is given up


@dataclass(frozen=True)
class MovementOptions:
    """How one movement goes.

    Attributes:
        hesitate: Whether it stops for a pause.
        straight: Whether the path has to be all but straight.
        over: Height that the path arches up to [m]; None for no arch.
        command: What the gripper is commanded half-way; None to leave it as it is.
        exact: Whether it goes on until it has arrived.
    """

    hesitate: bool = False
    straight: bool = False
    over: float | None = None
    command: float | None = None
    exact: bool = True


DIRECT = MovementOptions()
