"""Tells calls of an episode that are made again and again, or that change nothing."""

from collections.abc import Mapping

import numpy as np

from prime_core.contracts.calls import PrimitiveCall
from prime_core.contracts.primitive import Primitive
from prime_core.contracts.scene import Scene
from prime_core.rotations import wrap_angle

STILL = 0.01  # [m] by which objects and the gripper may be elsewhere and nothing has changed
STILL_TURN = 0.1  # [rad] by which the gripper may have turned
# By which parameters of calls that are alike may differ: less than the spread of a policy's own
# draws, more than the errors of its means.
ALIKE = {"m": 0.02, "rad": 0.3}
ALIKE_SHARE = 0.05  # of the range of a parameter in another unit, likewise


class CallHistory:
    """The calls of an episode, and the scenes that they were made from.

    Args:
        primitives: By their names.
    """

    def __init__(self, primitives: Mapping[str, Primitive]) -> None:
        self._primitives = primitives
        self._calls: list[tuple[Scene, PrimitiveCall]] = []

    def add(self, scene: Scene, call: PrimitiveCall) -> None:
        """Remember that a call was made from a scene."""
        self._calls.append((scene, call))

    def count(self, scene: Scene, call: PrimitiveCall) -> int:
        """Return how often calls like it were made from scenes like this one.

        Scenes are alike if the same is held and all known objects are where they were, wherever
        the gripper is: what failed once from elsewhere may do now, but hardly a third time.
        """
        return sum(
            past.primitive == call.primitive
            and _are_alike(scene, before)
            and self._resembles(call, past)
            for before, past in self._calls
        )

    def _resembles(self, call: PrimitiveCall, past: PrimitiveCall) -> bool:
        space = self._primitives[call.primitive].parameter_space
        differences = np.abs(space.difference(call.parameters, past.parameters))
        tolerances = [
            ALIKE.get(item.unit, ALIKE_SHARE * (item.high - item.low)) for item in space.parameters
        ]
        return bool(np.all(differences <= tolerances))


def has_changed(before: Scene, after: Scene) -> bool:
    """Whether something was taken or let go of, or the gripper or an object is elsewhere.

    An object that turns in place does not count.
    """
    way = np.linalg.norm(after.gripper_position - before.gripper_position)
    turn = abs(wrap_angle(after.gripper_yaw - before.gripper_yaw))
    return not _are_alike(before, after) or bool(way > STILL or turn > STILL_TURN)


def _are_alike(scene: Scene, other: Scene) -> bool:
    """Whether the same is held and all known objects are in the same place."""
    if scene.objects is None or other.objects is None:
        return scene.holding == other.holding
    if scene.objects.held != other.objects.held:
        return False
    moves = scene.objects.positions - other.objects.positions
    return bool(np.linalg.norm(moves, axis=1).max(initial=0.0) <= STILL)
