"""What trainings cost stands beside what policies reach."""

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from prime_core.cli.show import show
from prime_core.experiments.results.comparison import comparison_rows, read_results
from prime_core.experiments.results.figures import training_cost
from prime_core.experiments.stages.policy import PolicyTraining

Run = Callable[..., None]
DOCS = Path(__file__).parents[3] / "docs" / "results"


@pytest.fixture
def folder(finished: Path, tmp_path: Path) -> Path:
    """Return a copy of the finished toy run, in the test's folder."""
    shutil.copytree(finished, tmp_path / "toy", symlinks=True)
    return tmp_path / "toy"


def results(folder: Path) -> dict[str, Any]:
    return dict(json.loads((folder / "results.json").read_text()))


@pytest.mark.parametrize(
    ("parameters", "words"),
    [
        (None, "254 s and 1.7 GB a seed"),
        (174_345, "254 s and 1.7 GB a seed, 174k parameters"),
        (999_700, "254 s and 1.7 GB a seed, 1.0M parameters"),
        (4_640_000, "254 s and 1.7 GB a seed, 4.6M parameters"),
    ],
)
def test_costs_in_words(parameters: int | None, words: str) -> None:
    timing = {"items": 3, "process_seconds": 762.05, "peak_megabytes": 1651}
    assert training_cost(timing, parameters) == words


def test_costs_of_results_that_are_kept_stand_beside_them() -> None:
    paths = [DOCS / "pick_place.json", DOCS / "paper" / "pick_place.json"]
    ours, paper = map(read_results, paths)
    rows = comparison_rows([ours, paper])
    names = [row[0] for row in rows]
    for stage, row in (("policy.prime", ""), ("greedy/policy.prime", "greedy: ")):
        timing, place = ours["timing"][stage], names.index(f"{row}prime: training")
        seconds = round(timing["process_seconds"] / 3)
        assert rows[place][1].startswith(f"{seconds} s and ")
        assert rows[place][2] == "-"
        assert names[place - 1].startswith(f"{row}prime: ")
    assert "plain: prime: training" not in names  # it is that of the experiment


def with_weights(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Let the checkpoints of policies over calls be networks of 3 x 4 + 5 numbers."""
    from safetensors.numpy import save_file

    path = folder / "weights.safetensors"
    save_file({"a": np.zeros((3, 4)), "b": np.zeros(5)}, path)
    found = PolicyTraining.checkpoints

    def checkpoints(self: PolicyTraining, seed: str) -> list[Path]:
        return [path] if self.policy["type"] == "toy/rises-to" else found(self, seed)

    monkeypatch.setattr(PolicyTraining, "checkpoints", checkpoints)


def test_a_run_of_an_earlier_prime_is_told_its_parameters(
    folder: Path, prime_run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = results(folder)
    assert before["environment"]["type"] == "toy/point-mass"
    assert before["parameters"] == {}  # the toys leave no safetensors
    earlier = {key: before[key] for key in before if key not in ("parameters", "checksum")}
    earlier |= {"command": ["an", "earlier"], "commit": "0" * 40}
    (folder / "results.json").write_text(json.dumps(earlier))
    with_weights(folder, monkeypatch)
    prime_run()
    found = results(folder)
    assert found["parameters"] == {"policy.calls": 17}
    # Nothing was done: what did it is still named.
    assert (found["command"], found["commit"]) == (["an", "earlier"], "0" * 40)
    assert found["results"] == before["results"]
    rows = dict(comparison_rows([read_results(folder)]))
    assert rows["calls: training"].endswith(" GB a seed, 17 parameters")
    assert rows["motor: training"].endswith(" GB a seed")


def test_show_tells_what_trainings_cost(
    folder: Path, tmp_path: Path, toy_plugins: None, capsys: pytest.CaptureFixture[str]
) -> None:
    from .conftest import TOY

    (tmp_path / "toy.yaml").write_text(TOY)
    show(tmp_path / "toy.yaml", [], tmp_path)
    assert "GB" in capsys.readouterr().out
    (folder / "results.json").write_text("{")
    show(tmp_path / "toy.yaml", [], tmp_path)
    assert "GB" not in capsys.readouterr().out
