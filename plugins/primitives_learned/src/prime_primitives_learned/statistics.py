"""What segments tell of a primitive besides its motion: when it starts, where, what it changes."""

from typing import Annotated

import numpy as np
from pydantic import Field

from prime_core.arrays import Array
from prime_core.configuration import Config
from prime_core.contracts.calls import Parameter, ParameterSpace
from prime_core.contracts.demonstration import Demonstration
from prime_core.contracts.primitive import PrimitiveExamples
from prime_core.rotations import yaw_of
from prime_primitives_learned.examples import achieved, holding_in, useful_frames
from prime_primitives_learned.frame import ParameterPlaces

MOST = 0.8  # share of segments that agree where something is taken for a rule
MOVED = 0.05  # [m] that a thing must have moved in the plane without being held: it was pushed


class SegmentStatistics(Config):
    """What segments tell of a primitive."""

    name: str
    """What the segments call it."""
    parameters: tuple[Parameter, ...]
    """As the data set has them."""
    segments: Annotated[int, Field(ge=1)]
    """How many there were."""
    longest: Annotated[int, Field(ge=1)]
    """Motor actions of the longest, without waiting."""
    holds_before: bool | None
    """Whether something is held where it starts; null where segments differ."""
    holds_after: bool | None
    """The same where it ends."""
    moves: bool
    """Whether it moves a thing without holding it."""
    relative_parameters: tuple[tuple[float, ...], ...]
    """The parameters of each segment, with the pose that was reached, in the yaw frame of the
    nearest object that was not held where it starts; empty where object poses are not known."""

    @property
    def space(self) -> ParameterSpace:
        """Of the parameters."""
        return ParameterSpace(self.parameters)


def statistics_of(examples: PrimitiveExamples) -> SegmentStatistics:
    """Return what segments tell of a primitive."""
    places = ParameterPlaces(examples.space)
    holding = [holding_in(item)[[0, -1]] for item in examples.executions]
    pairs = zip(examples.executions, examples.parameters, strict=True)
    seen = [_seen_from_object(places, *pair) for pair in pairs if _has_objects(pair[0])]
    moves = [_moves_something(item) for item in examples.executions]
    return SegmentStatistics(
        name=examples.name,
        parameters=examples.space.parameters,
        segments=len(examples.executions),
        longest=max(max(len(useful_frames(item)) for item in examples.executions), 1),
        holds_before=_rule([bool(flags[0]) for flags in holding]),
        holds_after=_rule([bool(flags[1]) for flags in holding]),
        moves=_rule(moves) is True,
        relative_parameters=tuple(tuple(map(float, item)) for item in seen if item is not None),
    )


def _rule(flags: list[bool]) -> bool | None:
    share = float(np.mean(flags))
    return True if share >= MOST else False if share <= 1 - MOST else None


def _has_objects(execution: Demonstration) -> bool:
    objects = execution.observations.environment_state
    return objects is not None and objects.shape[1] > 0


def _moves_something(execution: Demonstration) -> bool:
    if not _has_objects(execution):
        return False
    seen = execution.observations
    moves = seen.object_positions[-1, :, :2] - seen.object_positions[0, :, :2]
    lengths = np.linalg.norm(moves, axis=1)
    return bool((lengths[~seen.held.any(axis=0)] > MOVED).any())


def _seen_from_object(
    places: ParameterPlaces, execution: Demonstration, parameters: Array
) -> Array | None:
    """Return parameters seen from the nearest object, ``(P,)``; None where all are held."""
    first = execution.observations[:1]
    parameters = achieved(places, execution, parameters)
    positions = first.object_positions[0].astype(np.float64)
    distances = np.linalg.norm(positions - parameters[places.point], axis=1)
    distances[first.held[0]] = np.inf
    nearest = int(np.argmin(distances))
    if not np.isfinite(distances[nearest]):
        return None
    yaw = float(yaw_of(first.object_quaternions[0, nearest]))
    return places.seen_from(parameters, positions[nearest], yaw)
