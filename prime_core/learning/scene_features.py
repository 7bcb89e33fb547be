"""Numbers that networks learn from: the features of a scene, by rule, for any objects.

What looks the same has the same features: a parallel-jaw gripper turned by half a turn, and an
object turned by one of the angles that its symmetry declares.
"""

from math import lcm
from typing import Any

import numpy as np
from numpy.typing import NDArray

from prime_core.arrays import Array
from prime_core.contracts.description import SceneDescription
from prime_core.contracts.observations import Observations
from prime_core.rotations import wrap_angle

JAW_SYMMETRY = 2  # parallel jaws look the same after half a turn
BLOCK = 65536  # frames encoded at a time, which bounds the memory


class FeatureEncoder:
    """Turns frames into features.

    Of the gripper: position [m], opening [m], sine and cosine of twice its yaw, and the yaw
    itself in ``[-pi/2, pi/2)`` [rad].

    Of each object: position [m], position less the gripper's [m], direction of its z axis;
    direction squared (as a complex number) of the z axis's shadow on the ground, seen from the
    gripper, which says how a fallen object lies. Of each object that is not round also its yaw, and
    its yaw less the gripper's, as sine and cosine of the angle times the symmetry, and the turn
    that brings the gripper in line with it [rad]. Then whether it is held.

    An object's yaw is its twist about its own z axis once the tilt is undone the short way. It
    equals the yaw of an upright object, is defined for one that lies on its side, and keeps the
    symmetry in every pose. It is undefined upside down only: features of the yaw are therefore
    scaled by (1 + z) / 2, with z the vertical part of the z axis, which is 1 upright and 0
    there.

    Args:
        description: Of the scenes that the frames show.

    Attributes:
        width: Number of features of a frame.
    """

    def __init__(self, description: SceneDescription) -> None:
        self._symmetries = [item.yaw_symmetry for item in description.objects]
        # Of the gripper, then of each object, which has five of its yaw unless it is round.
        self.width = 7 + sum(12 + 5 * (symmetry > 0) for symmetry in self._symmetries)

    def encode(self, seen: Observations) -> NDArray[np.float32]:
        """Return the features of each frame, ``(N, width)`` float32."""
        features = np.empty((len(seen), self.width), dtype=np.float32)
        for start in range(0, len(seen), BLOCK):
            block = slice(start, start + BLOCK)
            features[block] = self._encode_block(seen[block])
        return features

    def _encode_block(self, seen: Observations) -> Array:
        gripper, yaw = seen.gripper_position.astype(np.float64), seen.gripper_yaw
        parts: list[NDArray[Any]] = [
            gripper,
            seen.gripper_opening[:, None],
            _sine_and_cosine(np.exp(2j * yaw)),
            wrap_angle(yaw, np.pi)[:, None],
        ]
        for index, symmetry in enumerate(self._symmetries):
            position = seen.object_positions[:, index].astype(np.float64)
            w, x, y, z = seen.object_quaternions[:, index].astype(np.float64).T
            up = (2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y))
            lying = (up[0] + 1j * up[1]) ** 2 * np.exp(-2j * yaw)
            parts += [position, position - gripper, np.stack(up, axis=1), _sine_and_cosine(lying)]
            if symmetry:
                parts += _yaw_features(symmetry, np.arctan2(z, w) * 2, w * w + z * z, yaw)
            parts.append(seen.held[:, index, None])
        return np.concatenate(parts, axis=1)


def _yaw_features(symmetry: int, twist: Array, weight: Array, yaw: Array) -> list[Array]:
    """Return what an object's yaw ``twist`` says, alone and relative to the gripper's."""
    # Turning the gripper by half a turn must not matter either.
    shared = lcm(symmetry, JAW_SYMMETRY)
    return [
        _sine_and_cosine(weight * np.exp(1j * symmetry * twist)),
        _sine_and_cosine(weight * np.exp(1j * shared * (twist - yaw))),
        (weight * wrap_angle(twist - yaw, 2 * np.pi / shared))[:, None],
    ]


def _sine_and_cosine(value: NDArray[np.complex128]) -> Array:
    return np.stack((value.imag, value.real), axis=1)
