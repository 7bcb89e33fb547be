"""Tasks with boxes, open bins and painted mats on a table, and their subtasks."""

from abc import abstractmethod
from collections.abc import Sequence
from typing import Any

import numpy as np

from prime_core.contracts.description import Affordance
from prime_core.contracts.scene import Scene
from prime_envs_robosuite.simulation.objects import ObjectMotion, Placement
from prime_envs_robosuite.tasks.robosuite_import import make_host
from prime_envs_robosuite.tasks.subtasks import ArmReach, Push, PutInto
from prime_envs_robosuite.tasks.table_top_objects import (
    BIN_FLOOR,
    BIN_WALL,
    RELEASE_MARGIN,
    TABLE_TOP,
    WIDEST_GRIP,
    Bin,
    Box,
    Layout,
)
from prime_envs_robosuite.tasks.task import PlacedTask

PART_GAP = 0.05  # between the parts of a bin that boxes are put into: half of each box there [m]
DROP_HEIGHT = 0.04  # over the bin's floor from which a box is dropped, for the walls' sake [m]
EASY_REACH = ArmReach(base=(-0.56, 0.0), distance=0.72)  # of the arm at the table's edge
FINGER_THICKNESS = 0.012  # half of it, of the closed fingers [m]


class TableTopTask(PlacedTask):
    """A task with boxes, bins and mats on a table of 0.8 x 0.8 m.

    Args:
        layout: What is on the table.
    """

    lift_height = TABLE_TOP + 0.15

    def __init__(self, layout: Layout) -> None:
        self.layout = layout
        self.objects = tuple(box.describe() for box in layout.boxes)
        self.body_names = tuple(box.name for box in layout.boxes)

    def make_host(self) -> Any:
        """Build the robosuite environment; see `Task`."""
        return make_host("TableTop", layout=self.layout)

    def placements(self, host: Any) -> tuple[Placement, ...]:
        """Return where each box starts; see `Task`."""
        return tuple(box.placement() for box in self.layout.boxes)

    def affordances(self) -> tuple[Affordance, ...]:
        """Return where actions make sense; see `Task`."""
        boxes = [item for box in self.layout.boxes for item in box.affordances()]
        return (*boxes, *(item.affordance() for item in self.layout.bins))

    def is_success(self, scene: Scene, touched: bool, motions: Sequence[ObjectMotion]) -> bool:
        """Whether all boxes are where they belong, at rest, and no finger touches one."""
        at_rest = all(motion.at_rest for motion in motions)
        return not touched and at_rest and self.is_tidy(scene)

    @abstractmethod
    def is_tidy(self, scene: Scene) -> bool:
        """Whether all boxes are where they belong, moving or not."""


def put_into_bin(box: Box, target: Bin, part: int, parts: int, layout: Layout) -> PutInto:
    """Return the subtask of putting a box into a part of a bin.

    Args:
        box: The box.
        target: The bin.
        part: Which part, counted from 0 along its long side.
        parts: How many there are.
        layout: All that is on the table.
    """
    inner = np.array(target.half_size) - RELEASE_MARGIN + BIN_WALL
    low, high = np.array(target.centre) - inner, np.array(target.centre) + inner
    axis = int(target.turned)
    length = (high[axis] - low[axis] - (parts - 1) * PART_GAP) / parts
    low[axis] += part * (length + PART_GAP)
    high[axis] = low[axis] + length
    return PutInto(
        object_name=box.name,
        low=(float(low[0]), float(low[1])),
        high=(float(high[0]), float(high[1])),
        reach=EASY_REACH,
        rise=BIN_FLOOR + DROP_HEIGHT,
        beside=tuple(item.outside() for item in layout.bins),
        neighbours=tuple(item.neighbour() for item in layout.boxes if item != box),
        any_yaw=2 * float(np.hypot(*box.half_size[:2])) < WIDEST_GRIP,
    )


def push_to(box: Box, centre: tuple[float, float], within: float) -> Push:
    """Return the subtask of pushing a box to a place.

    Args:
        box: What is pushed.
        centre: x and y of the place [m].
        within: How far from it along x and y the box may end [m].
    """
    return Push(
        object_name=box.name,
        low=(centre[0] - within, centre[1] - within),
        high=(centre[0] + within, centre[1] + within),
        standoff=box.standoff,
        touching=max(box.half_size[:2]) + FINGER_THICKNESS,
        height=TABLE_TOP + box.half_size[2],
    )
