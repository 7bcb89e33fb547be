"""What a simulated person does with objects that it takes, and one job after another."""

from collections.abc import Generator, Sequence

import numpy as np
from numpy.typing import NDArray

from prime_core.contracts.environment import Action
from prime_core.contracts.scene import Scene
from prime_core.rotations import rotation_matrix
from prime_envs_robosuite.jobs import HoldUp, Job, Push, PutInto, PutOnto, Taking
from prime_envs_robosuite.teleoperator_choices import (
    bringing,
    choose_grasp,
    choose_spot,
    choose_yaw,
    goal_point,
)
from prime_envs_robosuite.teleoperator_motion import (
    CLOSE,
    OPEN,
    TRIES,
    Hand,
    Movement,
    Outcome,
    Style,
    Way,
)
from prime_envs_robosuite.teleoperator_pushing import Pusher

Array = NDArray[np.float64]
UP = np.array([0.0, 0.0, 1.0])

RELEASE_GAP = (0.001, 0.006)  # between a lowered object and the floor when let go of [m]
UPRIGHT = 0.98  # least cosine of the angle by which an object may be tilted in the end
CORRECTIONS = 3  # of where the hand closes, before a person gives up
DROP = 0.015  # from how much higher than wanted an object may be let go of [m]
RETREAT = (0.06, 0.11)  # upwards, from what was put down [m]
RETREAT_ASIDE = 0.01  # standard deviation [m]
ARCH_ROOM = 0.02  # by which people who lift while they carry go higher over walls [m]


class Person:
    """Does jobs by looking at the scenes.

    Args:
        jobs: What to do, one after another.
        style: How, where no special care is taken.
        misses: Whether the first grasp closes too early.
        other_yaw_share: Share of grasps at another yaw than the nearest.
        generator: Where all randomness comes from.

    Attributes:
        hand: What moves the gripper.
    """

    def __init__(
        self,
        jobs: Sequence[Job],
        style: Style,
        misses: bool,
        other_yaw_share: float,
        generator: np.random.Generator,
    ) -> None:
        self.hand = Hand(style.with_care(jobs[0].care), generator)
        self._jobs = jobs
        self._style = style
        self._generator = generator
        self._misses = misses
        self._other_yaw_share = other_yaw_share
        self._is_last = False
        self._pusher = Pusher(self.hand, generator)

    def perform(self, scene: Scene) -> Generator[Action, Scene, None]:
        """Do all jobs, up to the first that fails."""
        scene = yield from self.hand.pause(scene, 1.5)
        for job in self._jobs:
            self.hand.style = self._style.with_care(job.care)
            self._is_last = job is self._jobs[-1]
            if isinstance(job, Push):
                scene, done = yield from self._pusher.push(scene, job, self._is_last)
            else:
                assert isinstance(job, Taking), "jobs push or take"
                scene, done = yield from self._take_and(scene, job)
            if not done:
                return

    def _take_and(self, scene: Scene, job: Taking) -> Outcome:
        """Take the object and do the rest; take it again if it gets lost."""
        for _ in range(TRIES):
            scene, floor = yield from self._take(scene, job)
            if floor is None:
                return scene, False
            if scene.held != job.object_name:
                continue
            if isinstance(job, HoldUp):
                scene = yield from self._hold_up(scene)
            elif isinstance(job, PutInto):
                scene = yield from self._carry(scene, job, floor + job.rise)
            elif isinstance(job, PutOnto):
                scene = yield from self._carry_over(scene, job)
            if scene.held != job.object_name:
                continue
            if isinstance(job, PutInto):
                scene = yield from self._put_down(scene, job, floor + job.rise)
            elif isinstance(job, PutOnto):
                scene = yield from self._fit(scene, job)
            return scene, (scene.held is None) != isinstance(job, HoldUp)
        return scene, False

    def _take(
        self, scene: Scene, job: Taking
    ) -> Generator[Action, Scene, tuple[Scene, float | None]]:
        """Grasp the object.

        Returns:
            The scene, and the height at which the object lay [m]; None where something stopped the
            hand on its way, and nobody would grip.
        """
        hand, draw = self.hand, self._generator
        if hand.gripper == CLOSE and hand.has_risen:
            scene = yield from hand.grip(scene, OPEN)
            scene = yield from hand.move(
                scene, scene.gripper_position + draw.uniform(0.02, 0.05) * UP, scene.gripper_yaw
            )
        position, yaw = choose_grasp(scene, job, self._other_yaw_share, draw)
        above = position + hand.style.hover * UP
        way = hand.way_on(scene, OPEN, self._hesitates())
        scene = yield from hand.reach(scene, above, yaw, way)
        scene = yield from hand.pause(scene)
        if self._misses:
            self._misses = False
            scene = yield from self._miss(scene, position, yaw)
        floor = float(scene.object_positions[scene.object_index(job.object_name), 2])
        scene = yield from hand.move(scene, position, yaw)
        scene = yield from hand.pause(scene, 0.5)
        for _ in range(CORRECTIONS):
            if not self._is_off(scene, position):
                break
            scene = yield from hand.move(scene, position, yaw)
            scene = yield from hand.pause(scene, 0.5)
        if self._is_off(scene, position):
            return scene, None
        scene = yield from hand.grip(scene, CLOSE)
        scene = yield from hand.pause(scene, 0.7)
        return scene, floor

    def _is_off(self, scene: Scene, position: Array) -> bool:
        """Whether the gripper is too far from where it should close [m], ``(3,)``."""
        away = np.linalg.norm(scene.gripper_position - position)
        return bool(away > self._style.grip_within)

    def _hesitates(self) -> bool:
        return bool(self._generator.random() < 0.4) and not self.hand.flows()

    def _miss(self, scene: Scene, position: Array, yaw: float) -> Movement:
        """Close the gripper above the object, notice, and open it again."""
        height = self._generator.uniform(0.055, 0.065)
        scene = yield from self.hand.move(scene, position + np.array([0.0, 0.0, height]), yaw)
        scene = yield from self.hand.grip(scene, CLOSE)
        scene = yield from self.hand.pause(scene)
        scene = yield from self.hand.grip(scene, OPEN)
        return (yield from self.hand.pause(scene, 0.5))

    def _hold_up(self, scene: Scene) -> Movement:
        """Lift the object and keep it there for a while."""
        height = self._generator.uniform(0.07, 0.16)
        drift = self._generator.normal(0.0, 0.02, 2)
        goal = scene.gripper_position + np.append(drift, height)
        scene = yield from self.hand.move(scene, goal, scene.gripper_yaw)
        return (yield from self.hand.wait(scene, int(self._generator.integers(10, 35))))

    def _carry(self, scene: Scene, job: PutInto, floor: float) -> Movement:
        """Lift the object over the walls and bring it above where it goes.

        Args:
            scene: The scene now.
            job: Where it goes.
            floor: Height of the object's centre when it lies there [m].
        """
        draw = self._generator
        height = scene.description.lift_height + draw.uniform(-0.02, 0.02)
        target, yaw = choose_spot(scene, job, floor, draw)
        scene, over = yield from self._lift(scene, target, height)
        if scene.held is None:
            return scene
        way = Way(self._hesitates(), over=over)
        above = np.append(target, height - draw.uniform(0.0, 0.02))
        return (yield from self.hand.reach(scene, above, yaw, way))

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
        hand, draw = self.hand, self._generator
        if hand.flows():
            return scene, height + ARCH_ROOM
        start = scene.gripper_position[:2]
        drifted = start + draw.uniform(0.0, 0.15) * (target - start)
        scene = yield from hand.move(scene, np.append(drifted, height), scene.gripper_yaw)
        if draw.random() < 0.5:
            scene = yield from hand.pause(scene)
        return scene, None

    def _put_down(self, scene: Scene, job: PutInto, floor: float) -> Movement:
        """Lower the object to just above the floor, let go, retreat and rest.

        Args:
            scene: The scene now.
            job: Where it goes.
            floor: Height of the object's centre when it lies there [m].
        """
        hand, draw = self.hand, self._generator
        scene = yield from hand.pause(scene)
        index = scene.object_index(job.object_name)
        drop = scene.object_positions[index, 2] - floor - draw.uniform(*RELEASE_GAP)
        goal = scene.gripper_position - np.array([0.0, 0.0, drop])
        scene = yield from hand.move(scene, goal, scene.gripper_yaw)
        scene = yield from hand.pause(scene, 0.7)
        if scene.object_positions[index, 2] - floor > DROP:
            return scene  # An arm that cannot get down: nobody would let go here.
        return (yield from self._let_go(scene, RETREAT_ASIDE, RETREAT))

    def _let_go(self, scene: Scene, aside: float, retreat: tuple[float, float]) -> Movement:
        """Open the gripper, retreat upwards and rest.

        Args:
            scene: The scene now.
            aside: Standard deviation of x and y of the retreat [m].
            retreat: How far it goes upwards, from and to [m].
        """
        hand, draw = self.hand, self._generator
        scene = yield from hand.grip(scene, OPEN)
        scene = yield from hand.pause(scene, 0.3)
        if not self._is_last and hand.stays_low():
            return scene
        away = np.append(draw.normal(0.0, aside, 2), draw.uniform(*retreat))
        scene = yield from hand.move(scene, scene.gripper_position + away, scene.gripper_yaw)
        return (yield from hand.wait(scene, int(draw.integers(5, 15))))

    def _carry_over(self, scene: Scene, job: PutOnto) -> Movement:
        """Lift the object and bring its centre roughly above the point that it goes to."""
        hand, draw = self.hand, self._generator
        yaw = choose_yaw(scene, job, draw)
        clear = goal_point(scene, job) + (job.clearance + draw.uniform(0.0, 0.02)) * UP
        above = bringing(scene, job.object_name, clear, yaw)
        scene, over = yield from self._lift(scene, above[:2], above[2])
        if scene.held is None:
            return scene
        above = bringing(scene, job.object_name, clear, yaw)
        return (yield from hand.swing(scene, above, yaw, Way(self._hesitates(), over=over)))

    def _fit(self, scene: Scene, job: PutOnto) -> Movement:
        """Lower the object onto its point, let go, retreat; rise and aim again where it jams."""
        hand, draw, name = self.hand, self._generator, job.object_name
        index, yaw = scene.object_index(name), scene.gripper_yaw
        point = goal_point(scene, job)
        drop = draw.uniform(*job.drop)
        for _ in range(TRIES):
            scene = yield from hand.pause(scene, 0.7)
            if job.yaws is not None:
                yaw = choose_yaw(scene, job, draw)
            # Look again where the object is after the correction.
            for height in (job.clearance, drop):
                goal = bringing(scene, name, point + height * UP, yaw)
                scene = yield from hand.move(scene, goal, yaw, Way(straight=True))
            if scene.held != name:
                return scene
            scene = yield from hand.pause(scene, 0.5)
            if scene.object_positions[index, 2] - point[2] < job.drop[1] + DROP:
                return (yield from self._let_go(scene, 0.0, job.retreat))
        return scene


def stands(scene: Scene, name: str) -> bool:
    """Whether an object stands as it stood at the start, which all of them do."""
    quaternion = scene.object_quaternions[scene.object_index(name)]
    return bool(rotation_matrix(quaternion)[2, 2] > UPRIGHT)
