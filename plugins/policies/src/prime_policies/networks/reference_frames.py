"""Frames of reference: upright poses that a primitive's parameters may be relative to.

Of one instant: the world, and each object, with its yaw and without; the gripper's yaw, for angles.
Of a pair of instants: also the gripper at both, each object at the end and along the way that it
moved, and the gripper carried along by it. See Calinon, "A tutorial on task-parameterized movement
learning and retrieval", 2016.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from math import lcm

import numpy as np
from numpy.typing import NDArray

from prime_core.arrays import Array, Indices
from prime_core.contracts.description import SceneDescription
from prime_core.contracts.observations import Observations
from prime_core.learning.scene_features import JAW_SYMMETRY
from prime_core.rotations import wrap_angle, yaw_of

MOVED = 0.01  # [m] from which on an object's way has a direction

POINT = ("plane", "height")
POSE = (*POINT, "angle")
"""Kinds of groups of parameters (`parameter_layout.Group`)."""


@dataclass(frozen=True)
class ReferenceFrame:
    """One frame of reference.

    Attributes:
        name: What it is.
        kinds: Kinds of the groups of parameters that may be relative to it.
        is_object: Whether it is where an object is at s, which is then pushed to a second point.
    """

    name: str
    kinds: tuple[str, ...] = POSE
    is_object: bool = False


class ReferenceFrames:
    """The frames of reference of scenes.

    Args:
        description: Of the scenes.
        pair: Whether of pairs of instants, as an inverse dynamics model sees them.

    Attributes:
        frames: What they are, in the order of `poses`.
    """

    def __init__(self, description: SceneDescription, pair: bool) -> None:
        self._objects = description.objects
        self._pair = pair
        nowhere = np.zeros((1, 1 + len(self._objects), 4), dtype=np.float32)
        each = self._each(nowhere, np.zeros((1, 1 + pair), dtype=np.int64))
        self.frames = tuple(frame for frame, _ in each)

    def encode(self, seen: Observations) -> NDArray[np.float32]:
        """Return the poses of gripper and objects in each instant, ``(N, 1 + objects, 4)``.

        x, y, z [m] and yaw [rad]. Of the yaws that an object's symmetry makes equal, it is the one
        next to the gripper's.
        """
        poses = np.empty((len(seen), 1 + len(self._objects), 4), dtype=np.float32)
        yaw = seen.gripper_yaw
        poses[:, 0, :3], poses[:, 0, 3] = seen.gripper_position, yaw
        poses[:, 1:, :3] = seen.object_positions
        for index, item in enumerate(self._objects):
            own = yaw_of(seen.object_quaternions[:, index])
            if item.yaw_symmetry:
                period = 2 * np.pi / lcm(item.yaw_symmetry, JAW_SYMMETRY)
                own = yaw + wrap_angle(own - yaw, period)
            poses[:, index + 1, 3] = own
        return poses

    def poses(self, encoded: NDArray[np.float32], rows: Indices) -> Array:
        """Return the frames of reference of instants or of pairs of them.

        Args:
            encoded: From `encode`, ``(N, 1 + objects, 4)``.
            rows: ``(n, 1)``, or start and end ``(n, 2)`` of pairs.

        Returns:
            x, y, z [m] and yaw [rad] of each, ``(n, frames, 4)``.
        """
        return np.stack([pose for _, pose in self._each(encoded, rows)], axis=1)

    def _each(
        self, encoded: NDArray[np.float32], rows: Indices
    ) -> Iterator[tuple[ReferenceFrame, Array]]:
        """Yield each frame of reference and its poses ``(n, 4)``; see `poses`."""
        gripper, *befores = np.moveaxis(encoded[rows[:, 0]].astype(np.float64), 1, 0)
        gripper_after, *afters = np.moveaxis(encoded[rows[:, -1]].astype(np.float64), 1, 0)
        world = ReferenceFrame("world", (*POSE, "number"))  # plain numbers are relative to nothing
        yield world, np.zeros_like(gripper)
        yield ReferenceFrame("gripper at s", POSE if self._pair else ("angle",)), gripper
        if self._pair:
            yield ReferenceFrame("gripper at s'"), gripper_after
        for item, before, after in zip(self._objects, befores, afters, strict=True):
            name, kinds = item.name, POSE if item.yaw_symmetry else POINT
            yield ReferenceFrame(name, kinds, is_object=True), before
            if self._pair:
                yield ReferenceFrame(f"{name} at s'", kinds), after
                yield ReferenceFrame(f"{name} along its way", POINT), _along(before, after)
                carried = _carried(gripper, before, after)
                yield ReferenceFrame(f"gripper carried by {name}"), carried
            else:
                upright = np.pad(before[:, :3], ((0, 0), (0, 1)))
                yield ReferenceFrame(f"{name} without its yaw", POINT), upright


def _carried(gripper: Array, before: Array, after: Array) -> Array:
    """Return where a gripper would be that had moved along with an object, ``(n, 4)``.

    Of what was held from s on, it is where the gripper let go of it, wherever it has gone since.
    """
    turn = wrap_angle(after[:, 3] - before[:, 3])
    cosine, sine = np.cos(turn), np.sin(turn)
    x, y, z = (gripper - before)[:, :3].T
    turned = np.column_stack((cosine * x - sine * y, sine * x + cosine * y, z))
    return np.column_stack((after[:, :3] + turned, gripper[:, 3] + turn))


def _along(before: Array, after: Array) -> Array:
    """Return where an object started, turned the way that it moved, ``(n, 4)``."""
    x, y = (after - before)[:, :2].T
    yaw = np.where(np.hypot(x, y) > MOVED, np.arctan2(y, x), 0.0)
    return np.column_stack((before[:, :3], yaw))
