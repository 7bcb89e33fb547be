"""Numbers from elsewhere in our units: metres, radians, quaternions w first, the world's frame."""

import numpy as np
from numpy.typing import NDArray

from prime_core.arrays import Array, Flags
from prime_core.contracts.environment import ACTION_LIMIT
from prime_core.datasets.columns.settings import (
    OpeningConfig,
    Orientation,
    OrientationConfig,
    OriginConfig,
)
from prime_core.rotations import (
    gripper_down,
    quaternion_product,
    rotation_matrix,
    wrap_angle,
    yaw_of,
)

METRES = {"m": 1.0, "cm": 0.01, "mm": 0.001}
RADIANS = {"rad": 1.0, "deg": np.pi / 180.0}

WIDTHS: dict[Orientation, int] = {"wxyz": 4, "xyzw": 4, "rpy": 3, "rotation-vector": 3, "yaw": 1}
"""How many numbers an orientation is."""

NEAR = 0.08  # metres from the gripper to the centre of what it holds: half of a carton is 6 cm
LEAST_HELD = 0.002  # metres between the fingers that hold something
MOVED = 0.005  # metres that the fingers have closed by to hold something
COMMANDED = 0.0005  # metres by which the fingers move in a step that they are told to


def quaternions(values: Array, config: OrientationConfig, *, down: bool) -> Array:
    """Return unit quaternions, w first, ``(N, 4)``.

    Args:
        values: As they were recorded, ``(N, width)``.
        config: How.
        down: Whether a yaw alone is that of a gripper that points down, or of a thing that stands.
    """
    scale = RADIANS[config.unit]
    if config.format == "wxyz":
        found = np.asarray(values, dtype=np.float64)
    elif config.format == "xyzw":
        found = np.asarray(values[:, [3, 0, 1, 2]], dtype=np.float64)
    elif config.format == "rpy":
        roll, pitch, yaw = (_about(axis, scale * values[:, axis]) for axis in range(3))
        found = quaternion_product(yaw, quaternion_product(pitch, roll))
    elif config.format == "rotation-vector":
        found = _of_vectors(scale * values)
    else:
        yaw = scale * values[:, 0]
        found = gripper_down(yaw) if down else _about(2, yaw)
    if config.turned:
        found = quaternion_product(found, _about(2, np.array(scale * config.turned)))
    return found


def openings(values: Array, config: OpeningConfig) -> Array:
    """Return the distance between the fingers [m], ``(N,)``.

    Args:
        values: As they were recorded, of one number or of two fingers, ``(N, 1 or 2)``.
        config: How.
    """
    if config.closed is None or config.open is None or config.width is None:
        # Of two fingers one may move along a negative axis.
        return METRES[config.unit] * (
            np.abs(values).sum(axis=1) if values.shape[1] > 1 else values[:, 0]
        )
    shares = (values - config.closed) / (config.open - config.closed)
    return np.asarray(config.width * shares.mean(axis=1))


def moved(positions: Array, orientations: Array, origin: OriginConfig) -> tuple[Array, Array]:
    """Return poses ``(N, 3)`` and ``(N, 4)`` in the world's frame.

    Args:
        positions: In the frame that they were recorded in.
        orientations: In the same.
        origin: Where that frame is.
    """
    turn = _about(2, np.array(origin.yaw))
    places = positions @ rotation_matrix(turn).T + np.array(origin.position)
    return places, quaternion_product(turn, orientations)


def at_tip(positions: Array, orientations: Array, tip: tuple[float, float, float]) -> Array:
    """Return where a point of the gripper is, given in the gripper's frame, ``(N, 3)``."""
    return np.asarray(positions + rotation_matrix(orientations) @ np.array(tip))


def told_held(gripper: Array, opening: Array, things: Array) -> Flags:
    """Tell whether an object is held, ``(N,)``: it is near, and something keeps the fingers apart.

    Args:
        gripper: Positions, ``(N, 3)``.
        opening: Of the fingers, ``(N,)``.
        things: Positions of the object, ``(N, 3)``.
    """
    near = np.linalg.norm(gripper - things, axis=1) < NEAR
    return np.asarray(near & (opening > LEAST_HELD) & (opening < opening.max() - MOVED))


def told_actions(gripper: Array, orientations: Array, opening: Array) -> NDArray[np.float32]:
    """Tell motor actions from what they led to, ``(N, 5)``; the last is a hold.

    Args:
        gripper: Positions, ``(N, 3)``.
        orientations: Of the gripper, ``(N, 4)``.
        opening: Of the fingers, ``(N,)``.
    """
    actions = np.zeros((len(gripper), len(ACTION_LIMIT)))
    actions[:-1, :3] = np.diff(gripper, axis=0)
    actions[:-1, 3] = wrap_angle(np.diff(yaw_of(orientations)))
    command = -1.0 if opening[0] > opening.max() / 2 else 1.0
    for step, change in enumerate(np.diff(opening)):
        if abs(change) > COMMANDED:
            command = -float(np.sign(change))
        actions[step, 4] = command
    actions[-1, 4] = command
    return np.clip(actions, -ACTION_LIMIT, ACTION_LIMIT).astype(np.float32)


def _about(axis: int, angle: Array) -> Array:
    """Return the quaternions of turns about an axis, ``(..., 4)``."""
    result = np.zeros((*angle.shape, 4))
    result[..., 0], result[..., 1 + axis] = np.cos(angle / 2), np.sin(angle / 2)
    return result


def _of_vectors(vectors: Array) -> Array:
    """Return the quaternions of rotation vectors ``(N, 3)``."""
    angles = np.linalg.norm(vectors, axis=1, keepdims=True)
    # sin(angle / 2) / angle, which is 1/2 at 0.
    return np.hstack((np.cos(angles / 2), vectors * np.sinc(angles / (2 * np.pi)) / 2))
