"""Simulated people: demonstrations that do not follow any primitive's own waypoints."""

from collections.abc import Generator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import AfterValidator, Field, PositiveInt

from prime_core.demonstration import Demonstration, DemonstratorConfig
from prime_core.environment import Action, EnvironmentConfig
from prime_core.errors import PrimeError
from prime_core.rotations import rotation_matrix, wrap_angle, yaw_of
from prime_core.scene import Affordance, Scene
from prime_envs_robosuite.teleoperator_motion import CLOSE, OPEN, Hand, Movement, Style

if TYPE_CHECKING:
    from prime_envs_robosuite.environment import RobosuiteEnvironment

Array = NDArray[np.float64]

NAME = "simulated-teleoperator"
TRIES = 4  # grasps that a person attempts before giving up
WALL_MARGIN = 0.045  # between where an object is put and the border of its region [m]
ARM_BASE = np.array([-0.5, -0.1])  # of the arm before robosuite's bins, world frame [m]
EASY_REACH = 0.77  # from there in the plane [m]; farther out the elbow is all but straight
UPRIGHT = 0.98  # least cosine of the angle by which an object may be tilted in the end
RELEASE_GAP = (0.001, 0.006)  # between a lowered object and the floor when let go of [m]
DROP = 0.015  # from how high an object may be let go of [m]
GREATEST_YAW = 1.4  # of the gripper [rad]; the arm's last joint ends beyond a quarter turn


def _ordered(value: tuple[float, float]) -> tuple[float, float]:
    if not 0 <= value[0] <= value[1]:
        raise ValueError(f"a range is two numbers, 0 <= low <= high; found {list(value)}")
    return value


Range = Annotated[tuple[float, float], AfterValidator(_ordered)]


class SimulatedTeleoperatorConfig(DemonstratorConfig):
    """Demonstrations by simulated people, for the Lift and PickPlace environments.

    Each demonstration draws a style of its own from the ranges: bent paths, a pace, pauses,
    overshoot and correction, noise, approach and grasp yaws, misses that are mended.
    """

    count: PositiveInt = 30
    """How many demonstrations there are."""

    speed: Range = (0.1, 0.18)
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

    miss_share: float = Field(0.15, ge=0, le=1)
    """Share of demonstrations whose first grasp closes too early and misses."""

    other_yaw_share: float = Field(0.25, ge=0, le=1)
    """Share of grasps at another yaw than the nearest that the object's symmetry allows."""

    steps: tuple[PositiveInt, PositiveInt] = (150, 500)
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
            job = _job(built)
            for attempt in range(self.attempts):
                generator = np.random.default_rng([seed, index, attempt])
                shown = _show(built, job, self, generator)
                if shown is not None:
                    return shown
        finally:
            built.close()
        raise PrimeError(
            f"{NAME}: no demonstration {index} of seed {seed} succeeded in {self.attempts} "
            f"attempts within {self.steps[0]} to {self.steps[1]} steps; allow more attempts or "
            "steps, or narrow the ranges"
        )

    def draw_style(self, generator: np.random.Generator, care: float = 1.0) -> Style:
        """Draw how one person moves.

        Args:
            generator: Where all draws come from.
            care: How much slower than usual.
        """
        names = ("speed", "pause", "bow", "aim", "yaw_aim", "overshoot", "noise", "hover")
        drawn = {name: float(generator.uniform(*getattr(self, name))) for name in names}
        return Style(**drawn | {"speed": drawn["speed"] / care, "pause": drawn["pause"] * care})


@dataclass(frozen=True)
class _Job:
    """What a person is asked to do.

    Attributes:
        object_name: What to take.
        grasp: Where the object can be taken.
        region: Lower and upper corner of where to put it [m], ``(2, 2)``; None to hold it up.
        task: The same in words.
        care: How much slower people are than usual, with something small and close by.
    """

    object_name: str
    grasp: Affordance
    region: Array | None
    task: str
    care: float


def _job(environment: "RobosuiteEnvironment") -> _Job:
    """Return what to do in an environment.

    Raises:
        PrimeError: If nobody has been taught its task.
    """
    from prime_envs_robosuite.lift import LiftTask
    from prime_envs_robosuite.pick_place import QUARTER_SIZE, PickPlaceTask, quarter_centre

    task = environment.task
    grasp = environment.description.affordances_for("grasp")[0]
    if isinstance(task, LiftTask):
        return _Job("cube", grasp, None, "lift the cube", care=1.6)
    if isinstance(task, PickPlaceTask):
        half = np.array(QUARTER_SIZE) / 2 - WALL_MARGIN
        centre = quarter_centre(task.shape.quarter)
        region = np.stack((centre - half, centre + half))
        return _Job(task.kind, grasp, region, f"put the {task.kind} into its bin", care=1.0)
    raise PrimeError(
        f"{NAME} knows the tasks of 'robosuite/lift' and 'robosuite/pick-place', "
        f"not {type(task).__name__}"
    )


def _show(
    environment: "RobosuiteEnvironment",
    job: _Job,
    config: SimulatedTeleoperatorConfig,
    generator: np.random.Generator,
) -> Demonstration | None:
    """Try to do the job once; None if it fails."""
    from prime_envs_robosuite.recording import Recorder

    environment.reset(seed=int(generator.integers(2**31)))
    recorder = Recorder(environment)
    person = _Person(job, config, generator)
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
    solved = environment.is_success() and _upright(environment.scene(), job)
    if not (solved and least <= len(recorder) <= most):
        return None
    return recorder.finish(person.hand.gripper, job.task)


def _upright(scene: Scene, job: _Job) -> bool:
    """Whether the object stands as it stood at the start, which all of them do."""
    quaternion = scene.object_quaternions[scene.object_index(job.object_name)]
    return bool(rotation_matrix(quaternion)[2, 2] > UPRIGHT)


class _Person:
    """Does a job by looking at the scenes.

    Args:
        job: What to do.
        config: The ranges of styles.
        generator: Where all randomness comes from.
    """

    def __init__(
        self, job: _Job, config: SimulatedTeleoperatorConfig, generator: np.random.Generator
    ) -> None:
        self.job = job
        self.hand = Hand(config.draw_style(generator, job.care), generator)
        self._generator = generator
        self._misses = bool(generator.random() < config.miss_share)
        self._other_yaw_share = config.other_yaw_share

    def perform(self, scene: Scene) -> Generator[Action, Scene, None]:
        """Do the whole job; take the object again if it gets lost."""
        scene = yield from self.hand.pause(scene, 1.5)
        for _ in range(TRIES):
            scene, floor = yield from self._take(scene)
            if scene.held is None:
                continue
            if self.job.region is None:
                scene = yield from self._hold_up(scene)
                if scene.held is not None:
                    return
                continue
            scene = yield from self._carry(scene, self.job.region)
            if scene.held is not None:
                yield from self._put_down(scene, floor)
                return

    def _take(self, scene: Scene) -> Generator[Action, Scene, tuple[Scene, float]]:
        """Grasp the object; returns the scene and the height at which the object lay [m]."""
        hand, draw = self.hand, self._generator
        up = np.array([0.0, 0.0, 1.0])
        if hand.gripper == CLOSE:
            scene = yield from hand.grip(scene, OPEN)
            scene = yield from hand.move(
                scene, scene.gripper_position + draw.uniform(0.02, 0.05) * up, scene.gripper_yaw
            )
        position, yaw = self._grasp(scene)
        hesitate = bool(draw.random() < 0.4)
        scene = yield from hand.reach(scene, position + hand.style.hover * up, yaw, hesitate)
        scene = yield from hand.pause(scene)
        if self._misses:
            self._misses = False
            scene = yield from self._miss(scene, position, yaw)
        floor = float(scene.object_positions[scene.object_index(self.job.object_name), 2])
        scene = yield from hand.move(scene, position, yaw)
        scene = yield from hand.pause(scene, 0.5)
        scene = yield from hand.grip(scene, CLOSE)
        scene = yield from hand.pause(scene, 0.7)
        return scene, floor

    def _miss(self, scene: Scene, position: Array, yaw: float) -> Movement:
        """Close the gripper above the object, notice, and open it again."""
        height = self._generator.uniform(0.055, 0.065)
        scene = yield from self.hand.move(scene, position + np.array([0.0, 0.0, height]), yaw)
        scene = yield from self.hand.grip(scene, CLOSE)
        scene = yield from self.hand.pause(scene)
        scene = yield from self.hand.grip(scene, OPEN)
        return (yield from self.hand.pause(scene, 0.5))

    def _grasp(self, scene: Scene) -> tuple[Array, float]:
        """Choose where to take the object: position [m] ``(3,)`` and yaw [rad]."""
        draw, spot = self._generator, self.job.grasp
        index = scene.object_index(self.job.object_name)
        own_yaw = float(yaw_of(scene.object_quaternions[index]))
        cosine, sine = np.cos(own_yaw), np.sin(own_yaw)
        turn = np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])
        offset = turn @ draw.uniform(spot.low, spot.high) + draw.normal(0.0, 0.003, 3)
        yaws = spot.yaws if spot.yaws is not None else tuple(draw.uniform(-np.pi, np.pi, 4))
        # A half turn of the gripper swaps its fingers and changes nothing else.
        turns = wrap_angle([own_yaw + yaw for yaw in yaws], period=np.pi)
        nearest = turns[np.argsort(np.abs(turns - scene.gripper_yaw))]
        reachable = [yaw for yaw in nearest if abs(yaw) < GREATEST_YAW] or list(nearest)
        other = len(reachable) > 1 and draw.random() < self._other_yaw_share
        yaw = reachable[1 if other else 0] + draw.uniform(-0.1, 0.1)
        return scene.object_positions[index] + offset, float(yaw)

    def _hold_up(self, scene: Scene) -> Movement:
        """Lift the object and keep it there for a while."""
        height = self._generator.uniform(0.07, 0.16)
        drift = self._generator.normal(0.0, 0.02, 2)
        goal = scene.gripper_position + np.append(drift, height)
        scene = yield from self.hand.move(scene, goal, scene.gripper_yaw)
        return (yield from self.hand.wait(scene, int(self._generator.integers(10, 35))))

    def _carry(self, scene: Scene, region: Array) -> Movement:
        """Lift the object over the walls and bring it above where it goes.

        Args:
            scene: The scene now.
            region: Corners of where the object may be put [m], ``(2, 2)``.
        """
        hand, draw = self.hand, self._generator
        height = scene.description.lift_height + draw.uniform(-0.02, 0.02)
        spots = draw.uniform(region[0], region[1], (20, 2))
        far = np.linalg.norm(spots - ARM_BASE, axis=1) > EASY_REACH
        target = spots[np.argmin(far)]
        start = scene.gripper_position[:2]
        drifted = start + draw.uniform(0.0, 0.15) * (target - start)
        scene = yield from hand.move(scene, np.append(drifted, height), scene.gripper_yaw)
        if draw.random() < 0.5:
            scene = yield from hand.pause(scene)
        if scene.held is None:
            return scene
        turn = draw.uniform(-0.6, 0.6)
        yaw = float(np.clip(scene.gripper_yaw + turn, -GREATEST_YAW, GREATEST_YAW))
        hesitate = bool(draw.random() < 0.4)
        above = np.append(target, height - draw.uniform(0.0, 0.02))
        return (yield from hand.reach(scene, above, yaw, hesitate))

    def _put_down(self, scene: Scene, floor: float) -> Movement:
        """Lower the object to just above the floor, let go, retreat and rest.

        Args:
            scene: The scene now.
            floor: Height of the object's centre when it lies [m].
        """
        hand, draw = self.hand, self._generator
        scene = yield from hand.pause(scene)
        index = scene.object_index(self.job.object_name)
        drop = scene.object_positions[index, 2] - floor - draw.uniform(*RELEASE_GAP)
        goal = scene.gripper_position - np.array([0.0, 0.0, drop])
        scene = yield from hand.move(scene, goal, scene.gripper_yaw)
        scene = yield from hand.pause(scene, 0.7)
        if scene.object_positions[index, 2] - floor > DROP:
            return scene  # An arm that cannot get down: nobody would let go here.
        scene = yield from hand.grip(scene, OPEN)
        scene = yield from hand.pause(scene, 0.3)
        away = np.append(draw.normal(0.0, 0.01, 2), draw.uniform(0.06, 0.11))
        scene = yield from hand.move(scene, scene.gripper_position + away, scene.gripper_yaw)
        return (yield from hand.wait(scene, int(draw.integers(5, 15))))
