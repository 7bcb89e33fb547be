"""From a 5-number motor action to the 7 numbers of robosuite's controller."""

import math
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from prime_core.contracts.environment import ACTION_LIMIT
from prime_envs_robosuite.simulation.osc_scales import POSITION_SCALE, ROTATION_SCALE
from prime_envs_robosuite.simulation.panda import Panda

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
    clipped = np.minimum(np.maximum(action, -ACTION_LIMIT), ACTION_LIMIT)
    to_base = data.site_xmat[panda.base_site].reshape(3, 3).T
    command = np.empty(7)
    command[:3] = to_base @ clipped[:3] / POSITION_SCALE
    command[3:6] = to_base @ _turn_to(panda.gripper_rotation(data), clipped[3]) / ROTATION_SCALE
    command[6] = clipped[4]
    return np.minimum(np.maximum(command, -1.0), 1.0)


def _turn_to(rotation: Array, yaw_change: float) -> Array:
    """Return the rotation vector to straight down at a changed yaw, world frame, ``(3,)``.

    Args:
        rotation: Of the gripper, ``(3, 3)``.
        yaw_change: [rad].
    """
    half = 0.5 * (math.atan2(rotation[1, 0], rotation[0, 0]) + yaw_change)
    target = np.array([0.0, math.cos(half), math.sin(half), 0.0])  # see `rotations.gripper_down`
    current, inverse, difference = np.empty(4), np.empty(4), np.empty(4)
    mujoco.mju_mat2Quat(current, rotation.ravel())
    mujoco.mju_negQuat(inverse, current)
    mujoco.mju_mulQuat(difference, target, inverse)
    vector = np.empty(3)
    mujoco.mju_quat2Vel(vector, difference, 1.0)
    return vector
