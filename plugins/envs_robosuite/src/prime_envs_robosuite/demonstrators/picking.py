"""How the simulated teleoperator grasps objects, misses them and looks again."""

from collections.abc import Generator

import numpy as np
from numpy.typing import NDArray

from prime_core.contracts.environment import Action
from prime_core.contracts.scene import Scene
from prime_envs_robosuite.demonstrators.grasp_choice import choose_grasp
from prime_envs_robosuite.demonstrators.movements import CLOSE, OPEN, UP, Movement
from prime_envs_robosuite.demonstrators.teleoperated_gripper import TeleoperatedGripper
from prime_envs_robosuite.tasks.subtasks import Picking

Array = NDArray[np.float64]

CORRECTIONS = 3  # of where the gripper closes, before an attempt is given up
MISSED_HEIGHT = (0.055, 0.065)  # over a grasp at which one that misses closes [m]: above the object


class Picker:
    """Grasps with the opened gripper.

    Args:
        gripper: What is moved.
        misses: Whether the first grasp closes too early.
        generator: Where all randomness comes from.
    """

    def __init__(
        self, gripper: TeleoperatedGripper, misses: bool, generator: np.random.Generator
    ) -> None:
        self._gripper = gripper
        self._misses = misses
        self._generator = generator

    def pick(
        self, scene: Scene, subtask: Picking
    ) -> Generator[Action, Scene, tuple[Scene, float | None]]:
        """Grasp the object.

        Returns:
            The scene, and the height at which the object lay [m]; None where something stopped the
            gripper on its way, so that it was not closed.
        """
        gripper, draw = self._gripper, self._generator
        if gripper.command == CLOSE and gripper.has_risen:
            scene = yield from gripper.grip(scene, OPEN)
            scene = yield from gripper.move(
                scene, scene.gripper_position + draw.uniform(0.02, 0.05) * UP, scene.gripper_yaw
            )
        position, yaw = choose_grasp(scene, subtask, draw)
        above = position + gripper.style.hover * UP
        options = gripper.options_onward(scene, OPEN, gripper.hesitates())
        scene = yield from gripper.reach(scene, above, yaw, options)
        scene = yield from gripper.pause(scene)
        if self._misses:
            self._misses = False
            scene = yield from self._miss(scene, position, yaw)
        floor = float(scene.object_positions[scene.object_index(subtask.object_name), 2])
        scene = yield from gripper.move(scene, position, yaw)
        scene = yield from gripper.pause(scene, 0.5)
        for _ in range(CORRECTIONS):
            if not self._is_off(scene, position):
                break
            scene = yield from gripper.move(scene, position, yaw)
            scene = yield from gripper.pause(scene, 0.5)
        if self._is_off(scene, position):
            return scene, None
        scene = yield from gripper.grip(scene, CLOSE)
        scene = yield from gripper.pause(scene, 0.7)
        return scene, floor

    def _is_off(self, scene: Scene, position: Array) -> bool:
        """Whether the gripper is too far from where it should close [m], ``(3,)``."""
        away = np.linalg.norm(scene.gripper_position - position)
        return bool(away > self._gripper.style.grip_within)

    def _miss(self, scene: Scene, position: Array, yaw: float) -> Movement:
        """Close the gripper above the object, notice, and open it again."""
        gripper = self._gripper
        height = self._generator.uniform(*MISSED_HEIGHT)
        scene = yield from gripper.move(scene, position + height * UP, yaw)
        scene = yield from gripper.grip(scene, CLOSE)
        scene = yield from gripper.pause(scene)
        scene = yield from gripper.grip(scene, OPEN)
        return (yield from gripper.pause(scene, 0.5))
