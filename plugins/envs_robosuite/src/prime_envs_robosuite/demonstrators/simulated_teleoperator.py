"""Settings of the simulated teleoperator, and the recording of its demonstrations."""

from collections.abc import Sequence
from dataclasses import replace
from math import inf
from typing import TYPE_CHECKING

import numpy as np
from pydantic import Field

from prime_core.configuration import Count, Share, StepRange
from prime_core.contracts.demonstration import Demonstration, DemonstratorConfig
from prime_core.contracts.environment import EnvironmentConfig
from prime_core.contracts.scene import Scene
from prime_core.errors import PrimeError
from prime_core.seeds import Stream, generator_of
from prime_envs_robosuite.demonstrators.grasp_choice import are_apart
from prime_envs_robosuite.demonstrators.placing import stands
from prime_envs_robosuite.demonstrators.styles import NOVICE, Style
from prime_envs_robosuite.demonstrators.teleoperator import SimulatedTeleoperator
from prime_envs_robosuite.tasks.subtasks import Subtask, in_opposite_order

if TYPE_CHECKING:
    from prime_envs_robosuite.environment import RobosuiteEnvironment

NAME = "simulated-teleoperator"


class SimulatedTeleoperatorConfig(DemonstratorConfig):
    """Demonstrations by a simulated teleoperator, who does the subtasks of a robosuite task.

    They do not follow any primitive's own waypoints. Each draws a style of its own: bent paths, a
    pace, pauses, overshoot and correction, noise, approach and grasp yaws, misses that are mended.
    """

    count: Count = 30
    """How many demonstrations there are."""

    style: Style = NOVICE
    """How the gripper is moved: ``novice``, ``practised`` or ``quick``, or ranges of your own."""

    grip_within: float | None = Field(None, gt=0, le=1)
    """How far from where it should the gripper may close [m]. If it is farther away, it is moved
    again, and the attempt is given up where that does not help. By default it is not looked at."""

    other_order_share: Share = 0.0
    """Share of demonstrations in which the objects are picked up in the opposite order, if they
    lie so far from each other that none is knocked over."""

    ends_when_solved: bool = True
    """Whether a demonstration ends where its task is solved, without the retreat after it. What
    comes after teaches a policy to retreat where it should try again."""

    steps: StepRange = (150, 500)
    """Least and greatest number of motor actions, those after the task is solved included."""

    attempts: int = Field(20, ge=1, le=10_000)
    """Draws that are tried until one succeeds within those numbers of steps."""

    def count_available(self) -> int:
        """How many demonstrations it gives."""
        return self.count

    def demonstrate(self, environment: EnvironmentConfig, index: int, seed: int) -> Demonstration:
        """Return one demonstration, that ends in success; see `DemonstratorConfig`."""
        from prime_envs_robosuite.recorder import build_for_recording

        if not 0 <= index < self.count:
            raise PrimeError(f"{NAME} has demonstrations 0 to {self.count - 1}, not {index}")
        built = build_for_recording(environment, NAME)
        try:
            for attempt in range(self.attempts):
                shown = _attempt(built, self, _generator(seed, index, attempt))
                if shown is not None:
                    return shown
        finally:
            built.close()
        raise PrimeError(
            f"{NAME}: no demonstration {index} of seed {seed} succeeded in {self.attempts} "
            f"attempts within {self.steps[0]} to {self.steps[1]} steps; allow more attempts or "
            "steps, or narrow the ranges"
        )

    def draw_operator(
        self, subtasks: Sequence[Subtask], scene: Scene, generator: np.random.Generator
    ) -> SimulatedTeleoperator:
        """Draw in which style and in which order subtasks are done."""
        aside = generator.spawn(1)[0]
        style = replace(self.style.draw(generator, aside), grip_within=self.grip_within or inf)
        if aside.random() < self.other_order_share and are_apart(scene, subtasks):
            subtasks = in_opposite_order(subtasks)
        return SimulatedTeleoperator(subtasks, style, generator)


def _generator(seed: int, index: int, attempt: int) -> np.random.Generator:
    """Return where all randomness of one attempt comes from."""
    return generator_of(Stream.DEMONSTRATIONS, seed, index, attempt)


def _attempt(
    environment: "RobosuiteEnvironment",
    config: SimulatedTeleoperatorConfig,
    generator: np.random.Generator,
) -> Demonstration | None:
    """Try to do the task once; None if it fails."""
    from prime_envs_robosuite.recorder import Recorder

    environment.reset(seed=int(generator.integers(2**31)))
    recorder = Recorder(environment)
    subtasks = environment.task.subtasks()
    operator = config.draw_operator(subtasks, environment.scene(), generator)
    least, most = config.steps
    doing = operator.perform(environment.scene())
    action = next(doing, None)
    while action is not None and len(recorder) <= most:
        # What is stored as float32 is what is done, so that replaying it is exact.
        stored = action.astype(np.float32)
        recorder.add(stored)
        environment.step(stored.astype(np.float64))
        try:
            action = doing.send(environment.scene())
        except StopIteration:
            action = None
    scene = environment.scene()
    solved = environment.is_success() and all(stands(scene, item.object_name) for item in subtasks)
    if not (solved and least <= len(recorder) <= most):
        return None
    return recorder.finish(operator.gripper_command, config.ends_when_solved)
