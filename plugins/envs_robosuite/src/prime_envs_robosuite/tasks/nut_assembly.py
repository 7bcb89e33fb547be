"""NutAssembly: put a nut with a handle around its peg."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from prime_core.contracts.description import Affordance, ObjectDescription
from prime_core.contracts.scene import Scene
from prime_envs_robosuite.simulation.objects import ObjectMotion, Placement
from prime_envs_robosuite.tasks.robosuite_import import make_host
from prime_envs_robosuite.tasks.subtasks import ArmReach, PutOnto, Subtask
from prime_envs_robosuite.tasks.task import Task, is_let_go, sampler_placement

Nut = Literal["round", "square"]
InitialRange = Literal["paper", "robosuite"]

TABLE_TOP = 0.82
PEG_TOP = 0.95  # world height [m]
NUT_HALF_HEIGHT = 0.01  # [m]
# The fingers reach 11 mm below the gripper's position: at the nut's centre they would scrape the
# table, and a hand that comes down with some speed would even a little above it [m].
GRIP_HEIGHT = (0.005, 0.008)
PLACE_HEIGHT = (0.85, 0.87)  # of the nut when it is let go of [m]
# The gripper stays nearer than this to the arm's base, or its elbow is all but straight.
EASY_REACH = ArmReach(base=(-0.56, 0.0), distance=0.733)
ON_PEG_DISTANCE = 0.03  # robosuite's threshold between nut and peg in x and in y [m]
ON_PEG_HEIGHT = 0.05  # and of the nut's centre above the table [m]
TOWARDS_ROBOT = (np.pi / 2, 3 * np.pi / 2)  # yaws of the paper's first states [rad]
HANDLE_IN_REACH = tuple(float(yaw) for yaw in np.radians([145, 155, 165, 175, 185, 195]))


@dataclass(frozen=True)
class _Shape:
    """What tells the two nuts from each other.

    Attributes:
        body_name: In robosuite.
        peg: x and y of its peg [m], world frame.
        handle: From the nut's centre to where its handle is held, along its x axis [m]. The
            paper's release has 0.065 and 0.06 m. A centimetre farther out the fingers still
            cover the handle, and around the peg the gripper is that much nearer to the arm,
            whose elbow is all but straight there.
        yaws: Of the nut around its peg, at which it fits and its handle is within reach [rad].
        workspace_y: Least and greatest y of the gripper [m].
    """

    body_name: str
    peg: tuple[float, float]
    handle: float
    yaws: tuple[float, ...]
    workspace_y: tuple[float, float]


SHAPES: dict[str, _Shape] = {
    "round": _Shape("RoundNut", (0.23, -0.1), 0.075, HANDLE_IN_REACH, (-0.30, 0.01)),
    # The box of the round nut, mirrored as its start and its peg are.
    "square": _Shape("SquareNut", (0.23, 0.1), 0.07, (np.pi,), (-0.01, 0.30)),
}


class NutAssemblyTask(Task):
    """robosuite's NutAssembly with one nut and both pegs.

    Solved when the nut is around its peg, at rest and let go of: no finger touches it and the
    gripper is open.

    The nut starts in the small region that robosuite's sampler has about the middle of the
    table: x -0.115 to -0.11, y -0.225 to -0.11 for the round nut and 0.11 to 0.225 for the square
    one, each on the side of its peg. The paper's release has the same numbers, with y the other
    way round in our notes; its workspace box of the round nut, y -0.29 to 0.01, says that they
    are meant like this, for it holds just the grips at such starts and around the round peg.
    Ours are a centimetre farther out and take a centimetre more. What the paper narrows is the
    yaw: 90 to 270 degrees turn the handle (the nut's x axis) to the robot's side. In robosuite's
    own range it may point away from the robot, and a nut put around its peg so has its handle out
    of the arm's reach: it has to be turned on the way.

    Args:
        kind: The nut to move.
        initial_range: Whether its yaw at the start is the paper's or any.
    """

    lift_height = 1.0  # a nut that is held there passes 3 cm above the pegs

    def __init__(self, kind: Nut, initial_range: InitialRange) -> None:
        self.kind = kind
        self.initial_range = initial_range
        self.shape = SHAPES[kind]
        self.words = f"put the {kind} nut around its peg"
        self.objects = (ObjectDescription("nut", yaw_symmetry=1),)  # the handle shows its yaw
        self.body_names = (self.shape.body_name,)
        low, high = self.shape.workspace_y
        self.workspace_low = (-0.26, low, 0.80)
        # The release's box ends at 1.00 m; here that is the height at which nuts travel.
        self.workspace_high = (0.23, high, 1.02)

    def make_host(self) -> Any:
        """Build the robosuite environment; see `Task`."""
        return make_host("OneNutAssembly", nut=self.shape.body_name)

    def placements(self, host: Any) -> tuple[Placement, ...]:
        """Return where the nut starts; see `Task`."""
        (sampler,) = host.placement_initializer.samplers.values()
        # robosuite drops the nut from 6 cm; no primitive is learnt from a nut that falls.
        rest = TABLE_TOP + NUT_HALF_HEIGHT
        placement = replace(sampler_placement(sampler, host.nuts[0]), height=rest)
        if self.initial_range == "paper":
            placement = replace(placement, yaws=TOWARDS_ROBOT)
        return (placement,)

    def affordances(self) -> tuple[Affordance, ...]:
        """Return where actions make sense; see `Task`."""
        handle, peg = self.shape.handle, self.shape.peg
        yaws = self.shape.yaws
        (lower, upper), (low, high) = GRIP_HEIGHT, PLACE_HEIGHT
        above = (*peg, PEG_TOP)
        return (
            Affordance("grasp", "nut", (handle, 0.0, lower), (handle, 0.0, upper), (0.0,)),
            Affordance("place", None, (*peg, low), (*peg, high), yaws, of_held=True),
            Affordance("reach", "nut", (handle, 0.0, upper), (handle, 0.0, 0.1), (0.0,)),
            Affordance("reach", None, above, above, yaws, of_held=True),
        )

    def subtasks(self) -> tuple[Subtask, ...]:
        """Return what a demonstrator does; see `Task`."""
        rest = TABLE_TOP + NUT_HALF_HEIGHT
        return (
            PutOnto(
                object_name="nut",
                point=(*self.shape.peg, rest),
                reach=EASY_REACH,
                clearance=PEG_TOP + NUT_HALF_HEIGHT + 0.01 - rest,
                drop=(0.015, 0.04),
                retreat=(0.0, 0.01),
                yaws=None if self.kind == "round" else self.shape.yaws,
                care=0.8,
            ),
        )

    def is_success(self, scene: Scene, touched: bool, motions: Sequence[ObjectMotion]) -> bool:
        """Whether the nut is around its peg, let go of; see `Task`."""
        position = scene.object_positions[0]
        aside = np.abs(position[:2] - self.shape.peg)
        around = bool(np.all(aside < ON_PEG_DISTANCE) and position[2] < TABLE_TOP + ON_PEG_HEIGHT)
        return around and is_let_go(scene, touched) and motions[0].at_rest
