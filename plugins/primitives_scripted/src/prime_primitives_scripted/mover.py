"""What one motion remembers from step to step."""

import numpy as np
from numpy.typing import NDArray

from prime_core.affordances.goals import gripper_goal, offset
from prime_core.contracts.environment import Action
from prime_core.contracts.scene import Scene
from prime_primitives_scripted.servo import Servo

Array = NDArray[np.float64]

OPEN = -1.0
CLOSE = 1.0

GAIN = 4.0
LEAD = 3.5
"""The command is GAIN times what is left of the way, less LEAD times the last step.

An arm that chases its commands as a critically damped spring with kp 150 then halves what is
left in each step. Without the lead it overshoots by 10 to 15 mm after a long way.
"""


class Mover:
    """Heads for goals with a gripper command.

    It lives as long as one motion: a primitive keeps nothing between motions.

    Args:
        servo: Makes the actions.
        gripper: The gripper's command, from -1 (open) to 1 (close).
    """

    def __init__(self, servo: Servo, gripper: float) -> None:
        self.gripper = gripper
        self._servo = servo
        self._before: Array | None = None

    def action(self, scene: Scene, goal: Array) -> Action:
        """Return the motor action ``(5,)`` that heads for a goal ``(4,)`` from a scene."""
        here = gripper_goal(scene)
        speed = np.zeros(4) if self._before is None else offset(here, self._before)
        self._before = here
        speed[3] = 0.0
        wanted = GAIN * offset(goal, here) - LEAD * speed
        return np.append(self._servo.move(scene, wanted), self.gripper)
