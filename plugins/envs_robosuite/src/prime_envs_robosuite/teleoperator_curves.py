"""The curves that a hand moves along, and how fast it goes on them."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

STEEPNESS = 0.4  # how far above an arch's height a hand aims as it rises, as a share of the rise
PIECES = 50  # that the length of a curve is measured by


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
    # Minimum-jerk ramps of the speed: people have no corners in theirs.
    speed = share**3 * (10 - 15 * share + 6 * share**2)
    return np.append(0.0, np.cumsum(speed) / speed.sum())


def arched(path: Array, height: float) -> Array:
    """Bend a curve up to about a height, as one who lifts and carries in one movement.

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
