"""TidyUp: two small boxes into a bin, a large box onto a mat."""

from typing import Literal

from prime_core.contracts.scene import Scene
from prime_envs_robosuite.tasks.subtasks import Subtask
from prime_envs_robosuite.tasks.table_top import TableTopTask, push_to, put_into_bin
from prime_envs_robosuite.tasks.table_top_objects import Bin, Box, Layout, Look, Mat

Variant = Literal["A", "B", "C", "D"]

MAT_REACH = 0.07  # between the centres of large box and mat at which the box is on it [m]
TARGET_BIN, TARGET_MAT = 0, 1  # in the order of a layout

CARD, TAPE, CRATE = (
    Look((0.80, 0.18, 0.14), (0.62, 0.10, 0.08)),
    Look((0.13, 0.42, 0.72), (0.09, 0.30, 0.55)),
    Look((0.93, 0.72, 0.22), (0.80, 0.57, 0.13)),
)
BOXES = (
    Box("small_box_a", (0.028, 0.0154, 0.0231), (-0.17, -0.15), (-0.07, -0.05), CARD),
    Box("small_box_b", (0.021, 0.021, 0.028), (-0.05, -0.15), (0.05, -0.05), TAPE),
    # Wider than the gripper opens, whichever way it is turned.
    Box("large_box", (0.042, 0.051, 0.024), (-0.12, -0.03), (0.05, 0.09), CRATE),
)


def _layout(
    bin_centres: tuple[tuple[float, float], tuple[float, float]],
    second_turned: bool,
    mat_centres: tuple[tuple[float, float], tuple[float, float]],
    mats_turned: bool,
    looks: tuple[Look, Look, Look],
) -> Layout:
    """Return a variant's layout.

    Args:
        bin_centres: x and y of both bins [m].
        second_turned: Whether the second bin's long side is along y.
        mat_centres: x and y of both mats [m]; their short sides meet.
        mats_turned: Whether the mats' long sides are along y.
        looks: Of the bins and of each mat.
    """
    wood, first, second = looks
    bins = (
        Bin("bin0", bin_centres[0], wood),
        Bin("bin1", bin_centres[1], wood, turned=second_turned),
    )
    mats = (
        Mat(mat_centres[0], first, turned=mats_turned),
        Mat(mat_centres[1], second, turned=mats_turned),
    )
    return Layout(BOXES, bins, mats)


DARK_WOOD = Look((0.27, 0.16, 0.10), (0.20, 0.11, 0.07), 0.35)
OAK = Look((0.62, 0.42, 0.22), (0.53, 0.35, 0.17), 0.35)
PLYWOOD = Look((0.82, 0.67, 0.46), (0.70, 0.53, 0.33), 0.35)
LIGHT_WOOD = Look((0.90, 0.80, 0.62), (0.83, 0.72, 0.53), 0.35)
DARK_GREY = Look((0.22, 0.22, 0.24), (0.16, 0.16, 0.18))
LIGHT_BROWN = Look((0.71, 0.57, 0.42), (0.62, 0.48, 0.34))
GREEN = Look((0.24, 0.48, 0.28), (0.18, 0.39, 0.22))
BROWN = Look((0.42, 0.27, 0.17), (0.34, 0.21, 0.13))
BLUE = Look((0.22, 0.34, 0.60), (0.17, 0.27, 0.50))
CLOTH = Look((0.66, 0.34, 0.40), (0.76, 0.50, 0.54), 0.4)
FELT = Look((0.48, 0.49, 0.50), (0.40, 0.41, 0.42), 0.4)

LAYOUTS: dict[Variant, Layout] = {
    "A": _layout(
        ((-0.05, -0.29), (-0.25, -0.08)),
        True,
        ((-0.135, 0.29), (0.075, 0.29)),
        False,
        (DARK_WOOD, DARK_GREY, LIGHT_BROWN),
    ),
    "B": _layout(
        ((-0.05, 0.29), (-0.25, 0.08)),
        True,
        ((-0.135, -0.29), (0.075, -0.29)),
        False,
        (OAK, GREEN, BROWN),
    ),
    "C": _layout(
        ((-0.09, -0.29), (-0.25, 0.08)),
        True,
        ((0.14, -0.105), (0.14, 0.105)),
        True,
        (PLYWOOD, GREEN, BLUE),
    ),
    "D": _layout(
        ((-0.09, -0.29), (-0.09, 0.29)),
        False,
        ((0.14, -0.105), (0.14, 0.105)),
        True,
        (LIGHT_WOOD, CLOTH, FELT),
    ),
}


class TidyUpTask(TableTopTask):
    """The paper's TidyUp: both small boxes into the first bin, the large one onto the second mat.

    Solved when they are there, at rest, and no finger touches one.

    The release's bins are 0.24 m long and 0.12 to 0.14 m wide; here all are 0.14 m wide, walls
    included, and success is measured by that. The start regions are the release's, for the boxes'
    centres. In A the smaller box often starts where the hand does not fit between the bins' walls,
    in B, C and D seldom. Looks are our own.

    Args:
        variant: Where bins and mats are, and how they look.
    """

    words = "put both small boxes into the bin and push the large one onto the mat"
    workspace_low = (-0.28, -0.32, 0.80)
    workspace_high = (0.135, 0.32, 1.05)

    def __init__(self, variant: Variant) -> None:
        super().__init__(LAYOUTS[variant])

    def subtasks(self) -> tuple[Subtask, ...]:
        """Return what a demonstrator does; see `Task`."""
        mat = self.layout.mats[TARGET_MAT]
        *small, large = BOXES
        into = self.layout.bins[TARGET_BIN]
        put = [
            put_into_bin(box, into, part, len(small), self.layout) for part, box in enumerate(small)
        ]
        # The higher one first: where it stands, a hand that takes the lower one knocks it over.
        return (*reversed(put), push_to(large, mat.centre, MAT_REACH / 2))

    def is_tidy(self, scene: Scene) -> bool:
        """Whether each box is in the bin or on the mat that it belongs to."""
        target, mat = self.layout.bins[TARGET_BIN], self.layout.mats[TARGET_MAT]
        *small, large = scene.object_positions
        return all(map(target.holds, small)) and mat.distance(large) < MAT_REACH
