"""How methods look in figures: the same in every figure that names the same methods in order."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from prime_core.reporting.style import INK, SMALL

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# Okabe and Ito's, and two of Tol's: the first four differ most in grey, too; yellow is the last,
# for a line of it is hard to see.
_COLOURS = (
    "#0072B2",
    "#E69F00",
    "#882255",
    "#009E73",
    "#56B4E9",
    "#D55E00",
    "#CC79A7",
    "#999933",
    "#F0E442",
)
_MARKERS = ("o", "s", "^", "D", "v", "P", "X", "<", ">")
_DASHES = ("-", (0, (5, 1.5)), (0, (1, 1)), (0, (5, 1, 1, 1)))
_DOTTED_FROM = 4
"""The first method whose bars have a pattern, for in grey its colour is much like another's."""

LOWEST_TOP = 1.04
"""Success rates are drawn up to here at least, so that a bar of 1 has something above it."""


@dataclass(frozen=True)
class Look:
    """How a method is drawn.

    Attributes:
        colour: Of its bars and lines.
        marker: Of its points.
        dashes: Of its lines.
        dotted: Whether its bars have a pattern of dots.
    """

    colour: str
    marker: str
    dashes: Any
    dotted: bool

    def bar(self, *, published: bool) -> dict[str, Any]:
        """Return how its bars are drawn, as matplotlib's options.

        Args:
            published: Whether of values that others published: hatched, and not filled.
        """
        if published:
            return {"facecolor": "white", "edgecolor": self.colour, "hatch": "//////"}
        return {
            "facecolor": self.colour,
            "edgecolor": "white",
            "hatch": "...." if self.dotted else None,
        }


def method_looks(methods: Sequence[str]) -> dict[str, Look]:
    """Return how each of some methods is drawn; beyond nine, looks come back with other dashes."""
    return {
        name: Look(
            _COLOURS[number % len(_COLOURS)],
            _MARKERS[number % len(_MARKERS)],
            _DASHES[number % len(_DASHES)],
            number >= _DOTTED_FROM,
        )
        for number, name in enumerate(methods)
    }


def add_legend(figure: "Figure", entries: Mapping[str, Any]) -> None:
    """Put a legend above everything, in as few rows as the figure is wide enough for.

    Args:
        figure: Where; it has a constrained layout.
        entries: What stands for each name, of matplotlib.
    """
    for rows in range(1, len(entries) + 1):
        legend = figure.legend(
            handles=[*entries.values()],
            # Set below: matplotlib leaves names out that begin with "_".
            labels=[" "] * len(entries),
            loc="outside upper center",
            ncols=-(-len(entries) // rows),
            fontsize=SMALL,
            frameon=False,
            handlelength=1.8,
            columnspacing=1.4,
        )
        for text, name in zip(legend.get_texts(), entries, strict=True):
            text.set(text=name, parse_math=False, color=INK)
        if rows == len(entries) or legend.get_window_extent().width <= figure.bbox.width:
            return
        legend.remove()


def finish_rates(axes: "Axes", top: float) -> None:
    """Give axes of success rates their scale and light lines behind what is drawn.

    Args:
        axes: Whose y axis has success rates.
        top: What is drawn reaches up to there.
    """
    axes.set_ylim(0, max(top, LOWEST_TOP))
    axes.set_yticks([0, 0.2, 0.4, 0.6, 0.8, 1])
    axes.set_axisbelow(True)
    axes.grid(axis="y", color="#DDDDDD", linewidth=0.6)
    axes.tick_params(labelsize=SMALL, length=2.5, color=INK)
    axes.spines[["top", "right"]].set_visible(False)
