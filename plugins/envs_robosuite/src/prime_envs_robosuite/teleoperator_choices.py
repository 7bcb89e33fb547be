"""Where a simulated person chooses to take an object, and where to put it."""

from collections.abc import Sequence
from itertools import combinations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from prime_core.contracts.description import Affordance
from prime_core.contracts.scene import Scene
from prime_core.rotations import wrap_angle, yaw_of
from prime_envs_robosuite.jobs import Bounds, Job, PutInto, PutOnto, Reach, Taking

Array = NDArray[np.float64]

HAND_HALF_SIZE = np.array([0.034, 0.106])  # of the Panda's hand along the gripper's x and y [m]
HAND_BOTTOM = 0.02  # above the point between the fingertips [m]
FINGERS_HALF_SIZE = np.array([0.012, 0.055])  # of both opened fingers, likewise [m]
MARGIN = 0.005  # that people leave beside what is around [m]
APART = 0.1  # between the centres of things of which either can be taken first [m]
SPOTS = 1000  # that are looked at for one where the hand has room
GREATEST_YAW = 1.4  # of the gripper [rad]; the arm's last joint ends beyond a quarter turn
ANY_YAWS = np.linspace(-GREATEST_YAW, GREATEST_YAW, 57)  # 3 degrees apart [rad]


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
    roomy = reachable[_has_room(scene, job, position, reachable)]
    if not len(roomy) and job.any_yaw:
        away = np.abs(wrap_angle(ANY_YAWS[:, None] - turns, period=np.pi)).min(axis=1)
        others = ANY_YAWS[np.argsort(away)]
        roomy = others[_has_room(scene, job, position, others)][:1]
    reachable = roomy if len(roomy) else reachable
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


def _has_room(scene: Scene, job: Taking, position: Array, yaws: Array) -> NDArray[np.bool_]:
    """Tell at which yaws [rad] ``(N,)`` the hand has room to take an object ``(N,)``.

    Args:
        scene: The scene now.
        job: Says what is around.
        position: Of the gripper [m], ``(3,)``.
        yaws: Of the gripper.
    """
    spot, height = position[:2], float(position[2])
    roomy = np.ones(len(yaws), dtype=np.bool_)
    if job.taken_from is not None:
        roomy &= _hand_fits(spot, height, yaws, job.taken_from)
    for block in job.beside:
        low, high = np.array(block.low), np.array(block.high)
        half = (high - low) / 2 + MARGIN
        roomy &= _clears(position, yaws, (low + high) / 2, half, 0.0, block.top)
    for item in job.neighbours:
        index = scene.object_index(item.object_name)
        centre, half = scene.object_positions[index], np.array(item.half_size)
        yaw = float(yaw_of(scene.object_quaternions[index]))
        top = float(centre[2] + half[2])
        roomy &= _clears(position, yaws, centre[:2], half[:2] + MARGIN, yaw, top)
    return roomy


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
