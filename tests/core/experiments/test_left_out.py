"""One bad demonstration does not end the others: it is listed, counted and, if asked, an error."""

import io
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from rich.console import Console

from prime_core.checks.samples import DESCRIPTION
from prime_core.cli.parse import parse
from prime_core.datasets.read import read_dataset
from prime_core.errors import DatasetError
from prime_core.experiments.experiment import Experiment
from prime_core.experiments.parse_dataset import parse_foreign
from prime_core.experiments.results.figures import figures_of
from prime_core.experiments.results.gathering import write_results
from prime_core.experiments.running import run_experiment

from ..datasets.samples import DATA

Make = Callable[..., Experiment]

BROKEN = ("demonstrations.count=4", "demonstrations.broken=[1, 3]", "evaluation.runner=plain")
REASONS = {"1": "climb 1 was not recorded", "3": "climb 3 was not recorded"}


def test_an_experiment_goes_on_with_the_others(toy: Make) -> None:
    job, shown = toy(*BROKEN), io.StringIO()
    run_experiment(job, Console(file=shown, width=200))
    assert "  demonstration 3 left out: climb 3 was not recorded\n" in shown.getvalue()
    found = write_results(job, ["prime", "run"])
    results = found["results"]
    assert results["demonstrations"] == {"demonstrations": 2, "left_out": REASONS}
    assert results["parsing"]["demonstrations"] == 2
    assert results["replay"]["with_other"] | {"mean_steps": 0} == {
        "success": 1.0,
        "mean_steps": 0,
        "failed": [],
    }
    assert results["evaluation.motor"]["success"]["mean"] == 1.0
    assert figures_of(found)["demonstrations left out"] == "2 of 4"
    assert len(read_dataset(job.export.folder / "dataset").demonstrations) == 2


def test_strict_is_an_error_whether_done_before_or_not(toy: Make) -> None:
    strict = toy(*BROKEN, "strict=true")
    text = (
        "2 of 4 demonstrations cannot be used and 'strict' asks for all:\n"
        "  1: climb 1 was not recorded\n  3: climb 3 was not recorded"
    )
    for _ in range(2):
        with pytest.raises(DatasetError) as caught:
            run_experiment(strict, Console(quiet=True))
        assert str(caught.value) == text
    # What is strict is part of no stage.
    assert not toy(*BROKEN).demonstrations.missing()


def test_no_demonstration_at_all_is_an_error(toy: Make) -> None:
    job = toy("demonstrations.count=1", "demonstrations.broken=[0]")
    with pytest.raises(DatasetError) as caught:
        run_experiment(job, Console(quiet=True))
    assert str(caught.value) == (
        "1 of 1 demonstrations cannot be used:\n  0: climb 0 was not recorded"
    )


def test_prime_parse_lists_what_it_left_out(
    toy: Make, climbs: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    job = toy()
    run_experiment(job, Console(quiet=True), "idm")
    reason = f"{climbs}/{DATA}: column 'action' holds NaN or infinity in episode 1, frame 2; all"
    with pytest.raises(DatasetError) as caught:
        parse_foreign(climbs, job.folder, tmp_path / "out", strict=True)
    start = "1 of 3 demonstrations cannot be used and 'strict' asks for all:\n  1: "
    assert str(caught.value).startswith(start + reason)
    assert not (tmp_path / "out").exists()
    parse(climbs, job.folder, tmp_path / "out")
    said = " ".join(capsys.readouterr().out.split())
    assert "2 demonstrations, " in said and "; 1 left out. Written to " in said
    assert f"0: rise 2: rise 1 left out: {reason}" in said
    assert read_dataset(tmp_path / "out").segments is not None


def test_a_source_that_cannot_be_opened_is_told_so(toy: Make, tmp_path: Path) -> None:
    job = toy()
    run_experiment(job, Console(quiet=True), "idm")
    for source, text in (
        (tmp_path / "none", "there is no such data set"),
        (tmp_path / ("x" * 300), "cannot be read: File name too long"),
    ):
        with pytest.raises(DatasetError) as caught:
            parse_foreign(source, job.folder, tmp_path / "out")
        assert str(caught.value) == f"{source}: {text}"


def test_a_scene_without_objects_goes_through(toy: Make, tmp_path: Path) -> None:
    alone = "environment.with_objects=false"
    job = toy(alone, "evaluation.runner=plain")
    run_experiment(job, Console(quiet=True))
    results = write_results(job, ["prime", "run"])["results"]
    assert results["evaluation.calls"]["success"]["mean"] == 1.0
    description = replace(DESCRIPTION, objects=(), affordances=())
    found = read_dataset(job.export.folder / "dataset", description)
    objects = found.demonstrations[0].observations.environment_state
    assert objects is not None and objects.shape[1] == 0
    again = parse_foreign(job.export.folder / "dataset", job.folder, tmp_path / "out")
    assert len(again.parsed) == 2 and not again.left_out
