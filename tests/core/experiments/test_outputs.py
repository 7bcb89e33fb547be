"""What lies in a run's folder belongs to the experiment.yaml in it; questions write nothing."""

import json
import os
import shutil
import threading
from collections.abc import Callable
from pathlib import Path

import pytest

from prime_core.cli.show import show
from prime_core.cli.validate import validate
from prime_core.datasets.read import read_dataset
from prime_core.experiments.experiment import Experiment
from prime_core.experiments.parse_dataset import open_run
from prime_core.experiments.run_folder.lock import alone_in
from prime_core.experiments.run_folder.outputs import set_aside

from .conftest import TOY

Run = Callable[..., None]
Make = Callable[..., Experiment]
OTHER = ("seed=5", "demonstrations.count=1")


def tree(folder: Path) -> dict[str, tuple[int, int]]:
    """Return size and time of change of all that lies in a folder."""
    paths = [folder, *folder.rglob("*")]
    return {str(p): (p.lstat().st_size, p.lstat().st_mtime_ns) for p in paths if p.exists()}


def outputs(folder: Path) -> dict[str, bytes]:
    """Return what a run leaves for people: the text, or where a link leads."""
    return {
        path.name: os.readlink(path).encode() if path.is_symlink() else path.read_bytes()
        for path in folder.iterdir()
        if path.name not in ("stages", "earlier", ".lock")
    }


@pytest.fixture
def folder(finished: Path, tmp_path: Path) -> Path:
    """Return a copy of the finished toy run, in the test's folder."""
    shutil.copytree(finished, tmp_path / "toy", symlinks=True)
    return tmp_path / "toy"


def test_results_of_other_settings_are_set_aside_whole(
    folder: Path, prime_run: Run, capsys: pytest.CaptureFixture[str]
) -> None:
    before = outputs(folder)
    names = {"experiment.yaml", "results.json", "trials-motor.json", "trials-calls.json"}
    assert set(before) == {*names, "dataset", "timelines"}
    prime_run(*OTHER, until="demonstrations")
    told = capsys.readouterr().out
    assert "held results of other settings (seed, demonstrations.count)" in told
    assert "they are under earlier/1 now" in told
    assert set(outputs(folder)) == {"experiment.yaml", "results.json"}
    assert json.loads((folder / "results.json").read_text())["results"] == {
        "demonstrations": {"demonstrations": 1, "left_out": {}}
    }
    earlier = folder / "earlier" / "1"
    assert outputs(earlier) == before
    assert len(read_dataset(earlier / "dataset").demonstrations) == 2
    # What is asked of either folder is answered from its own experiment.
    assert open_run(folder).idm.missing()
    assert not open_run(earlier).idm.missing()
    assert open_run(earlier).config.seed == 0

    prime_run()  # back: nothing is done again, and each experiment has one place
    again = outputs(folder)
    for name in set(before) - {"results.json"}:
        assert again[name] == before[name]
    found, expected = json.loads(again["results.json"]), json.loads(before["results.json"])
    for key in ("results", "timing", "variants"):
        assert found[key] == expected[key]
    prime_run(*OTHER, until="demonstrations")
    assert sorted(path.name for path in (folder / "earlier").iterdir()) == ["1", "2"]


@pytest.mark.parametrize("setting", ["compute.workers=1", "compute.device=cpu"])
def test_where_a_run_computes_sets_nothing_aside(
    folder: Path, prime_run: Run, setting: str
) -> None:
    before = outputs(folder)
    prime_run(setting)
    assert not (folder / "earlier").exists()
    assert {**outputs(folder), "experiment.yaml": b""} == {**before, "experiment.yaml": b""}


def test_results_of_a_part_of_the_experiment_are_its_own(
    folder: Path, prime_run: Run, capsys: pytest.CaptureFixture[str]
) -> None:
    before = json.loads((folder / "results.json").read_text())
    more = ("variants.high={parser: {alpha: 1e-2}, policies: {calls: {}}}",)
    prime_run(*more, "policies.third={type: toy/repeats}", until="demonstrations")
    assert not (folder / "earlier").exists()
    found = json.loads((folder / "results.json").read_text())["results"]
    assert found.items() >= before["results"].items()
    prime_run(*more, until="demonstrations")  # less than before is another experiment
    assert "settings (policies.third)" in capsys.readouterr().out
    assert (folder / "earlier" / "1" / "experiment.yaml").exists()


def test_setting_aside_goes_on_after_a_kill(folder: Path, prime_run: Run) -> None:
    before = outputs(folder)
    half = folder / "earlier" / "1"
    half.mkdir(parents=True)
    (folder / "results.json").rename(half / "results.json")
    prime_run(*OTHER, until="demonstrations")
    assert outputs(half) == before
    assert not (folder / "earlier" / "2").exists()


def test_results_of_nobody_are_not_taken_for_ours(folder: Path, prime_run: Run) -> None:
    before = outputs(folder)
    (folder / "experiment.yaml").unlink()
    prime_run(until="demonstrations")
    earlier = outputs(folder / "earlier" / "1")
    assert {**before, "experiment.yaml": b""} == {**earlier, "experiment.yaml": b""}
    assert b"is not known" in earlier["experiment.yaml"]


def test_a_folder_of_an_earlier_prime_is_known_by_its_settings(
    folder: Path, prime_run: Run
) -> None:
    path = folder / "experiment.yaml"
    path.write_text(path.read_text().partition("\n")[2])
    prime_run("compute.workers=1")
    assert not (folder / "earlier").exists()
    path.write_text(path.read_text().partition("\n")[2])
    prime_run(*OTHER, until="demonstrations")
    assert (folder / "earlier" / "1" / "results.json").exists()


def test_a_copy_that_holds_the_things_themselves_is_set_aside_too(
    finished: Path, tmp_path: Path, prime_run: Run
) -> None:
    folder = tmp_path / "toy"
    shutil.copytree(finished, folder)  # as cp -rL does
    assert (folder / "dataset").is_dir() and not (folder / "dataset").is_symlink()
    prime_run()
    prime_run(*OTHER, until="demonstrations")
    assert not (folder / "dataset").exists()
    assert len(read_dataset(folder / "earlier" / "1" / "dataset").demonstrations) == 2
    prime_run()
    (folder / "dataset").unlink()
    shutil.copytree(folder / "earlier" / "1" / "dataset", folder / "dataset")
    set_aside(folder)  # where one of the same experiment is
    assert len(read_dataset(folder / "earlier" / "1" / "dataset").demonstrations) == 2


def test_questions_write_nothing(
    folder: Path, tmp_path: Path, toy_plugins: None, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "toy.yaml"
    file.write_text(TOY)
    before = tree(tmp_path)
    show(file, [], tmp_path / "new" / "runs")
    show(file, [], tmp_path)
    show(file, list(OTHER), tmp_path)
    assert "are those of other settings" in capsys.readouterr().out
    validate(file, [])
    open_run(folder)
    assert tree(tmp_path) == before
    assert not (tmp_path / "new").exists()


def test_a_second_run_in_a_folder_waits_for_the_first(tmp_path: Path) -> None:
    said: list[str] = []
    ended = threading.Event()

    def second() -> None:
        with alone_in(tmp_path / "run", said.append):
            ended.set()

    with alone_in(tmp_path / "run", said.append):
        assert said == []
        thread = threading.Thread(target=second)
        thread.start()
        assert not ended.wait(0.5)
    assert ended.wait(10)
    thread.join()
    (line,) = said
    assert f"another run is at work in {tmp_path / 'run'} (process {os.getpid()} on " in line
    assert line.endswith("waiting until it has ended")
