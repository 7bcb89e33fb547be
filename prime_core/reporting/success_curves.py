"""Success rates against a number, such as that of demonstrations: a line for each method."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Any

from prime_core.reporting.methods import Look, add_legend, finish_rates, method_looks
from prime_core.reporting.style import INK, NORMAL, SMALL, save
from prime_core.reporting.success_bars import COLUMN, PAGE

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_MOST_IN_A_ROW = 4


@dataclass(frozen=True)
class CurvePoint:
    """A success rate at a number.

    Attributes:
        number: Such as of demonstrations; more than 0.
        mean: Over the seeds of its trainings.
        deviation: Standard deviation over those seeds; None where there is but one.
    """

    number: int
    mean: float
    deviation: float | None


@dataclass(frozen=True)
class Curve:
    """The success rates of a method.

    Attributes:
        method: Whose.
        points: By rising numbers.
        published: Whether others published them.
    """

    method: str
    points: tuple[CurvePoint, ...]
    published: bool = False


def draw_success_curves(
    path: Path,
    tasks: Mapping[str, Sequence[Curve]],
    methods: Sequence[str],
    against: str,
    publisher: str,
) -> None:
    """Draw success rates against a number, on a logarithmic axis, a panel for each task.

    Args:
        path: Of the figure; the suffix decides its kind.
        tasks: The curves of each task, by the task's name.
        methods: In the order in which they stand.
        against: What the numbers are.
        publisher: Who published those that are; empty where none is.
    """
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

    columns = min(len(tasks), _MOST_IN_A_ROW)
    rows = -(-len(tasks) // columns)
    figure = Figure(figsize=(COLUMN if columns == 1 else PAGE, 0.4 + 2.1 * rows))
    figure.set_layout_engine("constrained")
    looks = method_looks(methods)
    panels = figure.subplots(rows, columns, sharey=True, squeeze=False).flat
    for panel, (task, curves) in zip(panels, tasks.items(), strict=False):
        for curve in sorted(curves, key=lambda curve: methods.index(curve.method)):
            _draw_curve(panel, curve, looks[curve.method])
        _finish_panel(panel, task, curves, against)
    for panel in [*panels][len(tasks) :]:
        panel.set_visible(False)
    for row in range(rows):
        figure.axes[row * columns].set_ylabel("success rate", fontsize=SMALL, color=INK)
    entries = {name: Line2D([], [], **_line(look, published=False)) for name, look in looks.items()}
    if publisher:
        grey = Look("#666666", "o", "-", dotted=False)
        entries[publisher] = Line2D([], [], **_line(grey, published=True))
    add_legend(figure, entries)
    save(figure, path)


def _line(look: Look, *, published: bool) -> dict[str, Any]:
    """Return how a method's line is drawn; points that others published are hollow, and alone."""
    return {
        "color": look.colour,
        "linestyle": "none" if published else look.dashes,
        "linewidth": 1.4,
        "marker": look.marker,
        "markersize": 5,
        "markerfacecolor": "white" if published else look.colour,
    }


def _draw_curve(axes: "Axes", curve: Curve, look: Look) -> None:
    numbers = [point.number for point in curve.points]
    means = [point.mean for point in curve.points]
    label = f"{curve.method}, published" if curve.published else curve.method
    axes.plot(numbers, means, label=label, clip_on=False, **_line(look, published=curve.published))
    for point in curve.points:
        if point.deviation is not None:
            axes.errorbar(
                point.number,
                point.mean,
                yerr=point.deviation,
                color=look.colour,
                linewidth=0.9,
                capsize=2,
            )


def _finish_panel(axes: "Axes", task: str, curves: Sequence[Curve], against: str) -> None:
    numbers = sorted({point.number for curve in curves for point in curve.points})
    axes.set_xscale("log")
    axes.set_xticks(numbers, [f"{number:,}" for number in numbers])
    axes.minorticks_off()
    # Half a gap at either end, of a factor of 2 if there is one number alone.
    edge = (numbers[-1] / numbers[0]) ** (0.25 / max(len(numbers) - 1, 1)) if numbers else 1.0
    edge = max(edge, 1.15)
    axes.set_xlim(numbers[0] / edge, numbers[-1] * edge)
    reach = chain.from_iterable(curve.points for curve in curves)
    finish_rates(axes, max(point.mean + (point.deviation or 0.0) for point in reach) + 0.02)
    axes.set_xlabel(against, fontsize=SMALL, color=INK)
    axes.set_title(task, fontsize=NORMAL, color=INK, parse_math=False)
