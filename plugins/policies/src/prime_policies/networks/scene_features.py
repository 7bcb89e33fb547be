"""Numbers that networks learn from: the features of a scene, by rule, for any objects.

What looks the same has the same features: a parallel-jaw gripper turned by half a turn, and an
object turned by one of the angles that its symmetry declares.
"""

from dataclasses import dataclass
from math import lcm

import numpy as np
from numpy.typing import NDArray

from prime_core.contracts.description import ObjectDescription, SceneDescription
from prime_core.contracts.observations import OBJECT_WIDTH, Observations
from prime_core.rotations import wrap_angle, yaw_of

Array = NDArray[np.float64]

GRIPPER_SYMMETRY = 2  # parallel jaws look the same after half a turn
BLOCK = 65536  # frames encoded at a time, which bounds the memory


@dataclass(frozen=True)
class ObjectFeatures:
    """The numbers of some features of an object.

    Attributes:
        position: Of x, y and z [m].
        turn: Of the turn that brings the gripper in line with it [rad]; None for a round one.
        held: Of whether it is held.
    """

    position: tuple[int, int, int]
    turn: int | None
    held: int


class FeatureEncoder:
    """Turns frames into features.

    Of the gripper: position [m], opening [m], sine and cosine of twice its yaw, and the yaw
    itself in ``[-pi/2, pi/2)`` [rad].

    Of each object: position [m], position less the gripper's [m], direction of its z axis;
    direction squared (as a complex number) of the z axis's shadow on the ground, seen from the
    gripper, which says how a fallen object lies; whether it is held. Of each object that is not
    round also its yaw, and its yaw less the gripper's, as sine and cosine of the angle times the
    symmetry, and the turn that brings the gripper in line with it [rad].

    An object's yaw is its twist about its own z axis once the tilt is undone the short way. It
    equals the yaw of an upright object, is defined for one that lies on its side, and keeps the
    symmetry in every pose. It is undefined upside down only: features of the yaw are therefore
    scaled by (1 + z) / 2, with z the vertical part of the z axis, which is 1 upright and 0
    there.

    Args:
        description: Of the scenes that the frames show.

    Attributes:
        names: A name for each feature.
        gripper_yaw: The number of the gripper's yaw [rad] among the features.
        objects: Where the features of each object are.
    """

    def __init__(self, description: SceneDescription) -> None:
        self._objects = description.objects
        self.names = _gripper_names()
        self.gripper_yaw = len(self.names) - 1
        self.objects: list[ObjectFeatures] = []
        for item in description.objects:
            names, first = _object_names(item), len(self.names)
            turn = first + names.index(f"{item.name}.relative_yaw") if item.yaw_symmetry else None
            position = (first, first + 1, first + 2)
            self.objects.append(ObjectFeatures(position, turn, first + len(names) - 1))
            self.names += names

    @property
    def width(self) -> int:
        """Number of features of a frame."""
        return len(self.names)

    def encode(self, seen: Observations) -> NDArray[np.float32]:
        """Return the features of each frame, ``(N, width)`` float32."""
        features = np.empty((len(seen), self.width), dtype=np.float32)
        for start in range(0, len(seen), BLOCK):
            block = slice(start, start + BLOCK)
            features[block] = self._encode_block(seen[block])
        return features

    def _encode_block(self, seen: Observations) -> Array:
        state = seen.state.astype(np.float64)
        objects = seen.environment_state.astype(np.float64)
        objects = objects.reshape(len(seen), len(self._objects), OBJECT_WIDTH)
        position, yaw = state[:, :3], gripper_yaw(seen)
        parts = [position, state[:, 7:8], _sine_and_cosine(np.exp(2j * yaw))]
        parts.append(wrap_angle(yaw, np.pi)[:, None])
        for index, item in enumerate(self._objects):
            parts += _object_features(item, objects[:, index], position, yaw)
        return np.concatenate(parts, axis=1)


def gripper_yaw(seen: Observations) -> Array:
    """Return the gripper's yaw in each frame [rad], ``(N,)``, in ``[-pi, pi)``."""
    return yaw_of(seen.state[:, 3:7])


def _object_features(
    item: ObjectDescription, state: Array, gripper_position: Array, yaw: Array
) -> list[Array]:
    """Return the features of one object.

    Args:
        item: The object.
        state: Its part of the environment state, ``(N, 8)``.
        gripper_position: ``(N, 3)``.
        yaw: Of the gripper, ``(N,)``.
    """
    w, x, y, z = state[:, 3:7].T
    up = np.stack((2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)), axis=1)
    lying = (up[:, 0] + 1j * up[:, 1]) ** 2 * np.exp(-2j * yaw)
    parts = [state[:, :3], state[:, :3] - gripper_position, up, _sine_and_cosine(lying)]
    if item.yaw_symmetry:
        parts += _yaw_features(item.yaw_symmetry, np.arctan2(z, w) * 2, w * w + z * z, yaw)
    return [*parts, state[:, 7:8]]


def _yaw_features(symmetry: int, twist: Array, weight: Array, yaw: Array) -> list[Array]:
    """Return what an object's yaw ``twist`` says, alone and relative to the gripper's."""
    # Turning the gripper by half a turn must not matter either.
    shared = lcm(symmetry, GRIPPER_SYMMETRY)
    return [
        _sine_and_cosine(weight * np.exp(1j * symmetry * twist)),
        _sine_and_cosine(weight * np.exp(1j * shared * (twist - yaw))),
        (weight * wrap_angle(twist - yaw, 2 * np.pi / shared))[:, None],
    ]


def _sine_and_cosine(value: NDArray[np.complex128]) -> Array:
    return np.stack((value.imag, value.real), axis=1)


def _gripper_names() -> list[str]:
    names = ["gripper.x", "gripper.y", "gripper.z", "gripper.opening"]
    return [*names, "gripper.yaw_sin", "gripper.yaw_cos", "gripper.yaw"]


def _object_names(item: ObjectDescription) -> list[str]:
    parts = ["x", "y", "z", "relative_x", "relative_y", "relative_z", "up_x", "up_y", "up_z"]
    parts += ["lying_sin", "lying_cos"]
    if item.yaw_symmetry:
        parts += ["yaw_sin", "yaw_cos", "relative_yaw_sin", "relative_yaw_cos", "relative_yaw"]
    return [f"{item.name}.{part}" for part in [*parts, "held"]]
