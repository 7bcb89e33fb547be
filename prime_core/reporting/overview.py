"""The picture of many parsed demonstrations, one above the other."""

from collections.abc import Sequence
from pathlib import Path

from prime_core.contracts.calls import OTHER, PrimitiveSpace
from prime_core.contracts.demonstration import ParsedDemonstration
from prime_core.contracts.environment import CONTROL_FREQUENCY
from prime_core.reporting.style import (
    INK,
    NORMAL,
    SMALL,
    draw_bar,
    finish,
    look,
    primitive_colours,
    save,
)

TALLEST = 9.0  # inches of bars in an overview


MOST_LABELS = 60


def draw_timelines_overview(
    path: Path | str,
    parsed: Sequence[ParsedDemonstration],
    space: PrimitiveSpace,
    *,
    labels: Sequence[str] | None = None,
    title: str = "",
    fps: int = CONTROL_FREQUENCY,
) -> None:
    """Draw many demonstrations, one above the other, each as a bar of primitives.

    Args:
        path: Of the picture; the suffix decides its kind.
        parsed: The demonstrations, from top to bottom.
        space: The primitives, so that colours agree with other pictures.
        labels: What stands beside each; their numbers if None.
        title: What stands above.
        fps: Frames a second.
    """
    from matplotlib.figure import Figure
    from matplotlib.patches import Patch

    count = max(len(parsed), 1)
    colours = primitive_colours(space.names)
    figure = Figure(figsize=(7.0, 1.0 + min(0.24 * count, TALLEST)), layout="constrained")
    axes = figure.add_subplot()
    for index, item in enumerate(parsed):
        for segment in item.segments:
            draw_bar(axes, segment, colours, row=float(index), thickness=0.72)
    # Of very many demonstrations, only some have room for a label.
    labelled = slice(None, None, 1 + count // MOST_LABELS)
    names = labels if labels is not None else [str(number) for number in range(len(parsed))]
    axes.set_yticks(range(len(parsed))[labelled], names[labelled])
    axes.set_ylim(count - 0.4, -0.6)
    axes.set_xlabel(f"step ({fps} a second)", fontsize=SMALL)
    present = {segment.call.primitive for item in parsed for segment in item.segments}
    order = [name for name in (*space.names, OTHER) if name in present]
    figure.legend(
        handles=[Patch(label=name, **look(name, colours)) for name in order],
        loc="outside upper right",
        ncols=max(len(order), 1),
        fontsize=SMALL,
        frameon=False,
    )
    figure.suptitle(title, fontsize=NORMAL, x=0.01, ha="left", color=INK)
    finish([axes], max([1, *(item.demonstration.steps for item in parsed)]))
    save(figure, Path(path))
