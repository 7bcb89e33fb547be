"""Files of a run that were damaged are noticed, and made anew or named."""

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from prime_core.errors import DamagedError, PrimeError
from prime_core.experiments.experiment import Experiment
from prime_core.experiments.parse_dataset import open_run
from prime_core.experiments.results.comparison import read_results

Run = Callable[..., None]
Make = Callable[..., Experiment]


@pytest.fixture
def folder(finished: Path, tmp_path: Path) -> Path:
    """Return a copy of the finished toy run, in the test's folder."""
    shutil.copytree(finished, tmp_path / "toy", symlinks=True)
    return tmp_path / "toy"


def cut(path: Path, size: int = 1000) -> None:
    path.write_bytes(path.read_bytes()[:size])


def flip(path: Path) -> None:
    data = bytearray(path.read_bytes())
    data[len(data) // 2] ^= 1
    path.write_bytes(data)


def empty(path: Path) -> None:
    path.write_bytes(b"")


def spoil(path: Path) -> None:
    path.write_bytes(b"\x00\xff{not this" * 50)


def garble(path: Path) -> None:
    """Write half a line, and a whole one after it, as two processes of one number would."""
    lines = path.read_bytes().splitlines(keepends=True)
    path.write_bytes(lines[0][: len(lines[0]) // 2] + b"\n" + b"".join(lines))


def figures(folder: Path) -> tuple[Any, ...]:
    found = read_results(folder)
    trials = [(folder / f"trials-{name}.json").read_bytes() for name in ("motor", "calls")]
    return found["results"], found["variants"], *trials


DAMAGE = [
    ("Collection", "data/*.data", cut, "collection"),
    ("Collection", "data/*.data", flip, "collection"),
    ("Collection", "data/*.data", empty, "collection"),
    ("Collection", "data/*.data", Path.unlink, "collection"),
    ("Demonstrations", "data/*.data", flip, "demonstrations"),
    ("Demonstrations", "*-info.jsonl", cut, ""),
    ("Collection", "*-info.jsonl", garble, ""),
    ("Collection", "*-info.jsonl", spoil, ""),
    ("Evaluation", "*-info.jsonl", flip, ""),
    ("Collection", "uid.yaml", spoil, ""),
    ("Collection", "uid.yaml", lambda path: path.write_text("seed: 7\n"), ""),
    ("Collection", "config.yaml", empty, ""),
    ("Collection", "inflight.db", spoil, ""),
    ("IdmTraining", "model/done.txt", flip, "idm"),
    ("IdmTraining", "model/done.txt", Path.unlink, "idm"),
    ("PolicyTraining", "seed-1/0.txt", flip, "policy"),
    ("Export", "dataset/data/**/*.parquet", flip, "export"),
    ("Export", "dataset/meta/info.json", Path.unlink, "export"),
    ("Export", "timelines/all.png", cut, "export"),
]


@pytest.mark.parametrize(("stage", "files", "damage", "told"), DAMAGE)
def test_what_was_damaged_is_made_anew(
    folder: Path,
    prime_run: Run,
    capsys: pytest.CaptureFixture[str],
    stage: str,
    files: str,
    damage: Callable[[Path], None],
    told: str,
) -> None:
    before = figures(folder)
    found = [
        path
        for place in (folder / "stages").glob(f"*{stage}.compute*/*")
        for path in place.glob(files)
    ]
    assert found
    for path in found:
        damage(path)
    prime_run()
    text = capsys.readouterr().out
    if told:
        assert "were damaged, and are made anew" in text
        assert told in text
    assert figures(folder) == before
    prime_run()  # and all is well
    assert "were damaged" not in capsys.readouterr().out


@pytest.mark.parametrize("damage", [cut, flip, empty, spoil, Path.unlink])
@pytest.mark.parametrize("name", ["results.json", "trials-motor.json"])
def test_damaged_results_are_written_anew(
    folder: Path, prime_run: Run, name: str, damage: Callable[[Path], None]
) -> None:
    before = figures(folder)
    damage(folder / name)
    prime_run()
    assert figures(folder) == before
    assert not (folder / "earlier").exists()


def test_damaged_results_are_not_compared(folder: Path) -> None:
    path = folder / "results.json"
    changed = path.read_text().replace('"transitions": ', '"transitions": 1', 1)
    assert changed != path.read_text()
    path.write_text(changed)
    with pytest.raises(PrimeError, match=r"results\.json: is damaged, or was edited: 'prime run'"):
        read_results(folder)
    part = json.loads(changed)
    del part["checksum"]
    path.write_text(json.dumps(part))
    assert read_results(folder) == part  # who means it says so


@pytest.mark.parametrize("damage", [lambda path: cut(path, 700), flip, empty, spoil])
def test_a_damaged_experiment_is_named_and_written_anew(
    folder: Path, prime_run: Run, damage: Callable[[Path], None]
) -> None:
    before = figures(folder)
    damage(folder / "experiment.yaml")
    with pytest.raises(PrimeError, match=r"experiment\.yaml"):
        open_run(folder)
    prime_run()
    assert open_run(folder).config.name == "toy"
    assert figures(folder) == before


def test_a_damaged_mark_of_code_names_itself(folder: Path, toy: Make) -> None:
    path = toy(folder=folder).idm.folder / "code.json"
    cut(path, 100)
    with pytest.raises(DamagedError, match=r"code\.json is damaged: remove it"):
        toy(folder=folder)
    path.unlink()
    assert not toy(folder=folder).idm.missing()


def test_who_only_reads_is_told_what_is_damaged(folder: Path, toy: Make) -> None:
    job = toy(folder=folder)
    flip(job.idm.folder / "model" / "done.txt")
    with pytest.raises(DamagedError) as caught:
        open_run(folder).idm.load()
    assert str(caught.value) == (
        f"{job.idm.folder}: 'model' of stage 'idm' is damaged: model/done.txt was changed. 'prime "
        "run' makes it anew; or remove the folder"
    )
