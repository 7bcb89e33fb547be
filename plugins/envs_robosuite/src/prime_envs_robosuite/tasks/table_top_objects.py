"""What can be on a table: boxes to move, open bins and painted mats, as data.

The table's middle is the origin of x and y in the world frame.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from prime_core.contracts.description import Affordance, ObjectDescription
from prime_envs_robosuite.simulation.objects import Placement
from prime_envs_robosuite.tasks.subtasks import Bounds, Neighbour

Colour = tuple[float, float, float]
Array = np.ndarray[Any, np.dtype[np.float64]]

TABLE_TOP = 0.8  # height of the table's surface [m]
FRICTION = 0.6  # sliding friction of table, boxes and bins; the fingers' pads have their own
START_YAWS = (-float(np.pi / 4), float(np.pi / 4))  # [rad]
WIDEST_GRIP = 0.075  # width of what the fingers, which open to 0.08 m, can be put around [m]
PUSH_STARTS = 16  # around a box, 4 cm apart
QUARTER_TURN = (float(np.pi / 2),)  # [rad]
BIN_FLOOR = 0.04  # thickness [m]
BIN_WALL = 0.01  # thickness [m]
BIN_HEIGHT = 0.09  # of the walls' upper edge above the table [m]
# Of the gripper above the table where it lets go: opened fingers, which reach 12 mm lower, are
# clear of the walls at any yaw, and what is held falls some 4 cm, to the floor between them.
RELEASE_HEIGHT = (0.105, 0.115)
RELEASE_MARGIN = 0.06  # from a bin's edge: wall, half a box and the spread of draws [m]
MAT_SIZE = (0.21, 0.16)  # [m]
FINGER = 0.03  # half of the closed fingers' greater width, and a little room [m]


@dataclass(frozen=True)
class Look:
    """A plain surface with specks.

    Attributes:
        colour: Red, green and blue in [0, 1].
        specks: The specks' colour.
        share: Share of the surface that they cover.
    """

    colour: Colour
    specks: Colour
    share: float = 0.2


@dataclass(frozen=True)
class Box:
    """A box that can be moved, and where it starts.

    Attributes:
        name: Of the object.
        half_size: Along its own x, y and z [m].
        low: Smallest x and y of its centre at the start [m].
        high: Greatest x and y [m].
        look: Its surface.
    """

    name: str
    half_size: tuple[float, float, float]
    low: tuple[float, float]
    high: tuple[float, float]
    look: Look

    def describe(self) -> ObjectDescription:
        """Return the object; it is to be grasped where it fits the gripper, else pushed."""
        square = self.half_size[0] == self.half_size[1]
        fits = bool(self.grasp_yaws())
        return ObjectDescription(self.name, 4 if square else 2, graspable=fits, pushable=not fits)

    def neighbour(self) -> Neighbour:
        """Return what it is to a hand that takes another box."""
        return Neighbour(self.name, self.half_size)

    def placement(self) -> Placement:
        """Return where it starts."""
        # Standing, not falling: rollouts begin with objects at rest, and so should demonstrations.
        height = TABLE_TOP + self.half_size[2]
        return Placement(self.low, self.high, height, yaws=START_YAWS)

    def affordances(self) -> tuple[Affordance, ...]:
        """Return where to grasp it, or from where around it to begin to push it."""
        yaws = self.grasp_yaws()
        if yaws:
            return (Affordance("grasp", self.name, (0.0, 0.0, 0.0), (0.0, 0.0, 0.01), yaws),)
        turns = np.linspace(-np.pi, np.pi, PUSH_STARTS, endpoint=False).tolist()
        return tuple(self._push_from(float(turn)) for turn in turns)

    @property
    def standoff(self) -> float:
        """From its centre to where the closed fingers come down clear of it, from any side [m]."""
        return float(np.hypot(*self.half_size[:2])) + FINGER

    def _push_from(self, turn: float) -> Affordance:
        """Return where to begin to push it from a direction [rad] in its own frame."""
        point = (self.standoff * np.cos(turn), self.standoff * np.sin(turn), 0.0)
        # The fingers slide along the gripper's y axis: side by side they push a face flat.
        return Affordance("push", self.name, point, point, (turn,))

    def grasp_yaws(self) -> tuple[float, ...]:
        """Return the gripper's yaws relative to the box at which it fits between the fingers."""
        across_x, across_y = (2 * half < WIDEST_GRIP for half in self.half_size[:2])
        # The fingers close along the gripper's y axis.
        return ((0.0,) if across_y else ()) + (QUARTER_TURN if across_x else ())


@dataclass(frozen=True)
class Bin:
    """An open box that stands on the table.

    Attributes:
        name: Of its body in the model.
        centre: x and y [m].
        look: Its surface.
        turned: Whether its long side is along y, not x.
    """

    name: str
    centre: tuple[float, float]
    look: Look
    turned: bool = False

    @property
    def half_size(self) -> tuple[float, float]:
        """Half of its extent along x and y [m]."""
        return (0.07, 0.12) if self.turned else (0.12, 0.07)

    def parts(self) -> tuple[tuple[Array, Array], ...]:
        """Return centre and half size of its floor and its four walls [m], ``(3,)`` each.

        In the frame of its body, which is on the table with its axes along the world's.
        """
        x, y = self.half_size
        wall, height = BIN_WALL / 2, (BIN_HEIGHT - BIN_FLOOR) / 2
        parts = [(np.array([0.0, 0.0, BIN_FLOOR / 2]), np.array([x, y, BIN_FLOOR / 2]))]
        # The walls stand on the floor's rim; those along y are shorter by the corners.
        for side in (-1.0, 1.0):
            along = np.array([x, wall, height])
            across = np.array([wall, y - BIN_WALL, height])
            parts.append((np.array([0.0, side * (y - wall), BIN_FLOOR + height]), along))
            parts.append((np.array([side * (x - wall), 0.0, BIN_FLOOR + height]), across))
        return tuple(parts)

    def holds(self, position: Array) -> bool:
        """Whether a point [m], world frame, ``(3,)``, is above its floor and below its edge."""
        aside = np.abs(position[:2] - self.centre)
        inside = bool(np.all(aside < self.half_size))
        return inside and bool(position[2] < TABLE_TOP + BIN_HEIGHT)

    def outside(self) -> Bounds:
        """Return what it is to a hand that comes down beside it."""
        (x, y), (width, length) = self.centre, self.half_size
        return Bounds((x - width, y - length), (x + width, y + length), TABLE_TOP + BIN_HEIGHT)

    def affordance(self) -> Affordance:
        """Return where to let go of what belongs into it."""
        x, y = (half - RELEASE_MARGIN for half in self.half_size)
        low, high = (TABLE_TOP + height for height in RELEASE_HEIGHT)
        centre = self.centre
        return Affordance(
            "place", None, (centre[0] - x, centre[1] - y, low), (centre[0] + x, centre[1] + y, high)
        )


@dataclass(frozen=True)
class Mat:
    """A rectangle that is painted on the table.

    Attributes:
        centre: x and y [m].
        look: Its surface.
        turned: Whether its long side is along y, not x.
    """

    centre: tuple[float, float]
    look: Look
    turned: bool = False

    @property
    def half_size(self) -> tuple[float, float]:
        """Half of its extent along x and y [m]."""
        length, width = MAT_SIZE[0] / 2, MAT_SIZE[1] / 2
        return (width, length) if self.turned else (length, width)

    def distance(self, position: Array) -> float:
        """Return how far a point [m], world frame, ``(3,)``, is from the centre in the plane."""
        return float(np.linalg.norm(position[:2] - self.centre))


@dataclass(frozen=True)
class Layout:
    """What is on the table.

    Attributes:
        boxes: In the order of the scene's objects.
        bins: Those that something may be placed in.
        mats: Painted ones.
    """

    boxes: tuple[Box, ...]
    bins: tuple[Bin, ...]
    mats: tuple[Mat, ...]
