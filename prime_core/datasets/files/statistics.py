"""The statistics that LeRobot keeps of each feature, per episode and over all."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from prime_core.arrays import Floats, Indices

Statistics = dict[str, Floats]
"""``min``, ``max``, ``mean``, ``std``, ``q01`` ...: ``(width,)`` each, ``(3, 1, 1)`` of images; and
``count``: ``(1,)``."""


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


class PixelCounts:
    """How many pixels of an episode's images have each value; LeRobot looks at some images only.

    Args:
        count: How many images there are.
    """

    def __init__(self, count: int) -> None:
        size = max(min(count, 100), min(int(count**0.75), 10_000))
        self._sample = np.round(np.linspace(0, count - 1, size)).astype(np.int64)
        self._count, self._counts = count, np.zeros((3, 256), dtype=np.int64)

    def batches(self, most: int) -> Iterator[Indices]:
        """Yield the rows of all images, so many at a time."""
        for start in range(0, self._count, most):
            yield np.arange(start, min(start + most, self._count))

    def add(self, rows: Indices, images: NDArray[np.uint8]) -> None:
        """Look at images ``(n, H, W, 3)`` of some rows."""
        shown = images[np.isin(rows, self._sample)]
        self._counts += [np.bincount(shown[..., each].ravel(), minlength=256) for each in range(3)]

    def statistics(self) -> Statistics:
        """Return the statistics, each channel's in [0, 1]."""
        return statistics_of_images(self._counts, len(self._sample))


def statistics_of_images(counts: NDArray[np.int64], images: int) -> Statistics:
    """Return the statistics of images, each channel's in [0, 1].

    Args:
        counts: How many pixels there are of each value, ``(3, 256)``.
        images: How many images these are of.
    """
    values = np.arange(256) / 255
    shares = counts / counts.sum(axis=1, keepdims=True)
    mean = shares @ values
    off = values - mean[:, None]
    seen = counts > 0
    result = {
        "min": values[seen.argmax(axis=1)],
        "max": values[255 - seen[:, ::-1].argmax(axis=1)],
        "mean": mean,
        "std": np.sqrt((shares * off**2).sum(axis=1)),
        "count": np.array([images], dtype=np.float64),
    }
    reached = shares.cumsum(axis=1)
    for name, share in QUANTILES.items():
        result[name] = values[(reached >= share).argmax(axis=1)]
    return {
        name: numbers if name == "count" else numbers.reshape(3, 1, 1)
        for name, numbers in result.items()
    }


def merge(statistics: Sequence[Mapping[str, Floats]]) -> Statistics:
    """Return the statistics over episodes from those of each.

    Quantiles are averaged over the frames, as LeRobot does when a data set grows; the others
    are exact.
    """
    columns = {name: np.stack([item[name] for item in statistics]) for name in statistics[0]}
    counts = columns["count"].reshape(-1, *[1] * (columns["mean"].ndim - 1))
    total = counts.sum(axis=0)
    mean = (columns["mean"] * counts).sum(axis=0) / total
    spread = columns["std"] ** 2 + (columns["mean"] - mean) ** 2
    result = {
        "min": columns["min"].min(axis=0),
        "max": columns["max"].max(axis=0),
        "mean": mean,
        "std": np.sqrt((spread * counts).sum(axis=0) / total),
        "count": total.reshape(1),
    }
    for name in QUANTILES:
        result[name] = (columns[name] * counts).sum(axis=0) / total
    return result


def plain(statistics: Mapping[str, Floats]) -> dict[str, list[Any]]:
    """Return statistics as lists, the count as a whole number, as LeRobot stores them."""
    return {
        name: [int(values[0])] if name == "count" else values.tolist()
        for name, values in statistics.items()
    }
