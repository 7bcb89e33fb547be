"""Simulated people: demonstrations that do not follow any primitive's own waypoints."""

from collections.abc import Sequence
from math import inf
from typing import TYPE_CHECKING, Annotated

import numpy as np
from pydantic import AfterValidator, Field, PositiveFloat, PositiveInt

from prime_core.configuration import PositiveRange, Range, StepRange
from prime_core.contracts.demonstration import Demonstration, DemonstratorConfig
from prime_core.contracts.environment import EnvironmentConfig
from prime_core.contracts.scene import Scene
from prime_core.errors import PrimeError
from prime_core.seeds import Stream, generator_of
from prime_envs_robosuite.jobs import Job, in_opposite_order
from prime_envs_robosuite.teleoperator_choices import are_apart
from prime_envs_robosuite.teleoperator_motion import Style
from prime_envs_robosuite.teleoperator_person import Person, stands

if TYPE_CHECKING:
    from prime_envs_robosuite.environment import RobosuiteEnvironment

NAME = "simulated-teleoperator"


MOTION = ("speed", "pause", "bow", "aim", "yaw_aim", "overshoot", "noise", "hover")
HABITS = ("ramp", "turn_speed", "flow")


def _at_most_one(value: tuple[float, float]) -> tuple[float, float]:
    if value[1] > 1:
        raise ValueError(f"shares are at most 1; found {list(value)}")
    return value


Shares = Annotated[Range, AfterValidator(_at_most_one)]


class SimulatedTeleoperatorConfig(DemonstratorConfig):
    """Demonstrations by simulated people, who do the jobs that a robosuite task consists of.

    Each demonstration draws a style of its own from the ranges: bent paths, a pace, pauses,
    overshoot and correction, noise, approach and grasp yaws, misses that are mended.
    """

    count: PositiveInt = 30
    """How many demonstrations there are."""

    speed: PositiveRange = (0.14, 0.24)
    """Mean speed of long movements [m/s]."""

    pause: Range = (0.3, 0.8)
    """Mean length of pauses [s]."""

    bow: Range = (0.03, 0.15)
    """How far movements bend aside, as a share of their length."""

    aim: Range = (0.003, 0.01)
    """Standard deviation of where long movements end before they are corrected [m]."""

    yaw_aim: Range = (0.05, 0.25)
    """Standard deviation of the yaw that long movements end at [rad]."""

    overshoot: Range = (0.0, 0.02)
    """How far long movements run past their goals [m]."""

    noise: Range = (0.05, 0.2)
    """Coloured noise on the commands, as a share of them."""

    hover: Range = (0.06, 0.12)
    """Height above a grasp at which the approach ends [m]."""

    ramp: PositiveRange = (0.6, 0.6)
    """Time in which long movements reach their speed [s]."""

    turn_speed: PositiveRange = (0.9, 0.9)
    """Mean speed of turning [rad/s]."""

    flow: Shares = (0.0, 0.0)
    """Share of movements that go over into the next without a stop, as those of the experienced
    do: lifts bend into carrying, corrections are left to the next movement, and from where
    something was let go of the hand goes on to the next object."""

    grip_within: PositiveFloat | None = None
    """How far from where it should the gripper may close [m]. People whose hand is farther away
    correct it, and give up where they cannot. Without it they do not look again."""

    miss_share: float = Field(0.2, ge=0, le=1)
    """Share of demonstrations whose first grasp closes too early and misses."""

    other_yaw_share: float = Field(0.25, ge=0, le=1)
    """Share of grasps at another yaw than the nearest that the object's symmetry allows."""

    other_order_share: float = Field(0.0, ge=0, le=1)
    """Share of demonstrations in which the things to take are taken in the opposite order, if they
    lie so far from each other that none is knocked over."""

    steps: StepRange = (150, 500)
    """Least and greatest number of motor actions."""

    attempts: PositiveInt = 20
    """Draws that are tried until one succeeds within those numbers of steps."""

    def count_available(self) -> int:
        """How many demonstrations it gives."""
        return self.count

    def demonstrate(self, environment: EnvironmentConfig, index: int, seed: int) -> Demonstration:
        """Return one demonstration, that ends in success; see `DemonstratorConfig`."""
        from prime_envs_robosuite.recording import build_for_recording

        if not 0 <= index < self.count:
            raise PrimeError(f"{NAME} has demonstrations 0 to {self.count - 1}, not {index}")
        built = build_for_recording(environment, NAME)
        try:
            for attempt in range(self.attempts):
                generator = generator_of(Stream.DEMONSTRATIONS, seed, index, attempt)
                shown = _show(built, self, generator)
                if shown is not None:
                    return shown
        finally:
            built.close()
        raise PrimeError(
            f"{NAME}: no demonstration {index} of seed {seed} succeeded in {self.attempts} "
            f"attempts within {self.steps[0]} to {self.steps[1]} steps; allow more attempts or "
            "steps, or narrow the ranges"
        )

    def draw_person(
        self, jobs: Sequence[Job], scene: Scene, generator: np.random.Generator
    ) -> Person:
        """Draw who does jobs, how, and in which order."""
        drawn = {name: float(generator.uniform(*getattr(self, name))) for name in MOTION}
        misses = bool(generator.random() < self.miss_share)
        # Drawn aside: settings that came later leave earlier people as they were.
        aside = generator.spawn(1)[0]
        drawn |= {name: float(aside.uniform(*getattr(self, name))) for name in HABITS}
        if aside.random() < self.other_order_share and are_apart(scene, jobs):
            jobs = in_opposite_order(jobs)
        style = Style(**drawn, grip_within=self.grip_within or inf)
        return Person(jobs, style, misses, self.other_yaw_share, generator)


def _show(
    environment: "RobosuiteEnvironment",
    config: SimulatedTeleoperatorConfig,
    generator: np.random.Generator,
) -> Demonstration | None:
    """Try to do the task once; None if it fails."""
    from prime_envs_robosuite.recording import Recorder

    environment.reset(seed=int(generator.integers(2**31)))
    recorder = Recorder(environment)
    jobs = environment.task.jobs()
    person = config.draw_person(jobs, environment.scene(), generator)
    least, most = config.steps
    doing = person.perform(environment.scene())
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
    solved = environment.is_success() and all(stands(scene, job.object_name) for job in jobs)
    if not (solved and least <= len(recorder) <= most):
        return None
    return recorder.finish(person.hand.gripper, environment.task.words)
