"""Statistics of success rates."""

import math
from collections.abc import Sequence


def wilson_interval(successes: int, trials: int) -> tuple[float, float]:
    """Return the 95 % interval of a success rate (Wilson, 1927).

    Args:
        successes: Trials that succeeded.
        trials: All trials, at least 1.

    Returns:
        Least and greatest rate; unlike the normal interval, within 0 and 1.
    """
    z = 1.959963984540054
    rate = successes / trials
    scale = 1 + z * z / trials
    middle = (rate + z * z / (2 * trials)) / scale
    half = z / scale * math.sqrt(rate * (1 - rate) / trials + z * z / (4 * trials * trials))
    return max(0.0, middle - half), min(1.0, middle + half)


def mean_of_best(rates: Sequence[float], count: int) -> float:
    """Return the mean of the ``count`` highest rates (paper: the top 5 checkpoints)."""
    best = sorted(rates, reverse=True)[:count]
    return sum(best) / len(best)
