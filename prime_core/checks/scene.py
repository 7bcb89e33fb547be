"""The contract of scenes and their descriptions."""

import numpy as np

from prime_core.checks.requirement import require, require_array
from prime_core.contracts.description import Affordance, SceneDescription
from prime_core.contracts.scene import Scene

UNIT_TOLERANCE = 1e-3
"""How far a quaternion's length may be from 1; observations are float32."""


def check_description(description: SceneDescription) -> None:
    """Check that a scene description agrees with itself.

    Raises:
        CheckError: If it does not.
    """
    require(
        isinstance(description, SceneDescription),
        f"description is {description!r}: it must be a prime_core.SceneDescription",
    )
    names = [item.name for item in description.objects]
    require(len(set(names)) == len(names), f"objects are named {names}: names must differ")
    _check_box("the workspace", description.workspace_low, description.workspace_high)
    require(bool(np.isfinite(description.lift_height)), "lift_height must be a finite height [m]")
    require(description.joint_count >= 0, "joint_count must be 0 or more")
    for affordance in description.affordances:
        _check_affordance(affordance, names)
    robot = description.robot
    if robot is not None:
        require(
            len(robot.joint_names) == description.joint_count,
            f"the robot names {len(robot.joint_names)} joints, joint_count is "
            f"{description.joint_count}: they must be the same number",
        )


def _check_affordance(affordance: Affordance, names: list[str]) -> None:
    subject = f"affordance {affordance.action!r} of {affordance.reference!r}"
    require(bool(affordance.action), f"{subject} has no action: name one, such as 'grasp'")
    require(
        affordance.reference is None or affordance.reference in names,
        f"{subject} refers to an object that is not there; objects: {names}, or None for the "
        "world frame",
    )
    _check_box(subject, affordance.low, affordance.high)
    require(
        affordance.yaws is None or len(affordance.yaws) > 0,
        f"{subject} has no yaws: use None where any yaw makes sense",
    )


def _check_box(subject: str, low: tuple[float, ...], high: tuple[float, ...]) -> None:
    require(
        len(low) == len(high) == 3 and bool(np.all(np.isfinite([low, high]))),
        f"{subject} goes from {low} to {high}: both must be three finite numbers [m]",
    )
    require(
        bool(np.all(np.asarray(low) <= np.asarray(high))),
        f"{subject} goes from {low} to {high}: no number of low may be above that of high",
    )


def check_scene(scene: Scene, description: SceneDescription) -> None:
    """Check one scene against the description of its environment.

    Raises:
        CheckError: If it does not agree.
    """
    count = len(description.objects)
    require(scene.description is description, "scene().description must be the environment's own")
    arrays = {
        "gripper_position": (3,),
        "gripper_quaternion": (4,),
        "joint_positions": (description.joint_count,),
        "object_positions": (count, 3),
        "object_quaternions": (count, 4),
    }
    for name, shape in arrays.items():
        require_array(getattr(scene, name), shape, np.floating, f"scene().{name}")
    for name in ("gripper_quaternion", "object_quaternions"):
        lengths = np.linalg.norm(getattr(scene, name), axis=-1)
        require(
            bool(np.all(np.abs(lengths - 1.0) < UNIT_TOLERANCE)),
            f"scene().{name} has length {lengths}: quaternions (w, x, y, z) must have length 1",
        )
    require(
        bool(np.isfinite(scene.gripper_opening)) and scene.gripper_opening > -1e-3,
        f"scene().gripper_opening is {scene.gripper_opening}: it must be a distance [m]",
    )
    names = [item.name for item in description.objects]
    require(
        scene.held is None or scene.held in names,
        f"scene().held is {scene.held!r}: it must be None or one of {names}",
    )
