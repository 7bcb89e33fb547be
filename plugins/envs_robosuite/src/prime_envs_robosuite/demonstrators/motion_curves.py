"""The curves that a teleoperated gripper moves along, and how fast it goes on them."""

import numpy as np
from numpy.typing import NDArray

from prime_core.contracts.environment import CONTROL_FREQUENCY
from prime_envs_robosuite.demonstrators.styles import MotionStyle

Array = NDArray[np.float64]

STEEPNESS = 0.4  # how far above an arch's height a curve aims as it rises, as a share of the rise
PIECES = 50  # that the length of a curve is measured by
PEAK_SPEED = 0.24  # [m/s]; the command saturates at 0.05 m, which is 0.265 m/s
REACTION = 0.2  # the part of a movement's duration that does not depend on its length [s]


def bent(start: Array, goal: Array, bow: float, generator: np.random.Generator) -> Array:
    """Return the control points ``(4, 3)`` of a curve bent to a side and upwards.

    Args:
        start: [m], ``(3,)``.
        goal: [m], ``(3,)``.
        bow: Standard deviation of the bend, as a share of the distance.
        generator: Draws the bend.
    """
    way = goal - start
    aside = np.array([-way[1], way[0], 0.0])
    aside /= max(float(np.linalg.norm(aside)), 1e-6)
    bends = generator.normal(0.0, bow * float(np.linalg.norm(way)), (2, 2))
    points = np.stack((start, start + way / 3, start + 2 * way / 3, goal))
    points[1:3] += bends[:, :1] * aside
    # Upwards only: below the straight line are the walls of the bins.
    points[1:3, 2] += np.abs(bends[:, 1])
    return points


def progress_of(
    distance: float,
    turn: float,
    hesitate: bool,
    style: MotionStyle,
    generator: np.random.Generator,
) -> Array:
    """Return how much of a movement is done after each step, from 0 to 1, ``(T + 1,)``.

    Args:
        distance: How long its path is [m].
        turn: How far it turns [rad].
        hesitate: Whether it stops for a pause.
        style: How fast it is.
        generator: Draws where it stops.
    """
    seconds = REACTION + max(distance / style.speed, abs(turn) / style.turn_speed)
    peak = distance / seconds / (1 - min(0.5, style.ramp / seconds))
    steps = round(seconds * max(1.0, peak / PEAK_SPEED) * CONTROL_FREQUENCY)
    ramp = style.ramp * CONTROL_FREQUENCY
    if not hesitate:
        return smooth_rise(steps, ramp)
    share = float(generator.uniform(0.3, 0.7))
    rest = np.full(round(2 * style.pause * CONTROL_FREQUENCY), share)
    before = share * smooth_rise(max(2, round(share * steps)), ramp)
    after = share + (1 - share) * smooth_rise(max(2, round((1 - share) * steps)), ramp)
    return np.concatenate((before, rest, after[1:]))


def smooth_rise(steps: int, ramp: float) -> Array:
    """Return a rise from 0 to 1 that speeds up, cruises and slows down.

    Args:
        steps: How many it takes.
        ramp: Steps in which it speeds up; as many for slowing down.

    Returns:
        ``(steps + 1,)``.
    """
    time = (np.arange(steps) + 0.5) / steps
    share = np.minimum(1.0, np.minimum(time, 1 - time) / min(0.5, ramp / steps))
    # Minimum-jerk ramps of the speed: a hand's has no corners.
    speed = share**3 * (10 - 15 * share + 6 * share**2)
    return np.append(0.0, np.cumsum(speed) / speed.sum())


def arched(path: Array, height: float) -> Array:
    """Bend a curve up to about a height, as when something is lifted and carried in one movement.

    Args:
        path: Control points [m], ``(4, 3)``.
        height: Of the arch [m].

    Returns:
        Control points ``(4, 3)``; the curve rises and falls straight at its ends.
    """
    arch = path.copy()
    arch[1:3, :2] = path[[0, 3], :2]
    arch[1, 2] = max(path[1, 2], height + STEEPNESS * (height - path[0, 2]))
    arch[2, 2] = max(path[2, 2], height)
    return arch


def length(path: Array) -> float:
    """Return the length [m] of a curve with control points ``(4, 3)``."""
    return float(_lengths(path)[-1])


def evenly(path: Array, shares: Array) -> Array:
    """Return the parameters ``(T,)`` of a curve at shares of its length ``(T,)``."""
    lengths = _lengths(path)
    return np.asarray(np.interp(shares * lengths[-1], lengths, np.linspace(0, 1, PIECES + 1)))


def _lengths(path: Array) -> Array:
    """Return how long a curve is up to each of its points [m], ``(PIECES + 1,)``."""
    points = bezier(path, np.linspace(0.0, 1.0, PIECES + 1))
    pieces = np.linalg.norm(np.diff(points, axis=0), axis=1)
    return np.append(0.0, np.cumsum(pieces))


def bezier(points: Array, progress: Array) -> Array:
    """Return points of a cubic Bezier curve.

    Args:
        points: Control points, ``(4, 3)``.
        progress: Curve parameters from 0 to 1, ``(T,)``.

    Returns:
        ``(T, 3)``.
    """
    along, left = progress[:, None], 1 - progress[:, None]
    weights = (left**3, 3 * left**2 * along, 3 * left * along**2, along**3)
    return sum((weight * point for weight, point in zip(weights, points, strict=True)), np.zeros(3))
