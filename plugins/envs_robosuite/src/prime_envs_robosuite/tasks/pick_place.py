"""PickPlace: move groceries from a bin into their own quarters of another bin."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from prime_core.contracts.description import Affordance, ObjectDescription
from prime_core.contracts.scene import Scene
from prime_envs_robosuite.simulation.objects import (
    ObjectMotion,
    Placement,
    Starts,
)
from prime_envs_robosuite.tasks.robosuite_import import GROCERIES, make_host, sample_poses
from prime_envs_robosuite.tasks.subtasks import ArmReach, Bounds, PutInto, Subtask
from prime_envs_robosuite.tasks.task import (
    QUARTER_TURNS,
    PlacedTask,
    is_let_go,
    sampler_placement,
)

Grocery = Literal["milk", "bread", "cereal", "can"]
Choice = Literal[Grocery, "all"]

BIN_POSITION = (0.1, 0.28, 0.8)  # of the bin with four quarters, world frame [m]
QUARTER_SIZE = (0.195, 0.245)  # [m]
BIN_DEPTH = 0.1  # an object counts as inside below this height over the bin's frame [m]
# Where to let go: the quarters' centres. The last one is 0.86 m from the arm's base, where the
# elbow locks with the gripper pointing down, so its spot is moved to 0.79 m [m].
PLACE_SPOTS = ((0.0025, 0.1575), (0.1975, 0.1575), (0.0025, 0.4025), (0.15, 0.345))
PLACE_HEIGHT = 0.98  # of the gripper when it lets go [m]
WALL_TOP = 0.9  # world height [m]
WALL_HALF_THICKNESS = 0.01  # of the bins [m]
WALL_MARGIN = 0.045  # between where an object is put and the border of its quarter [m]
TAKEN_FROM = Bounds(low=(-0.09, -0.49), high=(0.29, -0.01), top=WALL_TOP)  # the first bin
# Of the arm before robosuite's bins; farther out its elbow is all but straight.
EASY_REACH = ArmReach(base=(-0.5, -0.1), distance=0.78)
RELEASE_DISTANCE = 0.0424  # robosuite's own threshold between gripper and object [m]


@dataclass(frozen=True)
class _Shape:
    """What the gripper must know of a grocery.

    Attributes:
        quarter: Its quarter of the bin, in robosuite's numbering.
        yaw_symmetry: As in `ObjectDescription`.
        grasp_height: Lowest and highest good grip above its centre [m].
        grasp_yaws: Good gripper yaws relative to its own [rad]; None if any is good.
    """

    quarter: int
    yaw_symmetry: int
    grasp_height: tuple[float, float]
    grasp_yaws: tuple[float, ...] | None


SHAPES: dict[str, _Shape] = {
    "milk": _Shape(0, 4, (0.045, 0.055), QUARTER_TURNS),
    "bread": _Shape(1, 2, (-0.005, 0.005), QUARTER_TURNS),
    # 0.10 m long and 0.03 m thick: the gripper spans its thickness only.
    "cereal": _Shape(2, 2, (0.045, 0.055), (0.0,)),
    "can": _Shape(3, 0, (0.01, 0.02), None),
}


class PickPlaceTask(PlacedTask):
    """robosuite's PickPlace with all four objects, or with one and without the other three.

    Solved when each object lies at rest in its own quarter and is let go of: no finger touches
    one, the gripper is open and more than 4.2 cm away from all.

    Args:
        choice: The object to move, or ``"all"``, in robosuite's order.
    """

    workspace_low = (-0.08, -0.44, 0.82)
    workspace_high = (0.30, 0.42, 1.08)
    lift_height = 1.05

    def __init__(self, choice: Choice) -> None:
        everything = tuple(name.lower() for name in GROCERIES)
        self.kinds = everything if choice == "all" else (choice,)
        what = "each object" if choice == "all" else f"the {choice}"
        self.words = f"put {what} into its bin"
        self.objects = tuple(
            ObjectDescription(kind, yaw_symmetry=SHAPES[kind].yaw_symmetry) for kind in self.kinds
        )
        self.body_names = tuple(kind.capitalize() for kind in self.kinds)

    def make_host(self) -> Any:
        """Build the robosuite environment; see `Task`."""
        return make_host("PickPlaceOf", names=self.body_names)

    def starts(self, host: Any) -> Starts:
        """Return robosuite's sampler, which keeps several objects apart; see `Task`."""
        if len(self.kinds) > 1:
            return lambda rng: sample_poses(host, self.body_names, rng)
        return super().starts(host)

    def placements(self, host: Any) -> tuple[Placement, ...]:
        """Return where one object alone starts; see `Task`."""
        sampler = host.placement_initializer.samplers["CollisionObjectSampler"]
        return (sampler_placement(sampler, host.objects[0]),)

    def affordances(self) -> tuple[Affordance, ...]:
        """Return where actions make sense; see `Task`."""
        grasps, reaches = [], []
        for kind in self.kinds:
            low, high = SHAPES[kind].grasp_height
            yaws = SHAPES[kind].grasp_yaws
            above = (0.0, 0.0, high + 0.08)
            grasps.append(Affordance("grasp", kind, (0.0, 0.0, low), (0.0, 0.0, high), yaws))
            reaches.append(Affordance("reach", kind, (0.0, 0.0, high), above, yaws))
        corners = [(x, y, PLACE_HEIGHT) for x, y in PLACE_SPOTS]
        places = [Affordance("place", None, corner, corner) for corner in corners]
        above_bins = [Affordance("reach", None, corner, corner) for corner in corners]
        return (*grasps, *places, *reaches, *above_bins)

    def subtasks(self) -> tuple[Subtask, ...]:
        """Return what a demonstrator does; see `Task`."""
        return tuple(map(_put_into_quarter, self.kinds))

    def is_success(self, scene: Scene, touched: bool, motions: Sequence[ObjectMotion]) -> bool:
        """Whether each object lies in its quarter, let go of; see `Task`."""
        away = np.linalg.norm(scene.object_positions - scene.gripper_position, axis=1)
        released = is_let_go(scene, touched) and bool(away.min() > RELEASE_DISTANCE)
        at_rest = all(motion.at_rest for motion in motions)
        pairs = zip(self.kinds, scene.object_positions, strict=True)
        return (
            released and at_rest and all(in_quarter(at, SHAPES[kind].quarter) for kind, at in pairs)
        )


def _put_into_quarter(kind: str) -> PutInto:
    """Return the subtask of putting an object into its own quarter."""
    quarter = SHAPES[kind].quarter
    inner, aim = (_shrunk_quarter(quarter, by) for by in (WALL_HALF_THICKNESS, WALL_MARGIN))
    return PutInto(
        object_name=kind,
        taken_from=TAKEN_FROM,
        room=Bounds(*inner, top=WALL_TOP),
        low=aim[0],
        high=aim[1],
        reach=EASY_REACH,
    )


def quarter_centre(quarter: int) -> np.ndarray[Any, np.dtype[np.float64]]:
    """Return x and y of the centre of a quarter of the bin [m], world frame, ``(2,)``.

    Args:
        quarter: 0 to 3: near right, far right, near left, far left, seen from the robot.
    """
    side = np.array([-0.5 if quarter % 2 == 0 else 0.5, -0.5 if quarter < 2 else 0.5])
    return np.asarray(np.array(BIN_POSITION[:2]) + side * QUARTER_SIZE)


def in_quarter(position: np.ndarray[Any, np.dtype[np.float64]], quarter: int) -> bool:
    """Whether a point is inside a quarter of the bin, by robosuite's measures.

    Args:
        position: [m], world frame, ``(3,)``.
        quarter: As for `quarter_centre`.
    """
    aside = np.abs(position[:2] - quarter_centre(quarter))
    floor = BIN_POSITION[2]
    inside = bool(np.all(aside < np.array(QUARTER_SIZE) / 2))
    return inside and bool(floor < position[2] < floor + BIN_DEPTH)


def _shrunk_quarter(quarter: int, margin: float) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return the least and the greatest x and y that are well inside of a quarter [m].

    Args:
        quarter: As for `quarter_centre`.
        margin: What to stay away from its border [m].
    """
    half = np.array(QUARTER_SIZE) / 2
    corners = quarter_centre(quarter) + np.stack((-half, half))
    (low_x, low_y), (high_x, high_y) = corners + margin * np.array([[1.0], [-1.0]])
    return (float(low_x), float(low_y)), (float(high_x), float(high_y))
