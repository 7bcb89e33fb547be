"""Remembers the calls of a trial, so that none goes on for ever."""

from collections.abc import Mapping

import numpy as np

from prime_core.contracts.calls import PrimitiveCall
from prime_core.contracts.primitive import Primitive
from prime_core.contracts.scene import Scene

STILL = 0.01  # [m] by which objects may be elsewhere in scenes that are alike


ALIKE = {"m": 0.02, "rad": 0.3}  # by which parameters of calls that are alike may differ


ALIKE_SHARE = 0.05  # of the range of a parameter in another unit, likewise


TRIES = 2  # of calls that are alike, from scenes that are alike


class CallHistory:
    """The calls of a trial, and the scenes that they were made from.

    Args:
        primitives: By their names.
    """

    def __init__(self, primitives: Mapping[str, Primitive]) -> None:
        self._primitives = primitives
        self._calls: list[tuple[Scene, PrimitiveCall]] = []

    def add(self, scene: Scene, call: PrimitiveCall) -> None:
        """Remember that a call was made from a scene."""
        self._calls.append((scene, call))

    def is_worn_out(self, scene: Scene, call: PrimitiveCall) -> bool:
        """Whether calls like it were made from scenes like this one before, more than once.

        Scenes are alike if the same is held and all objects are where they were, wherever the
        gripper is: what failed once from elsewhere may do now, but hardly a third time.
        """
        alike = sum(
            past.primitive == call.primitive
            and _are_alike(scene, before)
            and self._resembles(call, past)
            for before, past in self._calls
        )
        return alike >= TRIES

    def _resembles(self, call: PrimitiveCall, past: PrimitiveCall) -> bool:
        space = self._primitives[call.primitive].parameter_space
        differences = np.abs(space.difference(call.parameters, past.parameters))
        tolerances = [
            ALIKE.get(item.unit, ALIKE_SHARE * (item.high - item.low)) for item in space.parameters
        ]
        return bool(np.all(differences <= tolerances))


def _are_alike(scene: Scene, other: Scene) -> bool:
    if scene.held != other.held:
        return False
    moves = scene.object_positions - other.object_positions
    return bool(np.all(np.linalg.norm(moves, axis=1) < STILL))
