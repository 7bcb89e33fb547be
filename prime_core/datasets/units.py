"""Whether numbers from elsewhere can be in our units: metres, radians, unit quaternions."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from prime_core.contracts.demonstration import Demonstration
from prime_core.contracts.description import SceneDescription
from prime_core.contracts.environment import ACTION_LIMIT, ACTION_NAMES
from prime_core.contracts.observations import GRIPPER_WIDTH

NORM_TOLERANCE = 0.02  # of a quaternion
ROOM = 1.0  # metres beyond the workspace where a gripper may still be
FARTHEST = 10.0  # metres from the origin where an object may be
WIDEST = 0.3  # metres that a gripper may be open
MOST_TURNED = 4 * np.pi  # radians of a joint
EXCESS = 2.0  # times the limit of motor actions, which an environment clips


@dataclass(frozen=True, eq=False)
class _Bounds:
    """What numbers ``(N, width)`` must lie between, and what is said of others."""

    names: Sequence[str]
    values: NDArray[np.float32]
    low: ArrayLike
    high: ArrayLike
    unit: str

    def problem(self) -> str | None:
        """Return what is said of the first number out of bounds, None where there is none."""
        beyond = (self.values < self.low) | (self.values > self.high)
        if not beyond.any():
            return None
        frame, column = (int(index) for index in np.argwhere(beyond)[0])
        value = self.values[frame, column]
        return f"{self.names[column]} is {value:.4g} in frame {frame}, but {self.unit}"


def wrong_unit(demonstration: Demonstration, description: SceneDescription | None) -> str | None:
    """Return what cannot be in our units, in words, or None.

    Args:
        demonstration: What to look at.
        description: Of the environment that it is for; where None, only actions are looked at.
    """
    bounds = [_action_bounds(demonstration)]
    if description is None:
        return bounds[0].problem()
    bounds += [*_robot_bounds(demonstration, description)]
    seen = demonstration.observations
    quaternions = {"gripper": seen.gripper_quaternion}
    if seen.environment_state is not None:
        bounds += [*_object_bounds(seen.environment_state, description.environment_state_names)]
        for number, item in enumerate(description.objects):
            quaternions[item.name] = seen.object_quaternions[:, number]
    problems = [item.problem() for item in bounds]
    problems += [_not_unit(name, values) for name, values in quaternions.items()]
    return next((text for text in problems if text is not None), None)


def _action_bounds(demonstration: Demonstration) -> _Bounds:
    limit = EXCESS * ACTION_LIMIT
    unit = (
        f"motor actions are at most {ACTION_LIMIT[0]} m and {ACTION_LIMIT[3]} rad a step, and -1 "
        "to 1 of the gripper: are they scaled to -1 to 1?"
    )
    return _Bounds(ACTION_NAMES, demonstration.actions, -limit, limit, unit)


def _robot_bounds(
    demonstration: Demonstration, description: SceneDescription
) -> Iterator[_Bounds]:
    seen, names = demonstration.observations, description.state_names
    low, high = np.array(description.workspace_low), np.array(description.workspace_high)
    unit = (
        f"the workspace is {low.tolist()} to {high.tolist()}: positions are metres in the world "
        "frame"
    )
    yield _Bounds(names, seen.gripper_position, low - ROOM, high + ROOM, unit)
    opening = seen.gripper_opening[:, None]
    unit = "the opening is the distance between the fingers in metres"
    yield _Bounds(names[GRIPPER_WIDTH - 1 :], opening, -WIDEST, WIDEST, unit)
    unit = "joint positions are radians"
    joints = names[GRIPPER_WIDTH:]
    yield _Bounds(joints, seen.joint_positions, -MOST_TURNED, MOST_TURNED, unit)


def _object_bounds(values: NDArray[np.float32], names: Sequence[str]) -> Iterator[_Bounds]:
    places = [index for index, name in enumerate(names) if name.endswith((".x", ".y", ".z"))]
    unit = "positions are metres in the world frame"
    labels = [names[index] for index in places]
    yield _Bounds(labels, values[:, places], -FARTHEST, FARTHEST, unit)
    flags = [index for index, name in enumerate(names) if name.endswith(".held")]
    labels = [names[index] for index in flags]
    yield _Bounds(labels, values[:, flags], 0.0, 1.0, "it is 1 while the object is held, else 0")


def _not_unit(name: str, quaternions: NDArray[np.float32]) -> str | None:
    """Return what is said of quaternions ``(N, 4)`` whose length is not 1."""
    lengths = np.linalg.norm(quaternions, axis=1)
    bad = np.abs(lengths - 1) > NORM_TOLERANCE
    if not bad.any():
        return None
    frame = int(np.argmax(bad))
    return (
        f"{name}.qw, qx, qy, qz have the length {lengths[frame]:.3g} in frame {frame}, but it is "
        "a unit quaternion, w first"
    )
