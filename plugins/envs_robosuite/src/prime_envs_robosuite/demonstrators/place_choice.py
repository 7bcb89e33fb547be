"""Where the simulated teleoperator chooses to put down what it holds."""

import numpy as np
from numpy.typing import NDArray

from prime_core.contracts.scene import Scene
from prime_core.rotations import wrap_angle, yaw_of
from prime_envs_robosuite.demonstrators.hand_clearance import (
    GREATEST_YAW,
    hand_fits,
    turned_about_z,
)
from prime_envs_robosuite.tasks.subtasks import ArmReach, PutInto, PutOnto

Array = NDArray[np.float64]

SPOTS = 1000  # that are looked at for one where the hand has room


def choose_spot(
    scene: Scene, subtask: PutInto, floor: float, draw: np.random.Generator
) -> tuple[Array, float]:
    """Choose where to put the held object: within reach, with room for the hand.

    Args:
        scene: The scene now.
        subtask: Where it goes.
        floor: Height of the object's centre when it lies there [m].
        draw: Where all randomness comes from.

    Returns:
        x and y [m] ``(2,)`` and yaw [rad] of the gripper.
    """
    index = scene.object_index(subtask.object_name)
    height = floor + float(scene.gripper_position[2] - scene.object_positions[index, 2])
    spots = draw.uniform(subtask.low, subtask.high, (SPOTS, 2))
    yaws = _yaws_nearby(scene, draw)
    good, distances = _within(spots, subtask.reach)
    if subtask.room is not None:
        good &= hand_fits(spots, height, yaws, subtask.room)
    chosen = int(np.argmax(good) if good.any() else np.argmin(distances))
    return spots[chosen], float(yaws[chosen])


def choose_yaw(scene: Scene, subtask: PutOnto, draw: np.random.Generator) -> float:
    """Choose the gripper's yaw [rad] for bringing the held object's centre to a point.

    Args:
        scene: The scene now.
        subtask: Where it goes.
        draw: Where all randomness comes from.
    """
    if subtask.yaws is None:
        yaws = _yaws_nearby(scene, draw)
    else:
        own_yaw = yaw_of(scene.object_quaternions[scene.object_index(subtask.object_name)])
        turns = wrap_angle(np.array(subtask.yaws) - own_yaw)
        yaws = scene.gripper_yaw + turns[np.argsort(np.abs(turns))]
    point = goal_point(scene, subtask)
    spots = np.array([bringing(scene, subtask.object_name, point, float(yaw))[:2] for yaw in yaws])
    good, distances = _within(spots, subtask.reach)
    return float(yaws[np.argmax(good) if good.any() else np.argmin(distances)])


def goal_point(scene: Scene, subtask: PutOnto) -> Array:
    """Return where the object's centre goes [m], world frame, ``(3,)``."""
    point = np.array(subtask.point)
    if subtask.reference is None:
        return point
    return np.asarray(point + scene.object_positions[scene.object_index(subtask.reference)])


def bringing(scene: Scene, name: str, point: Array, yaw: float) -> Array:
    """Return where the gripper goes for the centre of what it holds to come to a point.

    Args:
        scene: The scene now.
        name: Of what it holds.
        point: Where its centre goes [m], world frame, ``(3,)``.
        yaw: That the gripper will have then [rad].

    Returns:
        Position [m], world frame, ``(3,)``.
    """
    away = scene.gripper_position - scene.object_positions[scene.object_index(name)]
    return np.asarray(point + turned_about_z(away, yaw - scene.gripper_yaw))


def _yaws_nearby(scene: Scene, draw: np.random.Generator) -> Array:
    """Return yaws [rad] about the gripper's own, ever farther from it, ``(SPOTS,)``."""
    turns = draw.uniform(-0.6, 0.6, SPOTS) * np.linspace(1.0, 2.5, SPOTS)
    return np.asarray(np.clip(scene.gripper_yaw + turns, -GREATEST_YAW, GREATEST_YAW))


def _within(spots: Array, reach: ArmReach) -> tuple[NDArray[np.bool_], Array]:
    """Tell which spots ``(N, 2)`` are within reach ``(N,)``, and their distances [m] ``(N,)``."""
    distances = np.linalg.norm(spots - np.array(reach.base), axis=1)
    return distances < reach.distance, distances
