"""How the simulated teleoperator lifts, carries and puts down what it holds."""

from collections.abc import Generator

import numpy as np
from numpy.typing import NDArray

from prime_core.contracts.environment import Action
from prime_core.contracts.scene import Scene
from prime_core.rotations import rotation_matrix
from prime_envs_robosuite.demonstrators.movements import (
    OPEN,
    TRIES,
    UP,
    Movement,
    MovementOptions,
)
from prime_envs_robosuite.demonstrators.place_choice import (
    bringing,
    choose_spot,
    choose_yaw,
    goal_point,
)
from prime_envs_robosuite.demonstrators.teleoperated_gripper import TeleoperatedGripper
from prime_envs_robosuite.tasks.subtasks import PutInto, PutOnto

Array = NDArray[np.float64]

RELEASE_GAP = (0.001, 0.006)  # between a lowered object and the floor when let go of [m]
UPRIGHT = 0.98  # least cosine of the angle by which an object may be tilted in the end
DROP = 0.015  # from how much higher than wanted an object may be let go of [m]
RETREAT = (0.06, 0.11)  # upwards, from what was put down [m]
RETREAT_ASIDE = 0.01  # standard deviation [m]
ARCH_ROOM = 0.02  # by which those who lift while they carry go higher over walls [m]


class Placer:
    """Does what follows a grasp.

    Args:
        gripper: What is moved.
        generator: Where all randomness comes from.
    """

    def __init__(self, gripper: TeleoperatedGripper, generator: np.random.Generator) -> None:
        self._gripper = gripper
        self._generator = generator

    def hold_up(self, scene: Scene) -> Movement:
        """Lift the object and keep it there for a while."""
        height = self._generator.uniform(0.07, 0.16)
        drift = self._generator.normal(0.0, 0.02, 2)
        goal = scene.gripper_position + np.append(drift, height)
        scene = yield from self._gripper.move(scene, goal, scene.gripper_yaw)
        return (yield from self._gripper.wait(scene, int(self._generator.integers(10, 35))))

    def carry(self, scene: Scene, subtask: PutInto, floor: float) -> Movement:
        """Lift the object over the walls and bring it above where it goes.

        Args:
            scene: The scene now.
            subtask: Where it goes.
            floor: Height of the object's centre when it lies there [m].
        """
        gripper, draw = self._gripper, self._generator
        height = scene.description.lift_height + draw.uniform(-0.02, 0.02)
        target, yaw = choose_spot(scene, subtask, floor, draw)
        scene, over = yield from self._lift(scene, target, height)
        if scene.held is None:
            return scene
        options = MovementOptions(gripper.hesitates(), over=over)
        above = np.append(target, height - draw.uniform(0.0, 0.02))
        return (yield from gripper.reach(scene, above, yaw, options))

    def put_down(self, scene: Scene, subtask: PutInto, floor: float, is_last: bool) -> Movement:
        """Lower the object to just above the floor, let go, retreat and rest.

        Args:
            scene: The scene now.
            subtask: Where it goes.
            floor: Height of the object's centre when it lies there [m].
            is_last: Whether nothing is left to do after it.
        """
        gripper, draw = self._gripper, self._generator
        scene = yield from gripper.pause(scene)
        index = scene.object_index(subtask.object_name)
        drop = scene.object_positions[index, 2] - floor - draw.uniform(*RELEASE_GAP)
        goal = scene.gripper_position - np.array([0.0, 0.0, drop])
        scene = yield from gripper.move(scene, goal, scene.gripper_yaw)
        scene = yield from gripper.pause(scene, 0.7)
        if scene.object_positions[index, 2] - floor > DROP:
            return scene  # An arm that cannot get down: nothing is let go of here.
        return (yield from self._let_go(scene, RETREAT_ASIDE, RETREAT, is_last))

    def carry_over(self, scene: Scene, subtask: PutOnto) -> Movement:
        """Lift the object and bring its centre roughly above the point that it goes to."""
        gripper, draw = self._gripper, self._generator
        yaw = choose_yaw(scene, subtask, draw)
        clear = goal_point(scene, subtask) + (subtask.clearance + draw.uniform(0.0, 0.02)) * UP
        above = bringing(scene, subtask.object_name, clear, yaw)
        scene, over = yield from self._lift(scene, above[:2], above[2])
        if scene.held is None:
            return scene
        above = bringing(scene, subtask.object_name, clear, yaw)
        options = MovementOptions(gripper.hesitates(), over=over)
        return (yield from gripper.swing(scene, above, yaw, options))

    def fit(self, scene: Scene, subtask: PutOnto, is_last: bool) -> Movement:
        """Lower the object onto its point, let go, retreat; rise and aim again where it jams."""
        gripper, draw, name = self._gripper, self._generator, subtask.object_name
        index, yaw = scene.object_index(name), scene.gripper_yaw
        point = goal_point(scene, subtask)
        drop = draw.uniform(*subtask.drop)
        for _ in range(TRIES):
            scene = yield from gripper.pause(scene, 0.7)
            if subtask.yaws is not None:
                yaw = choose_yaw(scene, subtask, draw)
            # Look again where the object is after the correction.
            for height in (subtask.clearance, drop):
                goal = bringing(scene, name, point + height * UP, yaw)
                scene = yield from gripper.move(scene, goal, yaw, MovementOptions(straight=True))
            if scene.held != name:
                return scene
            scene = yield from gripper.pause(scene, 0.5)
            if scene.object_positions[index, 2] - point[2] < subtask.drop[1] + DROP:
                return (yield from self._let_go(scene, 0.0, subtask.retreat, is_last))
        return scene

    def _lift(
        self, scene: Scene, target: Array, height: float
    ) -> Generator[Action, Scene, tuple[Scene, float | None]]:
        """Lift the object, drifting a little towards where it goes, or leave it to the carrying.

        Args:
            scene: The scene now.
            target: x and y of where it goes [m], ``(2,)``.
            height: To which the gripper is lifted [m].

        Returns:
            The scene, and the height that the next movement has to arch up to [m], if any.
        """
        gripper, draw = self._gripper, self._generator
        if gripper.flows():
            return scene, height + ARCH_ROOM
        start = scene.gripper_position[:2]
        drifted = start + draw.uniform(0.0, 0.15) * (target - start)
        scene = yield from gripper.move(scene, np.append(drifted, height), scene.gripper_yaw)
        if draw.random() < 0.5:
            scene = yield from gripper.pause(scene)
        return scene, None

    def _let_go(
        self, scene: Scene, aside: float, retreat: tuple[float, float], is_last: bool
    ) -> Movement:
        """Open the gripper, retreat upwards and rest.

        Args:
            scene: The scene now.
            aside: Standard deviation of x and y of the retreat [m].
            retreat: How far it goes upwards, from and to [m].
            is_last: Whether nothing is left to do after it.
        """
        gripper, draw = self._gripper, self._generator
        scene = yield from gripper.grip(scene, OPEN)
        scene = yield from gripper.pause(scene, 0.3)
        if not is_last and gripper.stays_low():
            return scene
        away = np.append(draw.normal(0.0, aside, 2), draw.uniform(*retreat))
        scene = yield from gripper.move(scene, scene.gripper_position + away, scene.gripper_yaw)
        return (yield from gripper.wait(scene, int(draw.integers(5, 15))))


def stands(scene: Scene, name: str) -> bool:
    """Whether an object stands as it stood at the start, which all of them do."""
    quaternion = scene.object_quaternions[scene.object_index(name)]
    return bool(rotation_matrix(quaternion)[2, 2] > UPRIGHT)
