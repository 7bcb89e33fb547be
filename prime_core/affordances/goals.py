"""Goals: poses of a gripper that points straight down, as four numbers.

A goal is ``(4,)``: x, y, z [m] and yaw [rad] of the gripper, world frame. Its yaw is a plain
angle: the jaws of a parallel gripper repeat after half a turn, the arm's joints do not.
"""

import numpy as np
from numpy.typing import NDArray

from prime_core.contracts.scene import Scene
from prime_core.rotations import wrap_angle

Array = NDArray[np.float64]

JAW_PERIOD = float(np.pi)
"""Yaw that a parallel-jaw gripper repeats after [rad]."""


def gripper_goal(scene: Scene) -> Array:
    """Return where the gripper is, as a goal ``(4,)``."""
    return np.append(scene.gripper_position, scene.gripper_yaw)


def offset(goal: Array, start: Array) -> Array:
    """Return the move from one goal to another, ``(4,)``, with the shorter turn."""
    move = goal - start
    move[3] = wrap_angle(move[3])
    return move


def distance(scene: Scene, goal: Array) -> float:
    """Return how far the gripper is from a goal [m]."""
    return float(np.linalg.norm(goal[:3] - scene.gripper_position))


def plane_distance(scene: Scene, goal: Array) -> float:
    """Return how far the gripper is from a goal in the x-y plane [m]."""
    return float(np.linalg.norm(goal[:2] - scene.gripper_position[:2]))


def jaw_distance(scene: Scene, yaw: float) -> float:
    """Return the unsigned angle between the jaws and a yaw [rad], at most a quarter turn."""
    return abs(float(wrap_angle(yaw - scene.gripper_yaw, JAW_PERIOD)))


def equivalent_goals(parameters: Array, yaw: float) -> tuple[Array, Array]:
    """Return the two goals that put the jaws where the parameters say.

    Args:
        parameters: x, y, z [m] and yaw [rad], ``(4,)``.
        yaw: The gripper's yaw now [rad].

    Returns:
        Two goals ``(4,)``, half a turn apart, the one with the shorter turn first.
    """
    turn = float(wrap_angle(parameters[3] - yaw, JAW_PERIOD))
    near, far = yaw + turn, yaw + turn - np.copysign(JAW_PERIOD, turn)
    return np.append(parameters[:3], near), np.append(parameters[:3], far)
