"""Whether the Panda's hand has room between walls and beside objects."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from prime_core.contracts.scene import Scene
from prime_core.rotations import yaw_of
from prime_envs_robosuite.tasks.subtasks import Bounds, Picking

Array = NDArray[np.float64]

HAND_HALF_SIZE = np.array([0.034, 0.106])  # of the Panda's hand along the gripper's x and y [m]
HAND_BOTTOM = 0.02  # above the point between the fingertips [m]
FINGERS_HALF_SIZE = np.array([0.012, 0.055])  # of both opened fingers, likewise [m]
MARGIN = 0.005  # that is left beside what is around [m]
GREATEST_YAW = 1.4  # of the gripper [rad]; the arm's last joint ends beyond a quarter turn


def has_room(scene: Scene, subtask: Picking, position: Array, yaws: Array) -> NDArray[np.bool_]:
    """Tell at which yaws [rad] ``(N,)`` the hand has room to take an object ``(N,)``.

    Args:
        scene: The scene now.
        subtask: Says what is around.
        position: Of the gripper [m], ``(3,)``.
        yaws: Of the gripper.
    """
    spot, height = position[:2], float(position[2])
    roomy = np.ones(len(yaws), dtype=np.bool_)
    if subtask.taken_from is not None:
        roomy &= hand_fits(spot, height, yaws, subtask.taken_from)
    for block in subtask.beside:
        low, high = np.array(block.low), np.array(block.high)
        half = (high - low) / 2 + MARGIN
        roomy &= _clears(position, yaws, (low + high) / 2, half, 0.0, block.top)
    for item in subtask.neighbours:
        index = scene.object_index(item.object_name)
        centre, half = scene.object_positions[index], np.array(item.half_size)
        yaw = float(yaw_of(scene.object_quaternions[index]))
        top = float(centre[2] + half[2])
        roomy &= _clears(position, yaws, centre[:2], half[:2] + MARGIN, yaw, top)
    return roomy


def hand_fits(spots: ArrayLike, height: float, yaws: ArrayLike, room: Bounds) -> NDArray[np.bool_]:
    """Tell where the hand has room between walls.

    Args:
        spots: Of the gripper in the plane [m], ``(N, 2)`` or ``(2,)``.
        height: Of the gripper [m].
        yaws: Of the gripper [rad], ``(N,)``.
        room: Within the walls.

    Returns:
        ``(N,)``.
    """
    half = _hand_extent(yaws)
    inside = (spots - half > np.array(room.low)) & (spots + half < np.array(room.high))
    return np.asarray(np.all(inside, axis=-1) | (height + HAND_BOTTOM > room.top))


def _clears(
    position: Array, yaws: Array, centre: Array, half: Array, yaw: float, top: float
) -> NDArray[np.bool_]:
    """Tell where hand and fingers are beside a block or above it, ``(N,)``.

    Args:
        position: Of the gripper [m], ``(3,)``.
        yaws: Of the gripper [rad], ``(N,)``.
        centre: Of the block in the plane [m], ``(2,)``.
        half: Half of the block's extent along its own axes [m], ``(2,)``.
        yaw: Of the block [rad].
        top: Height of the block's upper edge [m].
    """
    away = centre - position[:2]
    fingers = _are_apart(away, FINGERS_HALF_SIZE, yaws, half, yaw)
    if position[2] + HAND_BOTTOM > top:
        return fingers
    return fingers & _are_apart(away, HAND_HALF_SIZE, yaws, half, yaw)


def _are_apart(
    away: Array, half: Array, yaws: Array, other_half: Array, other_yaw: float
) -> NDArray[np.bool_]:
    """Tell where two rectangles do not overlap ``(N,)``: a side of one has all of the other beyond.

    Args:
        away: From the centre of the first to that of the other [m], ``(2,)``.
        half: Half of the extent of the first along its own axes [m], ``(2,)``.
        yaws: Of the first [rad], ``(N,)``.
        other_half: Half of the extent of the other [m], ``(2,)``.
        other_yaw: Of the other [rad].
    """
    sine, cosine = np.abs(np.sin(yaws - other_yaw)), np.abs(np.cos(yaws - other_yaw))
    swap = np.stack((np.stack((cosine, sine), -1), np.stack((sine, cosine), -1)), -2)
    beyond = np.abs(_along(away, yaws)) > half + swap @ other_half
    beyond |= np.abs(_along(away, np.full_like(yaws, other_yaw))) > other_half + swap @ half
    return np.asarray(beyond.any(axis=-1))


def _along(point: Array, yaws: Array) -> Array:
    """Return a point ``(2,)`` along axes turned by each yaw ``(N,)`` [rad], ``(N, 2)``."""
    cosine, sine = np.cos(yaws), np.sin(yaws)
    along = cosine * point[0] + sine * point[1]
    return np.stack((along, cosine * point[1] - sine * point[0]), axis=-1)


def _hand_extent(yaws: ArrayLike) -> Array:
    """Return half of the hand's extent along x and y at yaws ``(N,)`` [m], ``(N, 2)``."""
    cosine, sine = np.abs(np.cos(yaws)), np.abs(np.sin(yaws))
    mixed = np.stack((np.stack((cosine, sine), -1), np.stack((sine, cosine), -1)), -2)
    return np.asarray(mixed @ HAND_HALF_SIZE)


def turned_about_z(point: Array, yaw: float) -> Array:
    """Return a point [m] ``(3,)`` turned about z by an angle [rad]."""
    cosine, sine = np.cos(yaw), np.sin(yaw)
    turn = np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])
    return np.asarray(turn @ point)
