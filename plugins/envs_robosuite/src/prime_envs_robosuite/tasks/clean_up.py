"""CleanUp: push a popcorn box to the serving area, and put butter away."""

from typing import Literal

import numpy as np

from prime_core.contracts.description import Affordance
from prime_core.contracts.scene import Scene
from prime_core.rotations import yaw_of
from prime_envs_robosuite.tasks.subtasks import PutOnto, Subtask
from prime_envs_robosuite.tasks.table_top import EASY_REACH, TableTopTask, push_to, put_into_bin
from prime_envs_robosuite.tasks.table_top_objects import Array, Bin, Box, Layout, Look, Mat

Variant = Literal["bin", "stack"]

SERVING_AREA = (-0.15, 0.15)  # x and y of its centre (paper's release) [m]
SERVING_REACH = 0.10  # of the popcorn box's centre from it (paper's release) [m]

# The paper's physical robot had groceries and a bin; their sizes, the bin's place and the regions
# where they start are not given. A flat box of microwave popcorn is too wide for the gripper, and
# starts so far from the serving area that it has to be pushed. The butter is a 125 g block.
POPCORN = Box(
    "popcorn",
    (0.06, 0.045, 0.018),
    (0.0, 0.07),
    (0.06, 0.13),
    Look((0.78, 0.16, 0.14), (0.93, 0.86, 0.70), 0.08),
)
BUTTER = Box(
    "butter",
    (0.040, 0.018, 0.016),
    (-0.14, -0.09),
    (0.02, -0.03),
    Look((0.96, 0.86, 0.40), (0.93, 0.80, 0.30)),
)
BIN = Bin("bin0", (-0.05, -0.29), Look((0.35, 0.45, 0.52), (0.30, 0.39, 0.46)))
SERVING_MAT = Mat(SERVING_AREA, Look((0.30, 0.52, 0.50), (0.25, 0.45, 0.43)), turned=True)
STACK_GAP = 0.006  # of the butter's centre from its height when it lies flat on the popcorn [m]
RELEASE_GAP = 0.005  # of the butter above the popcorn when it is let go of [m]


class CleanUpTask(TableTopTask):
    """The paper's CleanUp, made for its physical robot, with sizes and places of our own.

    Solved when the popcorn box is within 0.10 m of the serving area's centre and the butter is in
    the bin (``"bin"``) or lies on top of the popcorn box (``"stack"``), both are at rest, and no
    finger touches one. The bin is there in both, as on the physical robot's table.

    Args:
        variant: Where the butter belongs.
    """

    # The far side of the popcorn box is to be pushed from.
    workspace_low = (-0.28, -0.32, 0.80)
    workspace_high = (0.16, 0.32, 1.05)

    def __init__(self, variant: Variant) -> None:
        super().__init__(Layout((POPCORN, BUTTER), (BIN,), (SERVING_MAT,)))
        self.variant = variant
        target = "into the bin" if variant == "bin" else "on top of it"
        self.words = f"push the popcorn box to the serving area and put the butter {target}"

    def subtasks(self) -> tuple[Subtask, ...]:
        """Return what a demonstrator does; see `Task`."""
        push = push_to(POPCORN, SERVING_AREA, SERVING_REACH / 2)
        if self.variant == "bin":
            return (push, put_into_bin(BUTTER, BIN, part=0, parts=1, layout=self.layout))
        stack = PutOnto(
            object_name=BUTTER.name,
            point=(0.0, 0.0, POPCORN.half_size[2] + BUTTER.half_size[2]),
            reach=EASY_REACH,
            clearance=0.06,
            drop=(0.002, RELEASE_GAP),
            retreat=(0.06, 0.11),
            reference=POPCORN.name,
            beside=(BIN.outside(),),
        )
        return (push, stack)

    def affordances(self) -> tuple[Affordance, ...]:
        """Return where actions make sense; see `Task`."""
        if self.variant == "bin":
            return super().affordances()
        height = POPCORN.half_size[2] + BUTTER.half_size[2] + RELEASE_GAP
        top = (0.0, 0.0, height)
        return (*super().affordances(), Affordance("place", POPCORN.name, top, top))

    def is_tidy(self, scene: Scene) -> bool:
        """Whether the popcorn box is served and the butter where it belongs."""
        popcorn, butter = scene.object_positions
        if self.layout.mats[0].distance(popcorn) >= SERVING_REACH:
            return False
        if self.variant == "bin":
            return self.layout.bins[0].holds(butter)
        return lies_on_top(butter - popcorn, float(yaw_of(scene.object_quaternions[0])))


def lies_on_top(offset: Array, yaw: float) -> bool:
    """Whether butter lies flat on the popcorn box, with its centre above the box.

    Args:
        offset: From the box's centre to the butter's [m], world frame, ``(3,)``.
        yaw: Of the box [rad].
    """
    cosine, sine = np.cos(yaw), np.sin(yaw)
    along = cosine * offset[0] + sine * offset[1]
    across = cosine * offset[1] - sine * offset[0]
    over = abs(along) < POPCORN.half_size[0] and abs(across) < POPCORN.half_size[1]
    height = POPCORN.half_size[2] + BUTTER.half_size[2]
    return bool(over and abs(offset[2] - height) < STACK_GAP)
