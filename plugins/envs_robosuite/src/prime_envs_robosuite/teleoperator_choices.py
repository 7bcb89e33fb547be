"""Where a simulated person chooses to take an object, and where to put it."""

from collections.abc import Sequence
from itertools import combinations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from prime_core.rotations import wrap_angle, yaw_of
from prime_core.scene import Affordance, Scene
from prime_envs_robosuite.jobs import Bounds, Job, PutInto, PutOnto, Reach, Taking

Array = NDArray[np.float64]

HAND_HALF_SIZE = np.array([0.034, 0.106])  # of the Panda's hand along the gripper's x and y [m]
HAND_BOTTOM = 0.02  # above the point between the fingertips [m]
APART = 0.1  # between the centres of things of which either can be taken first [m]
SPOTS = 1000  # that are looked at for one where the hand has room
GREATEST_YAW = 1.4  # of the gripper [rad]; the arm's last joint ends beyond a quarter turn


def choose_grasp(
    scene: Scene, job: Taking, other_yaw_share: float, draw: np.random.Generator
) -> tuple[Array, float]:
    """Choose where to take an object.

    Args:
        scene: The scene now.
        job: What is to be done with it.
        other_yaw_share: Share of grasps at another yaw than the nearest.
        draw: Where all randomness comes from.

    Returns:
        Position [m] ``(3,)`` and yaw [rad] of the gripper.
    """
    spot = _grasp_of(scene, job.object_name)
    index = scene.object_index(job.object_name)
    own_yaw = float(yaw_of(scene.object_quaternions[index]))
    offset = turned(draw.uniform(spot.low, spot.high), own_yaw) + draw.normal(0.0, 0.003, 3)
    yaws = spot.yaws if spot.yaws is not None else tuple(draw.uniform(-np.pi, np.pi, 4))
    # A half turn of the gripper swaps its fingers and changes nothing else.
    turns = wrap_angle([own_yaw + yaw for yaw in yaws], period=np.pi)
    nearest = turns[np.argsort(np.abs(turns - scene.gripper_yaw))]
    position = scene.object_positions[index] + offset
    reachable = nearest[np.abs(nearest) < GREATEST_YAW]
    spread = position[:2], float(position[2]), reachable
    roomy = np.ones(len(reachable), dtype=np.bool_)
    if job.taken_from is not None:
        roomy &= _hand_fits(*spread, job.taken_from)
    for block in job.beside:
        roomy &= _hand_clears(*spread, block)
    reachable = reachable[roomy] if roomy.any() else reachable
    reachable = reachable if len(reachable) else nearest[:1]
    other = len(reachable) > 1 and draw.random() < other_yaw_share
    return position, float(reachable[1 if other else 0] + draw.uniform(-0.1, 0.1))


def choose_spot(
    scene: Scene, job: PutInto, floor: float, draw: np.random.Generator
) -> tuple[Array, float]:
    """Choose where to put the held object: within reach, with room for the hand.

    Args:
        scene: The scene now.
        job: Where it goes.
        floor: Height of the object's centre when it lies there [m].
        draw: Where all randomness comes from.

    Returns:
        x and y [m] ``(2,)`` and yaw [rad] of the gripper.
    """
    index = scene.object_index(job.object_name)
    height = floor + float(scene.gripper_position[2] - scene.object_positions[index, 2])
    spots = draw.uniform(job.low, job.high, (SPOTS, 2))
    yaws = _yaws_nearby(scene, draw)
    good, distances = _within(spots, job.reach)
    if job.room is not None:
        good &= _hand_fits(spots, height, yaws, job.room)
    chosen = int(np.argmax(good) if good.any() else np.argmin(distances))
    return spots[chosen], float(yaws[chosen])


def choose_yaw(scene: Scene, job: PutOnto, draw: np.random.Generator) -> float:
    """Choose the gripper's yaw [rad] for bringing the held object's centre to a point.

    Args:
        scene: The scene now.
        job: Where it goes.
        draw: Where all randomness comes from.
    """
    if job.yaws is None:
        yaws = _yaws_nearby(scene, draw)
    else:
        own_yaw = yaw_of(scene.object_quaternions[scene.object_index(job.object_name)])
        turns = wrap_angle(np.array(job.yaws) - own_yaw)
        yaws = scene.gripper_yaw + turns[np.argsort(np.abs(turns))]
    point = goal_point(scene, job)
    spots = np.array([bringing(scene, job.object_name, point, float(yaw))[:2] for yaw in yaws])
    good, distances = _within(spots, job.reach)
    return float(yaws[np.argmax(good) if good.any() else np.argmin(distances)])


def are_apart(scene: Scene, jobs: Sequence[Job]) -> bool:
    """Whether a hand can take any of the things that jobs take and not touch the others."""
    names = [job.object_name for job in jobs if isinstance(job, Taking)]
    places = [scene.object_positions[scene.object_index(name), :2] for name in names]
    return all(np.linalg.norm(a - b) > APART for a, b in combinations(places, 2))


def goal_point(scene: Scene, job: PutOnto) -> Array:
    """Return where the object's centre goes [m], world frame, ``(3,)``."""
    point = np.array(job.point)
    if job.reference is None:
        return point
    return np.asarray(point + scene.object_positions[scene.object_index(job.reference)])


def bringing(scene: Scene, name: str, point: Array, yaw: float) -> Array:
    """Return where the gripper goes for the centre of what it holds to come to a point.

    Args:
        scene: The scene now.
        name: Of what it holds.
        point: Where its centre goes [m], world frame, ``(3,)``.
        yaw: That the gripper will have then [rad].

    Returns:
        Position [m], world frame, ``(3,)``.
    """
    away = scene.gripper_position - scene.object_positions[scene.object_index(name)]
    return np.asarray(point + turned(away, yaw - scene.gripper_yaw))


def turned(point: Array, yaw: float) -> Array:
    """Return a point [m] ``(3,)`` turned about z by an angle [rad]."""
    cosine, sine = np.cos(yaw), np.sin(yaw)
    turn = np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])
    return np.asarray(turn @ point)


def _grasp_of(scene: Scene, name: str) -> Affordance:
    """Return where an object can be taken."""
    spots = scene.description.affordances_for("grasp")
    return next(spot for spot in spots if spot.reference == name)


def _yaws_nearby(scene: Scene, draw: np.random.Generator) -> Array:
    """Return yaws [rad] about the gripper's own, ever farther from it, ``(SPOTS,)``."""
    turns = draw.uniform(-0.6, 0.6, SPOTS) * np.linspace(1.0, 2.5, SPOTS)
    return np.asarray(np.clip(scene.gripper_yaw + turns, -GREATEST_YAW, GREATEST_YAW))


def _within(spots: Array, reach: Reach) -> tuple[NDArray[np.bool_], Array]:
    """Tell which spots ``(N, 2)`` are within reach ``(N,)``, and their distances [m] ``(N,)``."""
    distances = np.linalg.norm(spots - np.array(reach.base), axis=1)
    return distances < reach.distance, distances


def _hand_fits(spots: ArrayLike, height: float, yaws: ArrayLike, room: Bounds) -> NDArray[np.bool_]:
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


def _hand_clears(
    spots: ArrayLike, height: float, yaws: ArrayLike, block: Bounds
) -> NDArray[np.bool_]:
    """Tell where the hand is beside a block or above it ``(N,)``; see `_hand_fits`."""
    half = _hand_extent(yaws)
    beside = (spots + half < np.array(block.low)) | (spots - half > np.array(block.high))
    return np.asarray(np.any(beside, axis=-1) | (height + HAND_BOTTOM > block.top))


def _hand_extent(yaws: ArrayLike) -> Array:
    """Return half of the hand's extent along x and y at yaws ``(N,)`` [m], ``(N, 2)``."""
    cosine, sine = np.abs(np.cos(yaws)), np.abs(np.sin(yaws))
    mixed = np.stack((np.stack((cosine, sine), -1), np.stack((sine, cosine), -1)), -2)
    return np.asarray(mixed @ HAND_HALF_SIZE)
