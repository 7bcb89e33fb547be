"""How pictures of parsed demonstrations look: colours, sizes, bars."""

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from prime_core.contracts.calls import OTHER
from prime_core.contracts.demonstration import Segment
from prime_core.files import new_file

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


# Okabe and Ito's colours, which readers with any colour vision tell apart.
COLOURS = {
    "reach": "#56B4E9",
    "grasp": "#E69F00",
    "place": "#009E73",
    "push": "#CC79A7",
    "atomic": "#D9D9D9",
    OTHER: "#BDBDBD",
}


SPARE_COLOURS = ("#F0E442", "#0072B2", "#D55E00", "#882255", "#44AA99", "#999933")


INK = "#222222"


SMALL, NORMAL = 7.0, 8.5


DOTS_PER_INCH = 200


def primitive_colours(names: Iterable[str]) -> dict[str, str]:
    """Return a colour for each primitive.

    The common primitives have the same colour in every picture; the others take what is left in
    the order given, so that all pictures of one list of primitives agree.
    """
    spare = iter(SPARE_COLOURS * 100)
    result = {OTHER: COLOURS[OTHER]}
    for name in dict.fromkeys(names):
        result[name] = COLOURS[name] if name in COLOURS else next(spare)
    return result


def draw_bar(
    axes: "Axes", segment: Segment, colours: dict[str, str], row: float, thickness: float
) -> None:
    """Draw a segment as a bar from its start to its end."""
    axes.barh(
        row,
        segment.steps,
        left=segment.start,
        height=thickness,
        **look(segment.call.primitive, colours),
    )


def look(primitive: str, colours: dict[str, str]) -> dict[str, Any]:
    """Return how a bar of a primitive is drawn, as matplotlib's options."""
    # What no primitive explains is to be seen in print without colours, too.
    return {
        "facecolor": colours.get(primitive, COLOURS[OTHER]),
        "edgecolor": "white",
        "linewidth": 0.8,
        "hatch": "////" if primitive == OTHER else None,
    }


def finish(panels: Sequence["Axes"], steps: int) -> None:
    """Give panels one above the other the same steps, and take away lines that say nothing."""
    for axes in panels:
        axes.set_xlim(0, steps)
        axes.tick_params(labelsize=SMALL, length=2.5)
        for side in ("top", "right"):
            axes.spines[side].set_visible(False)
    for axes in panels[:-1]:
        axes.tick_params(bottom=False)
    # Bars need no axis of their own.
    if len(panels) > 1:
        panels[0].spines[["left", "bottom"]].set_visible(False)


def save(figure: "Figure", path: Path) -> None:
    """Write a picture, whole or not at all."""
    from matplotlib import rc_context

    # Letters of PDFs as TrueType: publishers refuse matplotlib's own kind.
    with new_file(path) as partial, rc_context({"pdf.fonttype": 42}):
        figure.savefig(partial, dpi=DOTS_PER_INCH)
