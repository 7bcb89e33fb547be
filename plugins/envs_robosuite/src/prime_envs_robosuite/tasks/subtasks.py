"""What a demonstrator does with the objects of a task, one subtask after another.

Lengths are metres, angles radians, heights and positions in the world frame.
"""

from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True)
class Bounds:
    """An upright box, which a hand has to fit into, or to keep off.

    Attributes:
        low: Smallest x and y [m]; of a box without a lid, inside of its walls or outside of them.
        high: Greatest x and y [m].
        top: Height of its upper edge [m].
    """

    low: tuple[float, float]
    high: tuple[float, float]
    top: float


@dataclass(frozen=True)
class ArmReach:
    """Where the gripper is when it lets go: not too far from the arm.

    Attributes:
        base: x and y of the arm's base [m].
        distance: Greatest distance of the gripper from it in the plane [m].
    """

    base: tuple[float, float]
    distance: float


@dataclass(frozen=True)
class Neighbour:
    """An object that a hand keeps off while it takes another one.

    Attributes:
        object_name: The object.
        half_size: Half of its extent along its own axes [m].
    """

    object_name: str
    half_size: tuple[float, float, float]


@dataclass(frozen=True, kw_only=True)
class Subtask:
    """What is done with one object.

    Attributes:
        object_name: The object.
        care: How much slower than usual it is done, with something small and close by.
    """

    object_name: str
    care: float = 1.0


@dataclass(frozen=True, kw_only=True)
class Picking(Subtask):
    """Starts with grasping the object where its affordance for grasping says.

    Attributes:
        taken_from: What it is taken out of; None where no walls are.
        beside: What stands near where it may be taken.
        neighbours: Objects that may lie near it.
        any_yaw: Whether it fits between the fingers whichever way they are turned, so that where
            there is no room for the hand it may be gripped at its corners.
    """

    taken_from: Bounds | None = None
    beside: tuple[Bounds, ...] = ()
    neighbours: tuple[Neighbour, ...] = ()
    any_yaw: bool = False


@dataclass(frozen=True, kw_only=True)
class HoldUp(Picking):
    """Take the object, and end with it held up."""


@dataclass(frozen=True, kw_only=True)
class PutInto(Picking):
    """Put the object down somewhere in a region, as it stood, and let go.

    Attributes:
        low: Smallest x and y where its grip may be let go of [m].
        high: Greatest x and y [m].
        reach: Where in the region it is put.
        room: What it is put into; None where no walls are.
        rise: How much higher the floor is there than where the object was taken [m].
    """

    low: tuple[float, float]
    high: tuple[float, float]
    reach: ArmReach
    room: Bounds | None = None
    rise: float = 0.0


@dataclass(frozen=True, kw_only=True)
class PutOnto(Picking):
    """Bring the object's centre to a point, from straight above, and let go.

    Attributes:
        point: Where its centre comes to rest [m].
        reach: Where the gripper is then.
        clearance: How far above the point its centre must be on the way there [m].
        drop: How far above the point its centre may be when it is let go of, from and to [m].
        retreat: How far the gripper then rises, from and to [m].
        yaws: Its yaws that are good [rad]; None if any is.
        reference: The object that the point goes with, relative to its centre and along the
            axes of the world; None for a point in the world.
    """

    point: tuple[float, float, float]
    reach: ArmReach
    clearance: float
    drop: tuple[float, float]
    retreat: tuple[float, float]
    yaws: tuple[float, ...] | None = None
    reference: str | None = None


@dataclass(frozen=True, kw_only=True)
class Push(Subtask):
    """Push the object over the table into a region, with the closed gripper lowered beside it.

    Attributes:
        low: Smallest x and y that its centre may end at [m].
        high: Greatest x and y [m].
        standoff: From its centre to where the gripper comes down beside it [m].
        touching: From its centre to the gripper when the fingers touch it, about [m].
        height: Of the gripper while it pushes [m].
    """

    low: tuple[float, float]
    high: tuple[float, float]
    standoff: float
    touching: float
    height: float


def in_opposite_order(subtasks: Sequence[Subtask]) -> tuple[Subtask, ...]:
    """Return subtasks with those that pick something up in the opposite order, others in place."""
    picked = [subtask for subtask in subtasks if isinstance(subtask, Picking)]
    return tuple(picked.pop() if isinstance(item, Picking) else item for item in subtasks)
