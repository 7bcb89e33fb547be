"""Calls that are nearly as good as another one: the same with the gripper turned."""

from collections.abc import Iterator

import numpy as np

from prime_core.arrays import Array
from prime_core.contracts.calls import ParameterSpace, PrimitiveCall
from prime_core.contracts.description import Affordance
from prime_core.contracts.scene import Scene
from prime_core.rotations import wrap_angle, yaw_of

NEAR = 0.05  # [m] from an object in the plane, for a call to be about it
STEPS = 12  # turns that are tried in a period


def calls_at_good_yaws(
    call: PrimitiveCall, space: ParameterSpace, scene: Scene
) -> Iterator[PrimitiveCall]:
    """Yield a call at the other yaws that its affordance says are good, if it has any.

    A box that is gripped along x next to a wall may be out of the hand's way along y.

    Args:
        call: Has parameters x and y [m] and a yaw [rad], or nothing is yielded.
        space: Of its parameters.
        scene: The scene now; without known objects nothing is yielded.
    """
    names = [item.name for item in space.parameters]
    if not {"x", "y", "yaw"} <= set(names) or scene.objects is None:
        return
    place = call.parameters[[names.index("x"), names.index("y")]]
    affordance = _nearest(call.primitive, place, scene)
    if affordance is None or affordance.yaws is None or affordance.reference is None:
        return
    index = names.index("yaw")
    period = space.parameters[index].period or 2 * np.pi
    base = yaw_of(scene.objects.quaternions[scene.object_index(affordance.reference)])
    turns = wrap_angle(np.array(affordance.yaws) + base - call.parameters[index], period)
    own = turns[np.argmin(np.abs(turns))]
    for turn in turns[turns != own] - own:
        yield from _turned(call, space, turn)


def calls_at_any_yaw(call: PrimitiveCall, space: ParameterSpace) -> Iterator[PrimitiveCall]:
    """Yield a call at other yaws, ever farther from its own.

    A box next to a wall can be gripped at its corners, and pushed with a side of the hand. Up to
    five twelfths of a period either way are tried. The gripper turns about itself: what it holds
    off its centre ends up elsewhere.

    Args:
        call: Has a parameter yaw [rad], or nothing is yielded.
        space: Of its parameters.
    """
    names = [item.name for item in space.parameters]
    if "yaw" not in names:
        return
    period = space.parameters[names.index("yaw")].period or 2 * np.pi
    turns = np.arange(1, STEPS) - STEPS // 2
    for turn in turns[np.argsort(np.abs(turns), kind="stable")]:
        if turn:
            yield from _turned(call, space, turn * period / STEPS)


def _turned(call: PrimitiveCall, space: ParameterSpace, turn: float) -> Iterator[PrimitiveCall]:
    """Yield a call turned by an angle [rad], if that is within the bounds of its parameters."""
    index = [item.name for item in space.parameters].index("yaw")
    period = space.parameters[index].period or 2 * np.pi
    parameters = call.parameters.copy()
    middle = (space.low[index] + space.high[index]) / 2
    parameters[index] = middle + wrap_angle(parameters[index] + turn - middle, period)
    if space.contains(parameters):
        yield PrimitiveCall(call.primitive, parameters)


def _nearest(action: str, place: Array, scene: Scene) -> Affordance | None:
    """Return the affordance of the object next to a place ``(2,)``, if one is."""
    best, least = None, NEAR
    for item in scene.description.affordances_for(action):
        if item.reference is None or item.of_held:
            continue
        centre = scene.object_positions[scene.object_index(item.reference), :2]
        distance = float(np.linalg.norm(centre - place))
        if distance < least:
            best, least = item, distance
    return best
