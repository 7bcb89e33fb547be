"""Timelines: the right bars, and nothing changed for others who draw."""

from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.image import imread

from prime_core.checks.samples import DESCRIPTION
from prime_core.contracts.calls import Parameter, ParameterSpace, PrimitiveCall, PrimitiveSpace
from prime_core.contracts.demonstration import Demonstration, ParsedDemonstration, Segment
from prime_core.contracts.observations import Observations
from prime_core.reporting import style
from prime_core.reporting.overview import draw_timelines_overview
from prime_core.reporting.style import primitive_colours
from prime_core.reporting.timeline import draw_timeline

FRAMES = 201
POSE = ParameterSpace((Parameter("x", "m", -1.0, 1.0), Parameter("yaw", "rad", -2.0, 2.0)))
SPACE = PrimitiveSpace(("reach", "grasp", "wipe"), (POSE, POSE, POSE))


def parsed(*pieces: tuple[int, str]) -> ParsedDemonstration:
    state = np.zeros((FRAMES, 15), dtype=np.float32)
    state[:, 2], state[:, 7] = np.linspace(1.0, 0.8, FRAMES), 0.08
    objects = np.zeros((FRAMES, 16), dtype=np.float32)
    objects[60:120, 7] = 1
    actions = np.zeros((FRAMES, 5), dtype=np.float32)
    start, segments = 0, []
    for end, name in pieces:
        parameters = np.empty(0) if name == "other" else np.array([0.25, np.pi / 2])
        segments.append(Segment(start, end, PrimitiveCall(name, parameters), -1.0))
        start = end
    return ParsedDemonstration(
        Demonstration(Observations(state, objects), actions, "task"), tuple(segments)
    )


PARSED = parsed((60, "grasp"), (75, "other"), (150, "wipe"), (200, "reach"))


@pytest.fixture
def drawn(monkeypatch: pytest.MonkeyPatch) -> Any:
    """Every figure that is saved."""
    figures: list[Any] = []
    save = style.save

    def keep(figure: Any, path: Path) -> None:
        figures.append(figure)
        save(figure, path)

    for module in ("timeline", "overview"):
        monkeypatch.setattr(f"prime_core.reporting.{module}.save", keep)
    return figures


def bars_of(axes: Axes) -> list[tuple[float, float, float, str]]:
    return [
        (
            patch.get_x(),  # type: ignore[attr-defined]
            patch.get_width(),  # type: ignore[attr-defined]
            patch.get_y() + patch.get_height() / 2,  # type: ignore[attr-defined]
            matplotlib.colors.to_hex(patch.get_facecolor()).upper(),
        )
        for patch in axes.patches
    ]


def test_a_timeline_shows_segments_curves_and_what_is_held(tmp_path: Path, drawn: Any) -> None:
    path = tmp_path / "new" / "timeline.png"
    draw_timeline(path, PARSED, SPACE, description=DESCRIPTION, title="demonstration 3")
    picture = imread(path)
    assert picture.shape[1] >= 1200 and picture[..., :3].std() > 0.05
    bars, height, opening = drawn[0].axes
    colours = primitive_colours(SPACE.names)
    assert bars_of(bars) == [
        (0, 60, 0, colours["grasp"]),
        (60, 15, 0, colours["other"]),
        (75, 75, 0, colours["wipe"]),
        (150, 50, 0, colours["reach"]),
    ]
    words = [text.get_text() for text in bars.texts]
    assert {"grasp", "wipe", "reach", "other", "x 0.25 m\nyaw 90°"} <= set(words)
    np.testing.assert_allclose(height.lines[-1].get_ydata()[[0, -1]], [1.0, 0.8], atol=1e-6)
    assert [patch.get_x() for patch in height.patches] == [60]
    assert [patch.get_width() for patch in height.patches] == [59]
    assert [text.get_text() for text in opening.texts] == ["cube held"]


def test_an_overview_shows_all_demonstrations(tmp_path: Path, drawn: Any) -> None:
    draw_timelines_overview(tmp_path / "all.png", [PARSED, parsed((200, "reach"))], SPACE)
    (axes,) = drawn[0].axes
    rows = [row for _, _, row, _ in bars_of(axes)]
    np.testing.assert_allclose(rows, [0, 0, 0, 0, 1])
    names = [text.get_text() for text in drawn[0].legends[0].get_texts()]
    assert names == ["reach", "grasp", "wipe", "other"]


@pytest.mark.parametrize("count", [0, 1, 200])
def test_any_number_of_demonstrations(tmp_path: Path, count: int) -> None:
    draw_timelines_overview(tmp_path / "all.png", [parsed((200, "reach"))] * count, SPACE)
    assert imread(tmp_path / "all.png").shape[0] < 2500


def test_demonstrations_without_segments_or_objects(tmp_path: Path) -> None:
    seen = Observations(np.zeros((1, 15), np.float32), np.zeros((1, 0), np.float32))
    still = Demonstration(seen, np.zeros((1, 5), np.float32), "task")
    draw_timeline(tmp_path / "still.pdf", ParsedDemonstration(still, ()), SPACE)
    assert (tmp_path / "still.pdf").read_bytes().startswith(b"%PDF")


def test_colours_are_the_same_in_every_picture() -> None:
    few, many = primitive_colours(["grasp", "wipe"]), primitive_colours(["wipe", "reach", "stir"])
    assert few["wipe"] == many["wipe"]
    assert len(set(many.values())) == 4
    names = ["reach", "grasp", "place", "push", "a", "b", "c", "d", "e", "f"]
    assert len(set(primitive_colours(names).values())) == 11


def test_drawing_changes_nothing_for_others(tmp_path: Path) -> None:
    import sys

    settings = dict(matplotlib.rcParams)
    loaded = "matplotlib.pyplot" in sys.modules
    draw_timeline(tmp_path / "timeline.png", PARSED, SPACE)
    draw_timelines_overview(tmp_path / "all.png", [PARSED], SPACE)
    assert dict(matplotlib.rcParams) == settings
    assert ("matplotlib.pyplot" in sys.modules) == loaded
    assert sorted(path.name for path in tmp_path.iterdir()) == ["all.png", "timeline.png"]
