"""Pictures of parsed demonstrations: which primitive when."""

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from prime_core.atomic import new_file
from prime_core.environment import CONTROL_FREQUENCY
from prime_core.frames import Frames
from prime_core.idm import PrimitiveSpace
from prime_core.parsing import ParsedDemonstration
from prime_core.primitive_calls import OTHER, Segment
from prime_core.scene import OBJECT_WIDTH, SceneDescription

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
TALLEST = 9.0  # inches of bars in an overview
MOST_LABELS = 60
GRIPPER_HEIGHT_COLUMN, GRIPPER_OPENING_COLUMN = 2, 7


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
    frames = parsed.demonstration.frames
    colours = primitive_colours(space.names)
    steps = max(len(frames) - 1, 1)
    for segment in parsed.segments:
        _draw_bar(bars, segment, colours, row=0.0, thickness=0.8)
        _write_label(bars, segment, _parameter_lines(segment, space), steps)
        for panel in (height, opening):
            panel.axvline(segment.end, color=INK, linewidth=0.4, alpha=0.35)
    bars.set(ylim=(-1.25, 0.5), yticks=[])
    bars.set_title(title, fontsize=NORMAL, loc="left", color=INK)
    time = np.arange(len(frames))
    height.plot(time, frames.state[:, GRIPPER_HEIGHT_COLUMN], color="#0072B2", linewidth=1.2)
    height.set_ylabel("height [m]", fontsize=SMALL)
    opening.plot(time, frames.state[:, GRIPPER_OPENING_COLUMN], color="#D55E00", linewidth=1.2)
    opening.set_ylabel("opening [m]", fontsize=SMALL)
    _mark_held(height, frames, description, named=False)
    _mark_held(opening, frames, description, named=True)
    opening.set_xlabel(f"step ({fps} a second)", fontsize=SMALL)
    _finish([bars, height, opening], steps)
    _save(figure, Path(path))


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
            _draw_bar(axes, segment, colours, row=float(index), thickness=0.72)
    # Of very many demonstrations, only some have room for a label.
    labelled = slice(None, None, 1 + count // MOST_LABELS)
    names = labels if labels is not None else [str(number) for number in range(len(parsed))]
    axes.set_yticks(range(len(parsed))[labelled], names[labelled])
    axes.set_ylim(count - 0.4, -0.6)
    axes.set_xlabel(f"step ({fps} a second)", fontsize=SMALL)
    present = {segment.call.primitive for item in parsed for segment in item.segments}
    order = [name for name in (*space.names, OTHER) if name in present]
    figure.legend(
        handles=[Patch(label=name, **_look(name, colours)) for name in order],
        loc="outside upper right",
        ncols=max(len(order), 1),
        fontsize=SMALL,
        frameon=False,
    )
    figure.suptitle(title, fontsize=NORMAL, x=0.01, ha="left", color=INK)
    _finish([axes], max([1, *(item.demonstration.steps for item in parsed)]))
    _save(figure, Path(path))


def _panels() -> tuple["Figure", list["Axes"]]:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.0, 3.2), layout="constrained")
    panels = figure.subplots(3, 1, sharex=True, gridspec_kw={"height_ratios": [1.5, 1.0, 1.0]})
    return figure, list(panels)


def _draw_bar(
    axes: "Axes", segment: Segment, colours: dict[str, str], row: float, thickness: float
) -> None:
    axes.barh(
        row,
        segment.steps,
        left=segment.start,
        height=thickness,
        **_look(segment.call.primitive, colours),
    )


def _look(primitive: str, colours: dict[str, str]) -> dict[str, Any]:
    # What no primitive explains is to be seen in print without colours, too.
    return {
        "facecolor": colours.get(primitive, COLOURS[OTHER]),
        "edgecolor": "white",
        "linewidth": 0.8,
        "hatch": "////" if primitive == OTHER else None,
    }


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
    axes: "Axes", frames: Frames, description: SceneDescription | None, *, named: bool
) -> None:
    """Shade the steps at which the gripper holds an object."""
    width = frames.environment_state.shape[1]
    objects = frames.environment_state.reshape(len(frames), width // OBJECT_WIDTH, OBJECT_WIDTH)
    for index in range(objects.shape[1]):
        name = description.objects[index].name if description else f"object {index}"
        held = np.concatenate(([False], objects[:, index, 7] > 0.5, [False]))
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


def _finish(panels: Sequence["Axes"], steps: int) -> None:
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


def _save(figure: "Figure", path: Path) -> None:
    with new_file(path) as partial:
        figure.savefig(partial, dpi=DOTS_PER_INCH)
