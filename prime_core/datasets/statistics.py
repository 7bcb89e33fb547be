"""The statistics that LeRobot keeps of each feature, per episode and over all."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from prime_core.arrays import Floats

Statistics = dict[str, Floats]
"""``min``, ``max``, ``mean``, ``std``, ``q01`` ...: ``(width,)`` each, and ``count``: ``(1,)``."""


QUANTILES = {"q01": 0.01, "q10": 0.10, "q50": 0.50, "q90": 0.90, "q99": 0.99}


def statistics_of(values: NDArray[Any]) -> Statistics:
    """Return the statistics of one feature in one episode.

    Args:
        values: ``(N,)`` or ``(N, width)``, ``N`` at least 1.
    """
    table = np.ascontiguousarray(values.reshape(len(values), -1).T, dtype=np.float64)
    table.sort(axis=1)
    result = {
        "min": table[:, 0],
        "max": table[:, -1],
        "mean": table.mean(axis=1),
        "std": table.std(axis=1),
        "count": np.array([len(values)], dtype=np.float64),
    }
    # np.quantile would sort once more for each share.
    for name, share in QUANTILES.items():
        position = share * (len(values) - 1)
        below = int(position)
        above = min(below + 1, len(values) - 1)
        weight = position - below
        result[name] = (1 - weight) * table[:, below] + weight * table[:, above]
    return result


def merge(statistics: Sequence[Mapping[str, Floats]]) -> Statistics:
    """Return the statistics over episodes from those of each.

    Quantiles are averaged over the frames, as LeRobot does when a data set grows; the others
    are exact.
    """
    columns = {name: np.stack([item[name] for item in statistics]) for name in statistics[0]}
    counts = columns["count"]
    total = counts.sum(axis=0)
    mean = (columns["mean"] * counts).sum(axis=0) / total
    spread = columns["std"] ** 2 + (columns["mean"] - mean) ** 2
    result = {
        "min": columns["min"].min(axis=0),
        "max": columns["max"].max(axis=0),
        "mean": mean,
        "std": np.sqrt((spread * counts).sum(axis=0) / total),
        "count": total,
    }
    for name in QUANTILES:
        result[name] = (columns[name] * counts).sum(axis=0) / total
    return result


def plain(statistics: Mapping[str, Floats]) -> dict[str, list[float] | list[int]]:
    """Return statistics as lists, the count as a whole number, as LeRobot stores them."""
    return {
        name: [int(values[0])] if name == "count" else values.tolist()
        for name, values in statistics.items()
    }
