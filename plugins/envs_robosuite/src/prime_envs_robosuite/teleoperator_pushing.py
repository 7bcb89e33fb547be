"""How a simulated person pushes objects over the table."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from prime_core.contracts.scene import Scene
from prime_core.rotations import wrap_angle
from prime_envs_robosuite.jobs import Push
from prime_envs_robosuite.teleoperator_choices import GREATEST_YAW
from prime_envs_robosuite.teleoperator_motion import (
    CLOSE,
    OPEN,
    TRIES,
    Hand,
    Movement,
    Outcome,
    Way,
)

Array = NDArray[np.float64]

STROKES = 6  # of a push, from one side
DRAW_BACK = 0.02  # from a pushed object, before rising beside it [m]
PUSHED = 0.015  # from where a pushed object should be, near enough [m]
STRAIGHT = Way(straight=True)


class Pusher:
    """Pushes with the closed gripper.

    Args:
        hand: Moves the gripper.
        generator: Where all randomness comes from.
    """

    def __init__(self, hand: Hand, generator: np.random.Generator) -> None:
        self._hand = hand
        self._generator = generator

    def push(self, scene: Scene, job: Push, is_last: bool) -> Outcome:
        """Push the object into its region, from as many sides as it takes.

        Args:
            scene: The scene now.
            job: What is pushed where.
            is_last: Whether nothing is left to do after it.
        """
        hand, index = self._hand, scene.object_index(job.object_name)
        target = self._generator.uniform(job.low, job.high)
        if hand.gripper == OPEN and hand.has_risen:
            scene = yield from hand.grip(scene, CLOSE)
        for _ in range(TRIES):
            spot = scene.object_positions[index, :2]
            way = target - spot
            distance = float(np.linalg.norm(way))
            if distance < PUSHED or _is_inside(spot, job):
                return scene, True
            direction = way / distance
            scene = yield from self._come_down_beside(scene, job, direction)
            scene = yield from self._push_on(scene, job, target, direction)
            scene = yield from self._leave(scene, direction, is_last)
        return scene, _is_inside(scene.object_positions[index, :2], job)

    def _come_down_beside(self, scene: Scene, job: Push, direction: Array) -> Movement:
        """Bring the closed gripper down behind the object, seen in the direction ``(2,)``."""
        hand = self._hand
        # The hand's broad side pushes; which way its thin side points does not matter.
        yaw = float(wrap_angle(np.arctan2(direction[1], direction[0]), np.pi))
        yaw = float(np.clip(yaw, -GREATEST_YAW, GREATEST_YAW))
        spot = scene.object_positions[scene.object_index(job.object_name), :2]
        beside = spot - job.standoff * direction
        low, high = np.append(beside, job.height), scene.description.lift_height
        way = hand.way_on(scene, CLOSE)
        if hand.flows():
            scene = yield from hand.move(scene, low, yaw, replace(way, over=high))
            return (yield from hand.pause(scene, 0.5))
        scene = yield from hand.reach(scene, np.append(beside, high), yaw, way)
        scene = yield from hand.pause(scene, 0.5)
        return (yield from hand.move(scene, low, yaw, STRAIGHT))

    def _push_on(self, scene: Scene, job: Push, target: Array, direction: Array) -> Movement:
        """Push in a direction ``(2,)`` until the object is as far as its target ``(2,)`` [m]."""
        index = scene.object_index(job.object_name)
        for _ in range(STROKES):
            spot = scene.object_positions[index, :2]
            left = float((target - spot) @ direction)
            if left < PUSHED / 3 or _is_inside(spot, job):
                break
            # Before they touch it, people know by its size where the fingers will.
            behind = float((spot - scene.gripper_position[:2]) @ direction)
            goal = np.append(spot + (left - min(behind, job.touching)) * direction, job.height)
            scene = yield from self._hand.move(scene, goal, scene.gripper_yaw, STRAIGHT)
        return scene

    def _leave(self, scene: Scene, direction: Array, is_last: bool) -> Movement:
        """Draw the fingers back from what was pushed in a direction ``(2,)``, and rise."""
        hand, yaw = self._hand, scene.gripper_yaw
        back = scene.gripper_position - np.append(DRAW_BACK * direction, 0.0)
        above = np.append(back[:2], scene.description.lift_height)
        if not is_last and hand.stays_low():
            return (yield from hand.move(scene, back, yaw, STRAIGHT))
        if hand.flows():
            return (yield from hand.move(scene, above, yaw, STRAIGHT))
        scene = yield from hand.move(scene, back, yaw, STRAIGHT)
        return (yield from hand.move(scene, above, yaw))


def _is_inside(spot: Array, job: Push) -> bool:
    """Whether a point ``(2,)`` [m] is in the region that a job pushes into."""
    return bool(np.all(spot >= job.low) and np.all(spot <= job.high))
