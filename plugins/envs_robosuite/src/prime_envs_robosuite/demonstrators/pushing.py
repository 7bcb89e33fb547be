"""How the simulated teleoperator pushes objects over the table."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from prime_core.contracts.scene import Scene
from prime_core.rotations import wrap_angle
from prime_envs_robosuite.demonstrators.hand_clearance import GREATEST_YAW
from prime_envs_robosuite.demonstrators.movements import (
    CLOSE,
    OPEN,
    TRIES,
    Movement,
    MovementOptions,
    Outcome,
)
from prime_envs_robosuite.demonstrators.teleoperated_gripper import TeleoperatedGripper
from prime_envs_robosuite.tasks.subtasks import Push

Array = NDArray[np.float64]

STROKES = 6  # of a push, from one side
DRAW_BACK = 0.02  # from a pushed object, before rising beside it [m]
PUSHED = 0.015  # from where a pushed object should be, near enough [m]
STRAIGHT = MovementOptions(straight=True)


class Pusher:
    """Pushes with the closed gripper.

    Args:
        gripper: What is moved.
        generator: Where all randomness comes from.
    """

    def __init__(self, gripper: TeleoperatedGripper, generator: np.random.Generator) -> None:
        self._gripper = gripper
        self._generator = generator

    def push(self, scene: Scene, subtask: Push, is_last: bool) -> Outcome:
        """Push the object into its region, from as many sides as it takes.

        Args:
            scene: The scene now.
            subtask: What is pushed where.
            is_last: Whether nothing is left to do after it.
        """
        gripper, index = self._gripper, scene.object_index(subtask.object_name)
        target = self._generator.uniform(subtask.low, subtask.high)
        if gripper.command == OPEN and gripper.has_risen:
            scene = yield from gripper.grip(scene, CLOSE)
        for _ in range(TRIES):
            spot = scene.object_positions[index, :2]
            way = target - spot
            distance = float(np.linalg.norm(way))
            if distance < PUSHED or _is_inside(spot, subtask):
                return scene, True
            direction = way / distance
            scene = yield from self._come_down_beside(scene, subtask, direction)
            scene = yield from self._push_on(scene, subtask, target, direction)
            scene = yield from self._leave(scene, direction, is_last)
        return scene, _is_inside(scene.object_positions[index, :2], subtask)

    def _come_down_beside(self, scene: Scene, subtask: Push, direction: Array) -> Movement:
        """Bring the closed gripper down behind the object, seen in the direction ``(2,)``."""
        gripper = self._gripper
        # The hand's broad side pushes; which way its thin side points does not matter.
        yaw = float(wrap_angle(np.arctan2(direction[1], direction[0]), np.pi))
        yaw = float(np.clip(yaw, -GREATEST_YAW, GREATEST_YAW))
        spot = scene.object_positions[scene.object_index(subtask.object_name), :2]
        beside = spot - subtask.standoff * direction
        low, high = np.append(beside, subtask.height), scene.description.lift_height
        options = gripper.options_onward(scene, CLOSE)
        if gripper.flows():
            scene = yield from gripper.move(scene, low, yaw, replace(options, over=high))
            return (yield from gripper.pause(scene, 0.5))
        scene = yield from gripper.reach(scene, np.append(beside, high), yaw, options)
        scene = yield from gripper.pause(scene, 0.5)
        return (yield from gripper.move(scene, low, yaw, STRAIGHT))

    def _push_on(self, scene: Scene, subtask: Push, target: Array, direction: Array) -> Movement:
        """Push in a direction ``(2,)`` until the object is as far as its target ``(2,)`` [m]."""
        index = scene.object_index(subtask.object_name)
        for _ in range(STROKES):
            spot = scene.object_positions[index, :2]
            left = float((target - spot) @ direction)
            if left < PUSHED / 3 or _is_inside(spot, subtask):
                break
            # Before they touch it, its size says where the fingers will.
            behind = float((spot - scene.gripper_position[:2]) @ direction)
            farther = left - min(behind, subtask.touching)
            goal = np.append(spot + farther * direction, subtask.height)
            scene = yield from self._gripper.move(scene, goal, scene.gripper_yaw, STRAIGHT)
        return scene

    def _leave(self, scene: Scene, direction: Array, is_last: bool) -> Movement:
        """Draw the fingers back from what was pushed in a direction ``(2,)``, and rise."""
        gripper, yaw = self._gripper, scene.gripper_yaw
        back = scene.gripper_position - np.append(DRAW_BACK * direction, 0.0)
        above = np.append(back[:2], scene.description.lift_height)
        if not is_last and gripper.stays_low():
            return (yield from gripper.move(scene, back, yaw, STRAIGHT))
        if gripper.flows():
            return (yield from gripper.move(scene, above, yaw, STRAIGHT))
        scene = yield from gripper.move(scene, back, yaw, STRAIGHT)
        return (yield from gripper.move(scene, above, yaw))


def _is_inside(spot: Array, subtask: Push) -> bool:
    """Whether a point ``(2,)`` [m] is in the region that a subtask pushes into."""
    return bool(np.all(spot >= subtask.low) and np.all(spot <= subtask.high))
