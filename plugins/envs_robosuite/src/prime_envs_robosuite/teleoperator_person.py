"""What a simulated person does with an object: take it, and hold it up or put it down."""

from collections.abc import Generator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from prime_core.environment import Action
from prime_core.errors import PrimeError
from prime_core.rotations import rotation_matrix, wrap_angle, yaw_of
from prime_core.scene import Affordance, Scene
from prime_envs_robosuite.teleoperator_motion import CLOSE, OPEN, Hand, Movement

if TYPE_CHECKING:
    from prime_envs_robosuite.task import Task

Array = NDArray[np.float64]

TRIES = 4  # grasps that a person attempts before giving up
WALL_MARGIN = 0.045  # between where an object is put and the border of its quarter [m]
WALL_HALF_THICKNESS = 0.01  # of the bins' walls [m]
WALL_TOP = 0.9  # world height [m]
TAKEN_FROM = np.array([[-0.09, -0.49], [0.29, -0.01]])  # inside of the first bin [m]
ARM_BASE = np.array([-0.5, -0.1])  # of the arm before robosuite's bins, world frame [m]
EASY_REACH = 0.78  # from there in the plane [m]; farther out the elbow is all but straight
HAND_HALF_SIZE = np.array([0.034, 0.106])  # of the Panda's hand along the gripper's x and y [m]
HAND_BOTTOM = 0.02  # above the point between the fingertips [m]
SPOTS = 1000  # that are looked at for one where the hand has room
RELEASE_GAP = (0.001, 0.006)  # between a lowered object and the floor when let go of [m]
UPRIGHT = 0.98  # least cosine of the angle by which an object may be tilted in the end
DROP = 0.015  # from how high an object may be let go of [m]
GREATEST_YAW = 1.4  # of the gripper [rad]; the arm's last joint ends beyond a quarter turn


@dataclass(frozen=True)
class Job:
    """What a person is asked to do.

    Attributes:
        object_name: What to take.
        grasp: Where the object can be taken.
        region: Lower and upper corner of where to put it [m], ``(2, 2)``; None to hold it up.
        walls: Corners of the inside of the bin to take it from and of the compartment to put
            it into [m], ``(2, 2, 2)``; None where there are no walls.
        care: How much slower people are than usual, with something small and close by.
    """

    object_name: str
    grasp: Affordance
    region: Array | None
    walls: Array | None
    care: float


def job_of(task: "Task", grasp: Affordance) -> Job:
    """Return what a task asks for.

    Args:
        task: The environment's.
        grasp: Where its object can be taken.

    Raises:
        PrimeError: If nobody has been taught the task.
    """
    from prime_envs_robosuite.lift import LiftTask
    from prime_envs_robosuite.pick_place import QUARTER_SIZE, PickPlaceTask, quarter_centre

    if isinstance(task, LiftTask):
        return Job("cube", grasp, region=None, walls=None, care=1.8)
    if isinstance(task, PickPlaceTask):
        half = np.array(QUARTER_SIZE) / 2
        quarter = quarter_centre(task.shape.quarter) + np.stack((-half, half))
        inwards = np.array([[1.0], [-1.0]])
        walls = np.stack((TAKEN_FROM, quarter + WALL_HALF_THICKNESS * inwards))
        return Job(task.kind, grasp, quarter + WALL_MARGIN * inwards, walls, care=1.0)
    raise PrimeError(
        "simulated-teleoperator knows the tasks of 'robosuite/lift' and 'robosuite/pick-place', "
        f"not {type(task).__name__}"
    )


class Person:
    """Does a job by looking at the scenes.

    Args:
        job: What to do.
        hand: What moves the gripper.
        misses: Whether the first grasp closes too early.
        other_yaw_share: Share of grasps at another yaw than the nearest.
        generator: Where all randomness comes from.
    """

    def __init__(
        self,
        job: Job,
        hand: Hand,
        misses: bool,
        other_yaw_share: float,
        generator: np.random.Generator,
    ) -> None:
        self.job = job
        self.hand = hand
        self._generator = generator
        self._misses = misses
        self._other_yaw_share = other_yaw_share

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
            scene = yield from self._carry(scene, self.job.region, floor)
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
        position = scene.object_positions[index] + offset
        reachable = nearest[np.abs(nearest) < GREATEST_YAW]
        if self.job.walls is not None:
            walls, height = self.job.walls[0], float(position[2])
            roomy = reachable[_hand_fits(position[:2], height, reachable, walls)]
            reachable = roomy if len(roomy) else reachable
        reachable = reachable if len(reachable) else nearest[:1]
        other = len(reachable) > 1 and draw.random() < self._other_yaw_share
        return position, float(reachable[1 if other else 0] + draw.uniform(-0.1, 0.1))

    def _hold_up(self, scene: Scene) -> Movement:
        """Lift the object and keep it there for a while."""
        height = self._generator.uniform(0.07, 0.16)
        drift = self._generator.normal(0.0, 0.02, 2)
        goal = scene.gripper_position + np.append(drift, height)
        scene = yield from self.hand.move(scene, goal, scene.gripper_yaw)
        return (yield from self.hand.wait(scene, int(self._generator.integers(10, 35))))

    def _carry(self, scene: Scene, region: Array, floor: float) -> Movement:
        """Lift the object over the walls and bring it above where it goes.

        Args:
            scene: The scene now.
            region: Corners of where the object may be put [m], ``(2, 2)``.
            floor: Height of the object's centre when it lies [m].
        """
        hand, draw = self.hand, self._generator
        height = scene.description.lift_height + draw.uniform(-0.02, 0.02)
        target, yaw = self._spot(scene, region, floor)
        start = scene.gripper_position[:2]
        drifted = start + draw.uniform(0.0, 0.15) * (target - start)
        scene = yield from hand.move(scene, np.append(drifted, height), scene.gripper_yaw)
        if draw.random() < 0.5:
            scene = yield from hand.pause(scene)
        if scene.held is None:
            return scene
        hesitate = bool(draw.random() < 0.4)
        above = np.append(target, height - draw.uniform(0.0, 0.02))
        return (yield from hand.reach(scene, above, yaw, hesitate))

    def _spot(self, scene: Scene, region: Array, floor: float) -> tuple[Array, float]:
        """Choose where to put the held object: x and y [m] ``(2,)`` and the gripper's yaw [rad].

        People pick a place that they can get to: within reach, with room for the hand.
        """
        draw, walls = self._generator, self.job.walls
        index = scene.object_index(self.job.object_name)
        height = floor + float(scene.gripper_position[2] - scene.object_positions[index, 2])
        spots = draw.uniform(region[0], region[1], (SPOTS, 2))
        turns = draw.uniform(-0.6, 0.6, SPOTS) * np.linspace(1.0, 2.5, SPOTS)
        yaws = np.clip(scene.gripper_yaw + turns, -GREATEST_YAW, GREATEST_YAW)
        distances = np.linalg.norm(spots - ARM_BASE, axis=1)
        good = distances < EASY_REACH
        if walls is not None:
            good &= _hand_fits(spots, height, yaws, walls[1])
        chosen = int(np.argmax(good) if good.any() else np.argmin(distances))
        return spots[chosen], float(yaws[chosen])

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


def stands(scene: Scene, job: Job) -> bool:
    """Whether the object stands as it stood at the start, which all of them do."""
    quaternion = scene.object_quaternions[scene.object_index(job.object_name)]
    return bool(rotation_matrix(quaternion)[2, 2] > UPRIGHT)


def _hand_fits(spots: ArrayLike, height: float, yaws: ArrayLike, walls: Array) -> NDArray[np.bool_]:
    """Tell where the hand has room between walls.

    Args:
        spots: Of the gripper in the plane [m], ``(N, 2)`` or ``(2,)``.
        height: Of the gripper [m].
        yaws: Of the gripper [rad], ``(N,)``.
        walls: Lower and upper corner of the room [m], ``(2, 2)``.

    Returns:
        ``(N,)``.
    """
    cosine, sine = np.abs(np.cos(yaws)), np.abs(np.sin(yaws))
    mixed = np.stack((np.stack((cosine, sine), -1), np.stack((sine, cosine), -1)), -2)
    half = mixed @ HAND_HALF_SIZE
    inside = (spots - half > walls[0]) & (spots + half < walls[1])
    return np.asarray(np.all(inside, axis=-1) | (height + HAND_BOTTOM > WALL_TOP))
