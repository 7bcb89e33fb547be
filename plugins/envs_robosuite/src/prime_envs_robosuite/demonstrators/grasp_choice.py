"""Where the simulated teleoperator chooses to grasp an object."""

from collections.abc import Sequence
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from prime_core.contracts.description import Affordance
from prime_core.contracts.scene import Scene
from prime_core.rotations import wrap_angle, yaw_of
from prime_envs_robosuite.demonstrators.hand_clearance import (
    GREATEST_YAW,
    has_room,
    turned_about_z,
)
from prime_envs_robosuite.tasks.subtasks import Picking, Subtask

Array = NDArray[np.float64]

APART = 0.1  # between the centres of objects of which either can be grasped first [m]
OTHER_YAW_SHARE = 0.25  # of grasps that are not at the nearest yaw, so that policies see more
ANY_YAWS = np.linspace(-GREATEST_YAW, GREATEST_YAW, 57)  # 3 degrees apart [rad]


def choose_grasp(scene: Scene, subtask: Picking, draw: np.random.Generator) -> tuple[Array, float]:
    """Choose where to grasp an object.

    Args:
        scene: The scene now.
        subtask: What is done with it.
        draw: Where all randomness comes from.

    Returns:
        Position [m] ``(3,)`` and yaw [rad] of the gripper.
    """
    spot = _grasp_of(scene, subtask.object_name)
    index = scene.object_index(subtask.object_name)
    own_yaw = float(yaw_of(scene.object_quaternions[index]))
    offset = turned_about_z(draw.uniform(spot.low, spot.high), own_yaw) + draw.normal(0.0, 0.003, 3)
    yaws = spot.yaws if spot.yaws is not None else tuple(draw.uniform(-np.pi, np.pi, 4))
    # A half turn of the gripper swaps its fingers and changes nothing else.
    turns = wrap_angle([own_yaw + yaw for yaw in yaws], period=np.pi)
    nearest = turns[np.argsort(np.abs(turns - scene.gripper_yaw))]
    position = scene.object_positions[index] + offset
    reachable = nearest[np.abs(nearest) < GREATEST_YAW]
    roomy = reachable[has_room(scene, subtask, position, reachable)]
    if not len(roomy) and subtask.any_yaw:
        away = np.abs(wrap_angle(ANY_YAWS[:, None] - turns, period=np.pi)).min(axis=1)
        others = ANY_YAWS[np.argsort(away)]
        roomy = others[has_room(scene, subtask, position, others)][:1]
    reachable = roomy if len(roomy) else reachable
    reachable = reachable if len(reachable) else nearest[:1]
    other = len(reachable) > 1 and draw.random() < OTHER_YAW_SHARE
    return position, float(reachable[1 if other else 0] + draw.uniform(-0.1, 0.1))


def are_apart(scene: Scene, subtasks: Sequence[Subtask]) -> bool:
    """Whether each object that is picked up can be grasped without touching the others."""
    names = [subtask.object_name for subtask in subtasks if isinstance(subtask, Picking)]
    places = [scene.object_positions[scene.object_index(name), :2] for name in names]
    return all(np.linalg.norm(a - b) > APART for a, b in combinations(places, 2))


def _grasp_of(scene: Scene, name: str) -> Affordance:
    """Return where an object can be grasped."""
    spots = scene.description.affordances_for("grasp")
    return next(spot for spot in spots if spot.reference == name)
