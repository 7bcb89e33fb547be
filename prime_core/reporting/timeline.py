"""The picture of one parsed demonstration: which primitive when, and what the gripper did."""

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from prime_core.contracts.calls import PrimitiveSpace
from prime_core.contracts.demonstration import ParsedDemonstration, Segment
from prime_core.contracts.description import SceneDescription
from prime_core.contracts.environment import CONTROL_FREQUENCY
from prime_core.contracts.observations import Observations
from prime_core.reporting.style import (
    INK,
    NORMAL,
    SMALL,
    draw_bar,
    finish,
    primitive_colours,
    save,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def draw_timeline(
    path: Path | str,
    parsed: ParsedDemonstration,
    space: PrimitiveSpace,
    *,
    description: SceneDescription | None = None,
    title: str = "",
    fps: int = CONTROL_FREQUENCY,
) -> None:
    """Draw one demonstration: its primitives with their parameters, and what the gripper did.

    Args:
        path: Of the picture; the suffix decides its kind (``.png``, ``.pdf``, ``.svg``).
        parsed: The demonstration and its segments.
        space: The primitives and their parameters, for colours, names and units.
        description: Of its environment, for the names of the objects.
        title: What stands above.
        fps: Frames a second.
    """
    figure, (bars, height, opening) = _panels()
    seen = parsed.demonstration.observations
    colours = primitive_colours(space.names)
    steps = max(len(seen) - 1, 1)
    for segment in parsed.segments:
        draw_bar(bars, segment, colours, row=0.0, thickness=0.8)
        _write_label(bars, segment, _parameter_lines(segment, space), steps)
        for panel in (height, opening):
            panel.axvline(segment.end, color=INK, linewidth=0.4, alpha=0.35)
    bars.set(ylim=(-1.25, 0.5), yticks=[])
    bars.set_title(title, fontsize=NORMAL, loc="left", color=INK)
    time = np.arange(len(seen))
    height.plot(time, seen.gripper_position[:, 2], color="#0072B2", linewidth=1.2)
    height.set_ylabel("height [m]", fontsize=SMALL)
    opening.plot(time, seen.gripper_opening, color="#D55E00", linewidth=1.2)
    opening.set_ylabel("opening [m]", fontsize=SMALL)
    _mark_held(height, seen, description, named=False)
    _mark_held(opening, seen, description, named=True)
    opening.set_xlabel(f"step ({fps} a second)", fontsize=SMALL)
    finish([bars, height, opening], steps)
    save(figure, Path(path))


def _panels() -> tuple["Figure", list["Axes"]]:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.0, 3.2), layout="constrained")
    panels = figure.subplots(3, 1, sharex=True, gridspec_kw={"height_ratios": [1.5, 1.0, 1.0]})
    return figure, list(panels)


def _write_label(axes: "Axes", segment: Segment, lines: str, steps: int) -> None:
    """Write a segment's name into its bar and its parameters beneath, where there is room."""
    share = segment.steps / steps
    middle = (segment.start + segment.end) / 2
    name = segment.call.primitive
    upright = share < 0.013 * len(name) + 0.01
    axes.text(
        middle,
        0.0,
        name,
        ha="center",
        va="center",
        fontsize=SMALL if upright else NORMAL,
        rotation=90 if upright else 0,
        color=INK,
        clip_on=True,
    )
    if lines and share > 0.062:
        axes.text(middle, -0.48, lines, ha="center", va="top", fontsize=SMALL - 1, color=INK)


def _parameter_lines(segment: Segment, space: PrimitiveSpace) -> str:
    name = segment.call.primitive
    if name not in space.names:
        return ""
    parameters = space.parameter_spaces[space.names.index(name)].parameters
    lines = []
    for item, value in zip(parameters, segment.call.parameters, strict=True):
        shown = f"{np.degrees(value):.0f}°" if item.unit == "rad" else f"{value:.2f} {item.unit}"
        lines.append(f"{item.name} {shown}")
    return "\n".join(lines)


def _mark_held(
    axes: "Axes", seen: Observations, description: SceneDescription | None, *, named: bool
) -> None:
    """Shade the steps at which the gripper holds an object."""
    if seen.environment_state is None:
        return
    for index, flags in enumerate(seen.held.T):
        name = description.objects[index].name if description else f"object {index}"
        held = np.concatenate(([False], flags, [False]))
        edges = np.flatnonzero(np.diff(held.astype(np.int8)))
        for number, (start, end) in enumerate(edges.reshape(-1, 2)):
            axes.axvspan(start, end - 1, color="#999999", alpha=0.22, linewidth=0)
            # The name once is enough, and flickering contacts would write it over and over.
            if named and number == 0:
                axes.annotate(
                    f"{name} held",
                    (start, 1.0),
                    xycoords=("data", "axes fraction"),
                    xytext=(2, -2),
                    textcoords="offset points",
                    va="top",
                    fontsize=SMALL - 1,
                    color="#555555",
                )
