"""The columns of a demonstration as robomimic has them, under robosuite's names.

robomimic: Mandlekar et al. 2021, https://robomimic.github.io/docs/datasets/overview.html.
"""

import numpy as np
from numpy.typing import NDArray

from prime_core.contracts.demonstration import Demonstration
from prime_core.contracts.description import SceneDescription
from prime_core.contracts.environment import ACTION_LIMIT
from prime_core.contracts.observations import Observations
from prime_envs_robosuite.environment import RobosuiteEnvironment
from prime_envs_robosuite.simulation.osc_scales import POSITION_SCALE, ROTATION_SCALE

Columns = dict[str, NDArray[np.floating]]

OSC_WIDTH = 7


def osc_actions(actions: NDArray[np.floating]) -> NDArray[np.float64]:
    """Return motor actions as robosuite's OSC_POSE controller takes them, in [-1, 1].

    The gripper is not tilted: prime's environments hold it upright by themselves, robosuite's hold
    it as it is.

    Args:
        actions: dx, dy, dz [m], dyaw [rad], gripper, ``(N, 5)``.

    Returns:
        Displacement, rotation vector and gripper, ``(N, 7)``.
    """
    ours = np.clip(actions.astype(np.float64), -ACTION_LIMIT, ACTION_LIMIT)
    result = np.zeros((len(ours), OSC_WIDTH))
    result[:, :3] = ours[:, :3] / POSITION_SCALE
    result[:, 5] = ours[:, 3] / ROTATION_SCALE
    result[:, 6] = ours[:, 4]
    return np.clip(result, -1.0, 1.0)


def low_dimensional(seen: Observations, description: SceneDescription) -> Columns:
    """Return what was seen of the robot and, where it is known, of the objects.

    Args:
        seen: ``N`` instants.
        description: Of the scene.

    Returns:
        By robosuite's names, ``(N, width)`` float32: positions [m] in the world frame, quaternions
        x-y-z-w, angles [rad]. ``object`` holds of each object in turn its position, its quaternion,
        and its position less the gripper's, which is robosuite's of one object.
    """
    halves = np.array([0.5, -0.5], dtype=np.float32)
    found: Columns = {
        "robot0_eef_pos": seen.gripper_position,
        "robot0_eef_quat": _w_last(seen.gripper_quaternion),
        "robot0_gripper_qpos": seen.gripper_opening[:, None] * halves,
        "robot0_joint_pos": seen.joint_positions,
    }
    if seen.environment_state is None or not description.objects:
        return found
    together = []
    for index, item in enumerate(description.objects):
        position = seen.object_positions[:, index]
        quaternion = _w_last(seen.object_quaternions[:, index])
        found |= {f"{item.name}_pos": position, f"{item.name}_quat": quaternion}
        together += [position, quaternion, position - seen.gripper_position]
    found["object"] = np.hstack(together)
    return found


def solved_after(shown: Demonstration, environment: RobosuiteEnvironment) -> NDArray[np.bool_]:
    """Return whether the task was solved after each action, ``(N,)``.

    Without states of the simulator it is taken to be solved at the end, and not before.

    Raises:
        PrimeError: If the states are not of this environment.
    """
    solved = np.zeros(shown.steps, dtype=bool)
    if shown.simulator_states is None:
        solved[-1] = True
        return solved
    for row, state in enumerate(shown.simulator_states[1:]):
        environment.set_state(state)
        solved[row] = environment.is_success()
    return solved


def _w_last(quaternions: NDArray[np.float32]) -> NDArray[np.float32]:
    return np.roll(quaternions, -1, axis=1)
