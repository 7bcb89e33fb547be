"""The simulated teleoperator: does one subtask after another by looking at the scenes."""

from collections.abc import Generator, Sequence

import numpy as np

from prime_core.contracts.environment import Action
from prime_core.contracts.scene import Scene
from prime_envs_robosuite.demonstrators.movements import TRIES, Outcome
from prime_envs_robosuite.demonstrators.picking import Picker
from prime_envs_robosuite.demonstrators.placing import Placer
from prime_envs_robosuite.demonstrators.pushing import Pusher
from prime_envs_robosuite.demonstrators.styles import MotionStyle
from prime_envs_robosuite.demonstrators.teleoperated_gripper import TeleoperatedGripper
from prime_envs_robosuite.tasks.subtasks import HoldUp, Picking, Push, PutInto, PutOnto, Subtask


class SimulatedTeleoperator:
    """Does subtasks by looking at the scenes.

    Args:
        subtasks: What is done, one after another.
        style: How, where no special care is taken.
        generator: Where all randomness comes from.
    """

    def __init__(
        self, subtasks: Sequence[Subtask], style: MotionStyle, generator: np.random.Generator
    ) -> None:
        self._subtasks = subtasks
        self._style = style
        self._gripper = TeleoperatedGripper(style.with_care(subtasks[0].care), generator)
        self._picker = Picker(self._gripper, style.misses, generator)
        self._placer = Placer(self._gripper, generator)
        self._pusher = Pusher(self._gripper, generator)

    @property
    def gripper_command(self) -> float:
        """The gripper's command now, -1 (open) or 1 (close)."""
        return self._gripper.command

    def perform(self, scene: Scene) -> Generator[Action, Scene, None]:
        """Do all subtasks, up to the first that fails."""
        scene = yield from self._gripper.pause(scene, 1.5)
        for subtask in self._subtasks:
            self._gripper.style = self._style.with_care(subtask.care)
            is_last = subtask is self._subtasks[-1]
            if isinstance(subtask, Push):
                scene, done = yield from self._pusher.push(scene, subtask, is_last)
            else:
                assert isinstance(subtask, Picking), "subtasks push or pick up"
                scene, done = yield from self._pick_and(scene, subtask, is_last)
            if not done:
                return

    def _pick_and(self, scene: Scene, subtask: Picking, is_last: bool) -> Outcome:
        """Pick the object up and do the rest; pick it up again if it gets lost."""
        placer = self._placer
        for _ in range(TRIES):
            scene, floor = yield from self._picker.pick(scene, subtask)
            if floor is None:
                return scene, False
            if scene.held != subtask.object_name:
                continue
            if isinstance(subtask, HoldUp):
                scene = yield from placer.hold_up(scene)
            elif isinstance(subtask, PutInto):
                scene = yield from placer.carry(scene, subtask, floor + subtask.rise)
            elif isinstance(subtask, PutOnto):
                scene = yield from placer.carry_over(scene, subtask)
            if scene.held != subtask.object_name:
                continue
            if isinstance(subtask, PutInto):
                scene = yield from placer.put_down(scene, subtask, floor + subtask.rise, is_last)
            elif isinstance(subtask, PutOnto):
                scene = yield from placer.fit(scene, subtask, is_last)
            return scene, (scene.held is None) != isinstance(subtask, HoldUp)
        return scene, False
