"""Figures of results files: what stands on them, and what is refused."""

import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import matplotlib
import pytest
from matplotlib.colors import to_hex
from matplotlib.container import BarContainer
from matplotlib.figure import Figure

from prime_core.cli.compare import compare
from prime_core.errors import PrimeError
from prime_core.experiments.results.measured import Against
from prime_core.reporting import style
from prime_core.reporting.methods import method_looks

RESULTS = Path(__file__).parents[3] / "docs" / "results"
MAGIC = {".png": b"\x89PNG", ".pdf": b"%PDF", ".svg": b"<?xml"}


@pytest.fixture
def drawn(monkeypatch: pytest.MonkeyPatch) -> list[Figure]:
    """Every figure that is saved."""
    figures: list[Figure] = []
    save = style.save

    def keep(figure: Figure, path: Path) -> None:
        figures.append(figure)
        save(figure, path)

    for module in ("success_bars", "success_curves"):
        monkeypatch.setattr(f"prime_core.reporting.{module}.save", keep)
    return figures


def legend(figure: Figure) -> list[str]:
    return [text.get_text() for text in figure.legends[0].get_texts()]


def bars(figure: Figure) -> list[BarContainer]:
    return [each for each in figure.axes[0].containers if isinstance(each, BarContainer)]


def heights(figure: Figure) -> list[tuple[str, float]]:
    """Return what each bar is, and its height, from left to right."""
    drawn = sorted(bars(figure), key=lambda bar: bar.patches[0].get_x())
    return [(str(bar.get_label()), round(bar.patches[0].get_height(), 3)) for bar in drawn]


def kept(task: str, variant: str = "") -> float:
    """Return the success of PRIME in the results that are kept."""
    found = json.loads((RESULTS / f"{task}.json").read_text())
    results = found["variants"][variant] if variant else found["results"]
    return round(float(results["evaluation.prime"]["success"]["mean"]), 3)


def success(mean: float, deviation: float = 0.05, seeds: int = 2) -> dict[str, Any]:
    rates = {str(seed): mean for seed in range(seeds)}
    return {"success": {"mean": mean, "standard_deviation": deviation, "seeds": rates}}


def write(path: Path, name: str, results: dict[str, Any], **keys: Any) -> Path:
    path.write_text(json.dumps({"name": name, "results": results, **keys}))
    return path


def with_counts(path: Path, name: str, counts: Sequence[int], **keys: Any) -> Path:
    """Write results whose variants differ in the number of demonstrations."""

    def one(count: int) -> dict[str, Any]:
        return {
            "demonstrations": {"demonstrations": count, "left_out": {}},
            "evaluation.prime": success(1 - 1 / count),
            "evaluation.bc-rnn": success(0.5 - 1 / count, seeds=1),
        }

    variants = {f"n{count}": one(count) for count in counts[1:]}
    variants["plain"] = {"evaluation.prime": success(0.25)}
    return write(path, name, one(counts[0]), variants=variants, **keys)


@pytest.mark.parametrize("suffix", MAGIC)
def test_bars_of_tasks_stand_beside_the_papers(
    tmp_path: Path, drawn: list[Figure], suffix: str
) -> None:
    names = ("pick_place", "tidy_up")
    paths = [RESULTS / part / f"{name}.json" for name in names for part in ("", "paper")]
    figure = tmp_path / "new" / f"bars{suffix}"
    methods = ["prime", "prime (idm-abc)", "bc-rnn"]
    compare(paths, figure=figure, method=methods)
    assert figure.read_bytes().startswith(MAGIC[suffix])
    assert [path.name for path in figure.parent.iterdir()] == [figure.name]
    (shown,) = drawn
    assert heights(shown) == [
        ("prime", kept("pick_place")),
        ("prime, published", 0.967),
        ("prime", kept("tidy_up")),
        ("prime, published", 0.989),
        ("prime (idm-abc)", kept("tidy_up", "idm-abc")),
        ("prime (idm-abc), published", 0.975),
        ("bc-rnn, published", 0.825),
    ]
    axes = shown.axes[0]
    assert [text.get_text() for text in axes.get_xticklabels()] == ["pick-place", "tidy-up"]
    assert axes.get_ylabel() == "success rate"
    assert legend(shown) == [*methods, "Gao et al. 2024"]
    assert [text.get_text() for text in axes.texts][-1] == "0.825"
    # The spread of the last one, 0.825 ± 0.056.
    (low, high) = axes.collections[-1].get_segments()[0][:, 1]  # type: ignore[attr-defined]
    assert (round(low, 3), round(high, 3)) == (0.769, 0.881)


def test_the_papers_bars_are_hatched_and_hollow(tmp_path: Path, drawn: list[Figure]) -> None:
    paths = [RESULTS / "pick_place.json", RESULTS / "paper" / "pick_place.json"]
    compare(paths, figure=tmp_path / "bars.png")
    ours, published = (bar.patches[0] for bar in bars(drawn[0])[:2])
    colours = {name: look.colour for name, look in method_looks(legend(drawn[0])[:-1]).items()}
    assert list(colours) == ["prime", "prime (plain)", "prime (no-pretraining)", "prime (greedy)"]
    assert to_hex(ours.get_facecolor()) == colours["prime"].lower()
    assert ours.get_hatch() is None
    assert to_hex(published.get_facecolor()) == "#ffffff"
    assert to_hex(published.get_edgecolor()) == colours["prime"].lower()
    assert "/" in (published.get_hatch() or "")


def test_runs_of_one_environment_are_one_task(tmp_path: Path, drawn: list[Figure]) -> None:
    environment = {"type": "robosuite/pick-place", "object": "milk"}
    ours = {"evaluation.prime": success(0.75)}
    runs = [
        write(tmp_path / name, name, ours, environment=environment)
        for name in ("pick-place-learned", "pick-place")
    ]
    # The last one tells that the first two are of one task.
    paths = [runs[0], RESULTS / "paper" / "pick_place.json", runs[1]]
    compare(paths, figure=tmp_path / "bars.svg")
    assert legend(drawn[0])[:2] == ["prime (learned)", "prime"]
    labels = [text.get_text() for text in drawn[0].axes[0].get_xticklabels()]
    assert labels == ["pick-place"]
    assert ("prime, published", 0.967) in heights(drawn[0])


def test_one_seed_has_no_spread_and_many_methods_have_looks(
    tmp_path: Path, drawn: list[Figure]
) -> None:
    names = ["_hidden", "a$b$c", *(f"m{number}" for number in range(12))]
    results = {f"evaluation.{name}": success(0.5, 0, seeds=1) for name in names}
    compare([write(tmp_path / "r.json", "$x_{", results)], figure=tmp_path / "many.png")
    assert legend(drawn[0]) == names
    assert not drawn[0].axes[0].collections
    looks = method_looks(names).values()
    assert len({(look.colour, look.marker, str(look.dashes)) for look in looks}) == len(names)
    width = drawn[0].legends[0].get_window_extent().width
    assert width <= drawn[0].bbox.width


def test_lines_against_the_number_of_demonstrations(tmp_path: Path, drawn: list[Figure]) -> None:
    paths = [
        with_counts(tmp_path / "a", "pick-place", (30, 5, 100)),
        with_counts(tmp_path / "b", "tidy-up", (10, 20)),
        RESULTS / "paper" / "tidy_up.json",
    ]
    compare(paths, figure=tmp_path / "data.png", against=Against.DEMONSTRATIONS)
    left, right = drawn[0].axes
    assert (left.get_title(), right.get_title()) == ("pick-place", "tidy-up")
    assert left.get_xscale() == "log" and left.get_xlabel() == "demonstrations"
    assert [text.get_text() for text in left.get_xticklabels()] == ["5", "30", "100"]
    lines = {str(line.get_label()): line for line in left.lines if line.get_label()[0] != "_"}
    assert list(lines) == ["prime", "bc-rnn"]  # the variant plain is no point of the line
    assert lines["prime"].get_xdata().tolist() == [5, 30, 100]  # type: ignore[union-attr]
    assert lines["prime"].get_ydata().tolist() == [0.8, 1 - 1 / 30, 0.99]  # type: ignore[union-attr]
    assert lines["prime"].get_linestyle() != lines["bc-rnn"].get_linestyle()
    assert len(left.collections) == 3  # spreads of prime: bc-rnn has one seed
    published = {str(line.get_label()): line for line in right.lines}["bc-rnn-ft, published"]
    assert published.get_xdata().tolist() == [30]  # type: ignore[union-attr]
    assert published.get_markerfacecolor() == "white"
    assert legend(drawn[0]) == ["prime", "bc-rnn", "bc-rnn-ft", "Gao et al. 2024"]


def test_drawing_changes_nothing_for_others(tmp_path: Path) -> None:
    settings, loaded = dict(matplotlib.rcParams), "matplotlib.pyplot" in sys.modules
    compare([RESULTS / "lift.json"], figure=tmp_path / "lift.pdf")
    assert dict(matplotlib.rcParams) == settings
    assert ("matplotlib.pyplot" in sys.modules) == loaded


PAPER = RESULTS / "paper" / "pick_place.json"
BEFORE = RESULTS / "nut_assembly_before.json"


@pytest.mark.parametrize(
    ("paths", "options", "complaint"),
    [
        ([PAPER], {"figure": "a.jpg"}, "found the suffix '.jpg'; it must be .png, .pdf, .svg"),
        ([PAPER], {"figure": "figure"}, "found no suffix; it must be .png, .pdf, .svg"),
        ([RESULTS / "lift_human_v1.4.1.json"], {"figure": "a.png"}, "no policy was evaluated"),
        ([PAPER, PAPER], {"figure": "a.png"}, "pick_place.json: is named twice"),
        (
            [RESULTS / "nut_assembly.json", BEFORE],
            {"figure": "a.png"},
            f"{BEFORE}: its name is 'nut-assembly', as that of {RESULTS / 'nut_assembly.json'}: a",
        ),
        (
            [PAPER],
            {"figure": "a.png", "method": ["bc"]},
            "--method 'bc': there is no such method. There are: 'prime', 'prime (no-pretr",
        ),
        ([PAPER], {"method": ["prime"]}, "--method: it says what a figure shows; name the"),
        (
            [PAPER],
            {"against": Against.TRANSITIONS},
            "--against: it says what a figure shows; name the",
        ),
        (
            [RESULTS / "pick_place.json", PAPER],
            {"figure": "a.png", "against": Against.DEMONSTRATIONS},
            "nothing to draw against demonstrations: it takes policies that were evaluated with "
            "two numbers of them at least, such as those of an experiment whose variants change "
            "demonstrations.count",
        ),
    ],
)
def test_what_cannot_be_drawn(
    tmp_path: Path, paths: list[Path], options: dict[str, Any], complaint: str
) -> None:
    if "figure" in options:
        options = {**options, "figure": tmp_path / options["figure"]}
    with pytest.raises(PrimeError) as caught:
        compare(paths, **options)
    assert complaint in str(caught.value)
    assert not list(tmp_path.iterdir())


def test_a_folder_is_no_figure(tmp_path: Path) -> None:
    (tmp_path / "a.png").mkdir()
    with pytest.raises(PrimeError, match=r"--figure .*a\.png: is a folder; name a file"):
        compare([PAPER], figure=tmp_path / "a.png")


@pytest.mark.parametrize(
    ("results", "complaint"),
    [
        ({"evaluation.prime": success(1.5)}, "is 1.5 ± 0.05: rates lie between 0 and 1"),
        ({"evaluation.prime": success(float("nan"))}, "is nan ± 0.05: rates lie between"),
    ],
)
def test_rates_that_are_none(tmp_path: Path, results: dict[str, Any], complaint: str) -> None:
    path = write(tmp_path / "r.json", "mine", results)
    with pytest.raises(PrimeError) as caught:
        compare([path], figure=tmp_path / "a.png")
    assert str(caught.value).startswith(f"{path}: the success of 'prime' ")
    assert complaint in str(caught.value)


@pytest.mark.parametrize("count", [0, -5, 2.5, True, "five", 10**400])
def test_numbers_that_are_none(tmp_path: Path, count: Any) -> None:
    results = {"demonstrations": {"demonstrations": count}, "evaluation.prime": success(0.5)}
    path = write(tmp_path / "r.json", "mine", results)
    with pytest.raises(PrimeError) as caught:
        compare([path], figure=tmp_path / "a.png", against=Against.DEMONSTRATIONS)
    assert (
        str(caught.value)
        == f"{path}: found {count!r} demonstrations; it must be a number from 1 on"
    )


def test_a_variant_that_is_called_like_a_run(tmp_path: Path) -> None:
    rate = {"evaluation.prime": success(0.5)}
    task = write(tmp_path / "a", "lift", rate, variants={"greedy": rate})
    other = write(tmp_path / "b", "lift-greedy", rate, task="lift")
    with pytest.raises(PrimeError) as caught:
        compare([task, other], figure=tmp_path / "a.png")
    assert str(caught.value) == (
        f"{other} and {task}, variant 'greedy' both have 'prime (greedy)': a figure cannot tell "
        "them apart"
    )


def test_two_of_a_method_with_the_same_number(tmp_path: Path) -> None:
    path = with_counts(tmp_path / "r.json", "mine", (5, 10, 10))
    data = json.loads(path.read_text())
    data["variants"]["other"] = data["variants"]["n10"]
    path.write_text(json.dumps(data))
    with pytest.raises(PrimeError) as caught:
        compare([path], figure=tmp_path / "a.png", against=Against.DEMONSTRATIONS)
    assert str(caught.value) == (
        f"{path}, variant 'other' and {path}, variant 'n10' both have 'prime' with 10 "
        "demonstrations: a figure cannot tell them apart"
    )
