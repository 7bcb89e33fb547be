"""The smallest world that a scripted primitive works in: a gripper without an arm."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from prime_core.contracts.description import Affordance, ObjectDescription, SceneDescription
from prime_core.contracts.primitive import Motion
from prime_core.contracts.scene import ObjectPoses, Scene
from prime_core.rotations import gripper_down

# A gripper that follows its commands as a critically damped spring with kp 150 does in 0.05 s: of
# the commanded move and of the speed before, what is added to the position and to the speed.
MOVED = (0.125, 0.54)
SPEEDED = (0.20, 0.21)

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
        objects=ObjectPoses(
            positions=np.array([[0.1, -0.1, 0.82], [-0.2, 0.2, 0.82]]),
            quaternions=np.array([upright, [1.0, 0.0, 0.0, 0.0]]),
            held=held,
        ),
    )


def held_now(scene: Scene, held: str | None) -> Scene:
    """Return the scene with that object held, or none."""
    return replace(scene, objects=replace(scene.known_objects, held=held))


def block_moved(scene: Scene, move: ArrayLike) -> Scene:
    """Return the scene with the block moved [m], ``(3,)``."""
    positions = scene.object_positions.copy()
    positions[0] += move
    return replace(scene, objects=replace(scene.known_objects, positions=positions))


def play(
    start: Scene,
    motion: Motion,
    change: Callable[[Scene], Scene] = lambda scene: scene,
    strength: float = 1.0,
) -> tuple[list[Scene], list[np.ndarray]]:
    """Run a motion to its end.

    Args:
        start: Where it starts, at rest.
        motion: What to run.
        change: May alter each scene.
        strength: Share of its moves that the gripper makes.

    Returns:
        Scenes and actions.
    """
    scenes, actions, speed = [start], [], np.zeros(4)
    try:
        action = next(motion)
        while len(actions) < 500:
            move = strength * (MOVED[0] * action[:4] + MOVED[1] * speed)
            speed = SPEEDED[0] * action[:4] + SPEEDED[1] * speed
            scenes.append(change(_moved(scenes[-1], move, action[4])))
            actions.append(action)
            action = motion.send(scenes[-1])
    except StopIteration:
        return scenes, actions
    raise AssertionError("the motion does not end")


def _moved(scene: Scene, move: np.ndarray, command: float) -> Scene:
    return replace(
        scene,
        gripper_position=scene.gripper_position + move[:3],
        gripper_quaternion=gripper_down(scene.gripper_yaw + move[3]),
        gripper_opening=float(np.clip(scene.gripper_opening - 0.008 * command, 0.0, 0.08)),
    )
