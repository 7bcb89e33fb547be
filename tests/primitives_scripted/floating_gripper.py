"""The smallest world that a scripted primitive works in: a gripper without an arm."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from prime_core.contracts.description import Affordance, ObjectDescription, SceneDescription
from prime_core.contracts.primitive import Motion
from prime_core.contracts.scene import Scene
from prime_core.rotations import gripper_down

SHARE = 0.3  # of each commanded move that is made in its step

DESCRIPTION = SceneDescription(
    objects=(
        ObjectDescription("block", yaw_symmetry=2),
        ObjectDescription("anvil", graspable=False),
    ),
    workspace_low=(-0.3, -0.3, 0.8),
    workspace_high=(0.3, 0.3, 1.1),
    lift_height=1.0,
    affordances=(
        Affordance("grasp", "block", (0.0, 0.0, 0.02), (0.0, 0.0, 0.03), (0.0,)),
        Affordance("place", None, (0.1, 0.1, 0.9), (0.2, 0.2, 0.9)),
    ),
)


def scene_at(
    position: ArrayLike = (0.0, 0.0, 0.9),
    yaw: float = 0.0,
    opening: float = 0.08,
    held: str | None = None,
    block_yaw: float = 0.0,
) -> Scene:
    """Return a scene with the gripper at a position [m] and yaw [rad]."""
    upright = np.array([np.cos(block_yaw / 2), 0.0, 0.0, np.sin(block_yaw / 2)])
    return Scene(
        description=DESCRIPTION,
        gripper_position=np.array(position, dtype=np.float64),
        gripper_quaternion=gripper_down(yaw),
        gripper_opening=opening,
        joint_positions=np.zeros(7),
        object_positions=np.array([[0.1, -0.1, 0.82], [-0.2, 0.2, 0.82]]),
        object_quaternions=np.array([upright, [1.0, 0.0, 0.0, 0.0]]),
        held=held,
    )


def play(
    start: Scene,
    motion: Motion,
    change: Callable[[Scene], Scene] = lambda scene: scene,
    share: float = SHARE,
) -> tuple[list[Scene], list[np.ndarray]]:
    """Run a motion to its end; `change` may alter each scene. Returns scenes and actions."""
    scenes, actions = [start], []
    try:
        action = next(motion)
        while len(actions) < 500:
            scenes.append(change(_moved(scenes[-1], action, share)))
            actions.append(action)
            action = motion.send(scenes[-1])
    except StopIteration:
        return scenes, actions
    raise AssertionError("the motion does not end")


def _moved(scene: Scene, action: np.ndarray, share: float) -> Scene:
    return replace(
        scene,
        gripper_position=scene.gripper_position + share * action[:3],
        gripper_quaternion=gripper_down(scene.gripper_yaw + share * action[3]),
        gripper_opening=float(np.clip(scene.gripper_opening - 0.008 * action[4], 0.0, 0.08)),
    )
