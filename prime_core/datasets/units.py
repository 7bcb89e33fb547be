"""Whether numbers from elsewhere can be in our units: metres, radians, unit quaternions."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from prime_core.contracts.demonstration import Demonstration
from prime_core.contracts.description import SceneDescription
from prime_core.contracts.environment import ACTION_LIMIT, ACTION_NAMES

NORM_TOLERANCE = 0.02  # of a quaternion
ROOM = 1.0  # metres beyond the workspace where a gripper may still be
FARTHEST = 10.0  # metres from the origin where an object may be
WIDEST = 0.3  # metres that a gripper may be open
MOST_TURNED = 4 * np.pi  # radians of a joint
EXCESS = 2.0  # times the limit of motor actions, which an environment clips

ACTION_UNITS = (
    f"motor actions are at most {ACTION_LIMIT[0]} m and {ACTION_LIMIT[3]} rad a step, and -1 to 1 "
    "of the gripper: are they scaled to -1 to 1?"
)


@dataclass(frozen=True)
class _Column:
    """What a number must lie between, and what is said if it does not."""

    name: str
    low: float
    high: float
    unit: str


class UnitCheck:
    """Looks for numbers that cannot be in our units.

    Args:
        description: Of the environment that demonstrations are for; where None, only actions are
            looked at.
    """

    def __init__(self, description: SceneDescription | None) -> None:
        limits = zip(ACTION_NAMES, EXCESS * ACTION_LIMIT, strict=True)
        self._actions = _Bounds([_Column(name, -most, most, ACTION_UNITS) for name, most in limits])
        self._state = _Bounds([*_robot_columns(description)] if description else [])
        self._objects = _Bounds([*_object_columns(description)] if description else [])
        self._object_names = [item.name for item in description.objects] if description else []

    def problem(self, demonstration: Demonstration) -> str | None:
        """Return what cannot be in our units, in words, or None."""
        seen = demonstration.observations
        problem = self._actions.problem(demonstration.actions)
        if self._state.columns:
            problem = problem or self._state.problem(seen.state)
            problem = problem or _not_unit(["gripper"], seen.gripper_quaternion[:, None])
        if self._object_names and seen.environment_state is not None:
            problem = problem or self._objects.problem(seen.environment_state)
            problem = problem or _not_unit(self._object_names, seen.object_quaternions)
        return problem


class _Bounds:
    """The columns of one feature."""

    def __init__(self, columns: Sequence[_Column]) -> None:
        self.columns = columns
        self._low = np.array([column.low for column in columns])
        self._high = np.array([column.high for column in columns])

    def problem(self, values: NDArray[np.float32]) -> str | None:
        """Return what is said of the first number out of bounds, None where there is none."""
        beyond = (values < self._low) | (values > self._high)
        if not beyond.any():
            return None
        frame, number = (int(index) for index in np.argwhere(beyond)[0])
        column = self.columns[number]
        return f"{column.name} is {values[frame, number]:.4g} in frame {frame}, but {column.unit}"


def _robot_columns(description: SceneDescription) -> Iterator[_Column]:
    low, high = description.workspace_low, description.workspace_high
    place = f"the workspace is {[*low]} to {[*high]}: positions are metres in the world frame"
    joints = "joint positions are radians"
    for number, name in enumerate(description.state_names):
        if number < 3:
            yield _Column(name, low[number] - ROOM, high[number] + ROOM, place)
        elif number < 7:
            yield _Column(name, -np.inf, np.inf, "")
        elif number == 7:
            opening = "the opening is the distance between the fingers in metres"
            yield _Column(name, -WIDEST, WIDEST, opening)
        else:
            yield _Column(name, -MOST_TURNED, MOST_TURNED, joints)


def _object_columns(description: SceneDescription) -> Iterator[_Column]:
    for name in description.environment_state_names:
        part = name.rpartition(".")[2]
        if part in ("x", "y", "z"):
            yield _Column(name, -FARTHEST, FARTHEST, "positions are metres in the world frame")
        elif part == "held":
            yield _Column(name, 0.0, 1.0, "it is 1 while the object is held, else 0")
        else:
            yield _Column(name, -np.inf, np.inf, "")


def _not_unit(names: Sequence[str], quaternions: NDArray[np.float32]) -> str | None:
    """Return what is said of quaternions ``(N, things, 4)`` whose length is not 1."""
    squares = np.einsum("ijk,ijk->ij", quaternions, quaternions)
    bad = np.abs(np.sqrt(squares) - 1) > NORM_TOLERANCE
    if not bad.any():
        return None
    frame, thing = (int(index) for index in np.argwhere(bad)[0])
    return (
        f"{names[thing]}.qw, qx, qy, qz have the length {np.sqrt(squares[frame, thing]):.3g} in "
        f"frame {frame}, but it is a unit quaternion, w first"
    )
