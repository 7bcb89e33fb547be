"""The bar chart of success rates: a group of bars for each task, one for each method."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from prime_core.reporting.methods import (
    LOWEST_TOP,
    Look,
    add_legend,
    finish_rates,
    method_looks,
)
from prime_core.reporting.style import INK, SMALL, save

if TYPE_CHECKING:
    from matplotlib.axes import Axes

COLUMN, PAGE = 3.5, 7.16  # inches: widths of one and of two columns of a paper
_BAR, _BETWEEN_METHODS, _BETWEEN_TASKS = 1.0, 0.25, 1.5  # widths, in bars
_INCHES_PER_BAR = 0.17
_OF_NUMBERS = 5.5  # size of the numbers above bars
_ROOM_FOR_NUMBERS = 0.16


@dataclass(frozen=True)
class Bar:
    """A success rate.

    Attributes:
        method: Whose.
        mean: Over the seeds of its trainings.
        deviation: Standard deviation over those seeds; None where there is but one.
        published: Whether others published it.
    """

    method: str
    mean: float
    deviation: float | None
    published: bool = False


def draw_success_bars(
    path: Path, tasks: Mapping[str, Sequence[Bar]], methods: Sequence[str], publisher: str
) -> None:
    """Draw a bar chart of success rates, with what others published beside it.

    Args:
        path: Of the figure; the suffix decides its kind.
        tasks: The bars of each task, by the task's name.
        methods: In the order in which they stand.
        publisher: Who published those that are; empty where none is.
    """
    from matplotlib.figure import Figure
    from matplotlib.patches import Patch

    count = sum(map(len, tasks.values()))
    width = min(max(COLUMN, 0.8 + _INCHES_PER_BAR * (count + 2 * len(tasks))), PAGE)
    figure = Figure(figsize=(width, 2.5), layout="constrained")
    axes = figure.add_subplot()
    looks, left, middles = method_looks(methods), 0.0, []
    for bars in tasks.values():
        right = _draw_task(axes, bars, looks, left)
        middles.append((left + right) / 2)
        left = right + _BETWEEN_TASKS
    axes.set_xticks(middles, [*tasks], parse_math=False)
    axes.set_xlim(-_BETWEEN_TASKS / 2, left - _BETWEEN_TASKS / 2)
    every = [bar for bars in tasks.values() for bar in bars]
    top = max((bar.mean + (bar.deviation or 0.0) for bar in every), default=1.0)
    finish_rates(axes, max(top, LOWEST_TOP) + _ROOM_FOR_NUMBERS)
    axes.tick_params(axis="x", length=0)
    axes.set_ylabel("success rate", fontsize=SMALL, color=INK)
    entries = {name: Patch(**looks[name].bar(published=False)) for name in methods}
    if publisher:
        grey = Look("#666666", "", "", dotted=False)
        entries[publisher] = Patch(**grey.bar(published=True))
    add_legend(figure, entries)
    save(figure, path)


def _draw_task(axes: "Axes", bars: Sequence[Bar], looks: Mapping[str, Look], left: float) -> float:
    """Draw the bars of a task, those of a method side by side, and return where they end."""
    for method in looks:
        own = sorted((bar for bar in bars if bar.method == method), key=lambda bar: bar.published)
        for bar in own:
            axes.bar(
                left + _BAR / 2,
                bar.mean,
                width=_BAR,
                linewidth=0.8,
                label=f"{method}, published" if bar.published else method,
                **looks[method].bar(published=bar.published),
            )
            _draw_spread_and_number(axes, bar, left + _BAR / 2)
            left += _BAR
        left += _BETWEEN_METHODS if own else 0.0
    return left - _BETWEEN_METHODS


def _draw_spread_and_number(axes: "Axes", bar: Bar, middle: float) -> None:
    spread = bar.deviation or 0.0
    if bar.deviation is not None:
        axes.errorbar(
            middle, bar.mean, yerr=spread, color=INK, linewidth=0.8, capsize=1.8, capthick=0.8
        )
    axes.annotate(
        f"{bar.mean:.3f}",
        (middle, bar.mean + spread),
        xytext=(0, 2.5),
        textcoords="offset points",
        ha="center",
        va="bottom",
        rotation=90,
        fontsize=_OF_NUMBERS,
        color=INK,
    )
