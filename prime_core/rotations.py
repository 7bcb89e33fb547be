"""Angles and quaternions of grippers that point down.

Quaternions are w-x-y-z and map the body frame to the world frame; angles are radians.
Every function takes stacks: the leading dimensions are kept.
"""

import numpy as np
from numpy.typing import ArrayLike

from prime_core.arrays import Array


def wrap_angle(angle: ArrayLike, period: float = 2 * np.pi) -> Array:
    """Return the angle of the same direction that is nearest to zero.

    Args:
        angle: Angles [rad], any shape.
        period: What the angle repeats after [rad]; a parallel-jaw gripper's yaw repeats
            after pi.

    Returns:
        Angles in ``[-period / 2, period / 2)``, same shape.
    """
    value = np.asarray(angle, dtype=np.float64)
    return (value + period / 2) % period - period / 2


def quaternion_product(left: ArrayLike, right: ArrayLike) -> Array:
    """Multiply quaternions.

    Args:
        left: ``(..., 4)``.
        right: ``(..., 4)``, applied first.

    Returns:
        ``(..., 4)``.
    """
    aw, ax, ay, az = _parts(left)
    bw, bx, by, bz = _parts(right)
    return np.stack(
        (
            aw * bw - ax * bx - ay * by - az * bz,
            aw * bx + ax * bw + ay * bz - az * by,
            aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw,
        ),
        axis=-1,
    )


def rotation_matrix(quaternion: ArrayLike) -> Array:
    """Return the rotation matrices of unit quaternions.

    Args:
        quaternion: ``(..., 4)``.

    Returns:
        ``(..., 3, 3)``; column ``i`` is the body's axis ``i`` in the world frame.
    """
    w, x, y, z = _parts(quaternion)
    rows = (
        (1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
        (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
        (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
    )
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def yaw_of(quaternion: ArrayLike) -> Array:
    """Return the yaw of bodies: the direction of their x axis in the world's x-y plane.

    Args:
        quaternion: ``(..., 4)``.

    Returns:
        Yaw [rad], ``(...)``, in ``[-pi, pi)``.
    """
    w, x, y, z = _parts(quaternion)
    return np.asarray(np.arctan2(2 * (x * y + w * z), 1 - 2 * (y * y + z * z)))


def gripper_down(yaw: ArrayLike) -> Array:
    """Return the orientation of a gripper that points straight down.

    Args:
        yaw: Direction of the gripper's x axis in the world's x-y plane [rad], ``(...)``.

    Returns:
        ``(..., 4)``: a half turn about x, then the yaw about z.
    """
    half = np.asarray(yaw, dtype=np.float64) / 2
    result = np.zeros((*half.shape, 4))
    result[..., 1], result[..., 2] = np.cos(half), np.sin(half)
    return result


def _parts(quaternion: ArrayLike) -> tuple[Array, Array, Array, Array]:
    """Return the four numbers of quaternions; asked in every step, so without moving axes."""
    values = np.asarray(quaternion, dtype=np.float64)
    return values[..., 0], values[..., 1], values[..., 2], values[..., 3]
