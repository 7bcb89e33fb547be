"""From a 5-number motor action to the 7 numbers of robosuite's controller."""

from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from prime_core.environment import ACTION_LIMIT
from prime_core.rotations import gripper_down, yaw_of
from prime_envs_robosuite.panda import Panda
from prime_envs_robosuite.stepping import POSITION_SCALE, ROTATION_SCALE

Array = NDArray[np.float64]


def controller_command(action: Array, panda: Panda, data: Any) -> Array:
    """Turn a motor action into a controller command that keeps the gripper pointing down.

    Args:
        action: dx, dy, dz [m], dyaw [rad] in the world frame; gripper, ``(5,)``.
        panda: Where the robot is in the data.
        data: A ``mujoco.MjData`` whose poses are up to date.

    Returns:
        Displacement and rotation vector in the base frame and gripper, in [-1, 1], ``(7,)``.
    """
    clipped = np.clip(action, -ACTION_LIMIT, ACTION_LIMIT)
    _, rotation = panda.gripper_pose(data)
    _, base = panda.base_pose(data)
    turn = _turn_to(rotation, float(clipped[3]))
    command = np.empty(7)
    command[:3] = base.T @ clipped[:3] / POSITION_SCALE
    command[3:6] = base.T @ turn / ROTATION_SCALE
    command[6] = clipped[4]
    return np.clip(command, -1.0, 1.0)


def _turn_to(rotation: Array, yaw_change: float) -> Array:
    """Return the rotation vector to straight down at a changed yaw, world frame, ``(3,)``.

    Args:
        rotation: Of the gripper, ``(3, 3)``.
        yaw_change: [rad].
    """
    current = np.empty(4)
    mujoco.mju_mat2Quat(current, rotation.ravel())
    target = gripper_down(yaw_of(current) + yaw_change)
    inverse = np.empty(4)
    mujoco.mju_negQuat(inverse, current)
    difference = np.empty(4)
    mujoco.mju_mulQuat(difference, target, inverse)
    vector = np.empty(3)
    mujoco.mju_quat2Vel(vector, difference, 1.0)
    return vector
