"""Affordances of objects that nothing is known of but their shapes and where they start."""

from collections.abc import Mapping, Sequence

import numpy as np

from prime_core.arrays import Array
from prime_core.contracts.description import Affordance
from prime_envs_robosuite.robosuite_tasks.object_shapes import Corner, ObjectShape
from prime_envs_robosuite.tasks.table_top_objects import WIDEST_GRIP
from prime_envs_robosuite.tasks.task import QUARTER_TURNS

FINGER_REACH = 0.015  # below the gripper's position, with room to what the object lies on [m]
COVERED = (0.012, 0.025)  # how far below an object's top it is gripped, least and most [m]
WIDE = 0.9  # share of an object's width that still counts as wide
LEAST_RANGE = 0.003  # of heights at which it is gripped [m]
ASIDE = 0.01  # how far from a part's middle it is gripped at most [m]
OPENED = 0.055  # from the gripper's middle to the outside of an opened finger [m]
FINGER_HALF_WIDTH = 0.011  # [m]
RELEASE_GAP = (0.003, 0.01)  # over what something is put down on when it is let go of [m]
LOWERED = 0.02  # over the least height at which all fit between gripper and table [m]
ABOVE = (0.05, 0.12)  # heights of a reach over where an object is gripped [m]
EDGE = 0.05  # of the workspace that is left out [m]
TOUCHING = 0.001  # depth to which parts beside each other may overlap [m]
ALONG = (0.0, 0.5, -0.5)  # where along a part a grip is looked for, as a share of half of it
MOST_PARTS = 3  # of an object that are said to be good to grip


def grasps(name: str, shape: ObjectShape) -> tuple[Affordance, ...]:
    """Return where an object can be gripped from above; nothing where it is too wide.

    Of several parts those that fit between the fingers, with room for both, are gripped, the
    largest first; where robosuite names a handle, the part there alone.

    Args:
        name: Of the object.
        shape: Of the object.
    """
    handle = shape.handle

    def rank(part: Array) -> float:
        low, high = part.min(axis=0), part.max(axis=0)
        if handle is None:
            return -float(np.prod(high - low))
        return float(np.linalg.norm((low + high) / 2 - handle))

    found: list[Affordance] = []
    most_parts = MOST_PARTS if handle is None else 1
    for part in sorted(shape.parts, key=rank):
        if len({spot.low for spot in found}) >= most_parts:
            break
        low, high = part.min(axis=0), part.max(axis=0)
        top = _shoulder(part)
        least = max(shape.low[2] + FINGER_REACH, top - COVERED[1])
        most = max(least + LEAST_RANGE, top - COVERED[0])
        aside = np.minimum((high - low)[:2] / 4, ASIDE)
        others = [other for other in shape.parts if other is not part]
        for middle, yaws in _free_grips(part, others).items():
            corners = (_corner(*(middle + side * aside), z) for side, z in ((-1, least), (1, most)))
            good = None if shape.yaw_symmetry() == 0 else yaws
            found.append(Affordance("grasp", name, *corners, good))
    return tuple(found)


def reaches_above(grasp: Affordance) -> Affordance:
    """Return where to reach above a place where an object can be gripped."""
    low, high = (
        (x, y, grasp.high[2] + rise)
        for (x, y, _), rise in zip((grasp.low, grasp.high), ABOVE, strict=True)
    )
    return Affordance("reach", grasp.reference, low, high, grasp.yaws)


def place_on(name: str, shape: ObjectShape, others: Sequence[ObjectShape]) -> Affordance:
    """Return where to put others down on an object: their centres above its middle.

    Args:
        name: Of the object that is below.
        shape: Of it.
        others: Of those that may be put on it.
    """
    middle = (shape.low + shape.high)[:2] / 2
    depths = [-float(other.low[2]) for other in others]
    low, high = (
        _corner(*middle, shape.high[2] + depth + gap)
        for depth, gap in zip((min(depths), max(depths)), RELEASE_GAP, strict=True)
    )
    return Affordance("place", name, low, high, of_held=True)


def over_the_table(
    grasp_spots: Sequence[Affordance],
    shapes: Mapping[str, ObjectShape],
    surface: float,
    low: Sequence[float],
    high: Sequence[float],
) -> tuple[Affordance, ...]:
    """Return where to put things down, and to hold them up, above what they lie on.

    Gripper positions: as high as the tallest needs, so that lower things fall a little.

    Args:
        grasp_spots: Where objects are gripped.
        shapes: Of the objects, by name.
        surface: World height of what they lie on [m].
        low: Lower corner of the workspace [m].
        high: Upper corner [m].
    """
    above = [
        (spot.low[2] + spot.high[2]) / 2 - float(shapes[spot.reference or ""].low[2])
        for spot in grasp_spots
    ]
    least = surface + max(above)
    near, far = np.array(low[:2]) + EDGE, np.array(high[:2]) - EDGE
    heights = {"place": (least, least + LOWERED), "reach": (least + ABOVE[0], least + ABOVE[1])}
    return tuple(
        Affordance(action, None, _corner(*near, lower), _corner(*far, upper))
        for action, (lower, upper) in heights.items()
    )


def _shoulder(part: Array) -> float:
    """Return up to which height [m] a part is about as wide as anywhere: a roof is not."""
    middle = (part.min(axis=0) + part.max(axis=0)) / 2
    aside = np.abs(part - middle)[:, :2]
    wide = aside > WIDE * aside.max(axis=0)
    return float(min(part[wide[:, axis], 2].max() for axis in (0, 1)))


def _free_grips(
    part: Array, others: Sequence[Array]
) -> dict[tuple[float, float], tuple[float, ...]]:
    """Return where along a part both opened fingers have room, and at which yaws of the gripper."""
    low, high = part.min(axis=0), part.max(axis=0)
    found: dict[tuple[float, float], tuple[float, ...]] = {}
    for across, yaw in zip((1, 0), QUARTER_TURNS, strict=True):
        half = (high - low)[across] / 2
        if 2 * half >= WIDEST_GRIP:
            continue
        for share in ALONG:
            middle = (low + high)[:2] / 2
            middle[1 - across] += share * (high - low)[1 - across] / 2
            blocked = (_is_in_the_way(other, middle, across, half, high[2]) for other in others)
            if not any(blocked):
                key = float(middle[0]), float(middle[1])
                found[key] = (*found.get(key, ()), yaw)
                break
    return found


def _is_in_the_way(other: Array, middle: Array, across: int, half: float, top: float) -> bool:
    """Whether a finger that comes down beside a part would meet another part.

    Args:
        other: Points of the other part [m], ``(n, 3)``.
        middle: x and y of where the part is gripped [m], ``(2,)``.
        across: The axis that the fingers close along, 0 or 1.
        half: Half of the part's width along it [m].
        top: Height of the part [m].
    """
    low, high = other.min(axis=0), other.max(axis=0)
    if high[2] < top - COVERED[1] - FINGER_REACH:
        return False
    along = 1 - across
    if abs((low + high)[along] / 2 - middle[along]) > (high - low)[along] / 2 + FINGER_HALF_WIDTH:
        return False
    far = middle[across] + np.array([[half, OPENED], [-OPENED, -half]])
    return bool(
        np.any((low[across] < far[:, 1] - TOUCHING) & (high[across] > far[:, 0] + TOUCHING))
    )


def _corner(x: float, y: float, z: float) -> Corner:
    """Return a corner to a tenth of a millimetre."""
    return round(float(x), 4), round(float(y), 4), round(float(z), 4)
