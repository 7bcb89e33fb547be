"""PickPlace: move one grocery from a bin into its own quarter of another bin."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from prime_core.contracts.description import Affordance, ObjectDescription
from prime_core.contracts.scene import Scene
from prime_envs_robosuite.simulation.objects import ObjectMotion, Placement
from prime_envs_robosuite.tasks.robosuite_import import make_host
from prime_envs_robosuite.tasks.subtasks import ArmReach, Bounds, PutInto, Subtask
from prime_envs_robosuite.tasks.task import Task, is_let_go, sampler_placement

Grocery = Literal["milk", "bread", "cereal", "can"]

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


QUARTER_TURNS = (0.0, float(np.pi / 2))
SHAPES: dict[str, _Shape] = {
    "milk": _Shape(0, 4, (0.045, 0.055), QUARTER_TURNS),
    "bread": _Shape(1, 2, (-0.005, 0.005), QUARTER_TURNS),
    # 0.10 m long and 0.03 m thick: the gripper spans its thickness only.
    "cereal": _Shape(2, 2, (0.045, 0.055), (0.0,)),
    "can": _Shape(3, 0, (0.01, 0.02), None),
}


class PickPlaceTask(Task):
    """robosuite's PickPlace with one object and without the other three.

    Solved when the object lies at rest in its own quarter and is let go of: no finger
    touches it, the gripper is open and more than 4.2 cm away.

    Args:
        kind: The object to move.
    """

    workspace_low = (-0.08, -0.44, 0.82)
    workspace_high = (0.30, 0.42, 1.08)
    lift_height = 1.05

    def __init__(self, kind: Grocery) -> None:
        self.kind = kind
        self.shape = SHAPES[kind]
        self.words = f"put the {kind} into its bin"
        self.objects = (ObjectDescription(kind, yaw_symmetry=self.shape.yaw_symmetry),)
        self.body_names = (kind.capitalize(),)

    def make_host(self) -> Any:
        """Build the robosuite environment; see `Task`."""
        return make_host("OneObjectPickPlace", kind=self.kind)

    def placements(self, host: Any) -> tuple[Placement, ...]:
        """Return where the object starts; see `Task`."""
        sampler = host.placement_initializer.samplers["CollisionObjectSampler"]
        return (sampler_placement(sampler, host.objects[0]),)

    def affordances(self) -> tuple[Affordance, ...]:
        """Return where actions make sense; see `Task`."""
        low, high = self.shape.grasp_height
        yaws = self.shape.grasp_yaws
        grasp = Affordance("grasp", self.kind, (0.0, 0.0, low), (0.0, 0.0, high), yaws)
        reach = Affordance("reach", self.kind, (0.0, 0.0, high), (0.0, 0.0, high + 0.08), yaws)
        corners = [(x, y, PLACE_HEIGHT) for x, y in PLACE_SPOTS]
        places = [Affordance("place", None, corner, corner) for corner in corners]
        above = [Affordance("reach", None, corner, corner) for corner in corners]
        return (grasp, *places, reach, *above)

    def subtasks(self) -> tuple[Subtask, ...]:
        """Return what a demonstrator does; see `Task`."""
        inner, aim = (
            _shrunk_quarter(self.shape.quarter, by) for by in (WALL_HALF_THICKNESS, WALL_MARGIN)
        )
        return (
            PutInto(
                object_name=self.kind,
                taken_from=TAKEN_FROM,
                room=Bounds(*inner, top=WALL_TOP),
                low=aim[0],
                high=aim[1],
                reach=EASY_REACH,
            ),
        )

    def is_success(self, scene: Scene, touched: bool, motions: Sequence[ObjectMotion]) -> bool:
        """Whether the object lies in its quarter, let go of; see `Task`."""
        position = scene.object_positions[0]
        distance = float(np.linalg.norm(position - scene.gripper_position))
        released = is_let_go(scene, touched) and distance > RELEASE_DISTANCE
        return released and motions[0].at_rest and in_quarter(position, self.shape.quarter)


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
