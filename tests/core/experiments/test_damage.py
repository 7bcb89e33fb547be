"""Files of a run that were damaged are noticed, and made anew or named."""

import json
import os
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


def exchange(path: Path) -> None:
    """Let an index say that the first item gave what the last one gave."""
    lines = [json.loads(line) for line in path.read_bytes().splitlines()]
    lines[0] = {**lines[-1], "#key": lines[0]["#key"]}
    path.write_text("".join(json.dumps(line) + "\n" for line in lines))


def unseal(path: Path) -> None:
    path.write_bytes(path.read_bytes().replace(b'"seal"', b'"sael"'))


def figures(folder: Path) -> tuple[Any, ...]:
    found = read_results(folder)
    trials = [(folder / f"trials-{name}.json").read_bytes() for name in ("motor", "calls")]
    return found["results"], found["variants"], *trials


DAMAGE = [
    ("Collection", "data/*.data", cut, "collection"),
    ("Collection", "data/*.data", flip, "collection"),
    ("Collection", "data/*.data", empty, "collection"),
    ("Collection", "data/*.data", Path.unlink, "collection"),
    ("Collection", "data/*.jsonl", unseal, "collection"),
    ("Demonstrations", "data/*.data", flip, "demonstrations"),
    ("Demonstrations", "*-info.jsonl", exchange, "demonstrations"),
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


def rewrite_index(folder: Path, stage: str, **info: Any) -> None:
    """Let the index of a stage say something else of its first item."""
    (path,) = (folder / "stages").glob(f"*{stage}.compute*/*/*-info.jsonl")
    first, *others = path.read_bytes().splitlines(keepends=True)
    line = json.dumps({"#key": json.loads(first)["#key"], **info})
    path.write_bytes(line.encode() + b"\n" + b"".join(others))


CANARY = b"cbuiltins\nopen\n(S'%s'\nS'w'\ntR."
"""A pickle that makes a file."""


def test_an_index_cannot_have_a_file_unpickled(
    folder: Path, prime_run: Run, capsys: pytest.CaptureFixture[str]
) -> None:
    before, canary = figures(folder), folder / "canary"
    rewrite_index(folder, "IdmTraining", **{"#type": "Pickle", "filename": "data/evil.pkl"})
    (idm,) = (folder / "stages").glob("*IdmTraining.compute*/*")
    (idm / "data").mkdir(exist_ok=True)
    (idm / "data" / "evil.pkl").write_bytes(CANARY % str(canary).encode())
    with pytest.raises(DamagedError) as caught:
        open_run(folder).idm.load()
    assert str(caught.value) == (
        f"{idm}: 'model' of stage 'idm' is damaged: it cannot be read (LookupError: its index "
        "names 'Pickle' of 'data/evil.pkl'). 'prime run' makes it anew; or remove the folder"
    )
    prime_run()
    assert "1 models of idm were damaged, and are made anew" in capsys.readouterr().out
    assert figures(folder) == before
    assert not canary.exists()


@pytest.mark.parametrize("kind", ["Pickle", "NumpyArray", "Json"])
def test_an_index_cannot_have_a_file_outside_of_the_stage_read_or_removed(
    folder: Path, prime_run: Run, kind: str
) -> None:
    before, other = figures(folder), folder.parent / "precious.json"
    other.write_text("{}")
    (stage,) = (folder / "stages").glob("*Collection.compute*/*")
    place: dict[str, Any] = {"filename": os.path.relpath(other, stage)}
    if kind == "Json":
        place |= {"offset": 0, "length": 2}
    rewrite_index(folder, "Collection", **{"#type": kind, **place})
    prime_run()
    assert other.read_text() == "{}"
    assert figures(folder) == before


@pytest.mark.parametrize(
    "change",
    [
        {"made_by": ["prime_core"]},
        {"made_by": {"prime_core": 1}},
        {"begun": "today"},
        {"kept_for": 3},
        {"stage": None},
    ],
)
def test_a_mark_of_code_with_strange_values_names_itself(
    folder: Path, toy: Make, change: dict[str, Any]
) -> None:
    path = toy(folder=folder).idm.folder / "code.json"
    path.write_text(json.dumps({**json.loads(path.read_text()), **change}))
    with pytest.raises(DamagedError) as caught:
        toy(folder=folder)
    assert str(caught.value) == (
        f"{path} is damaged: remove it, then what lies beside it counts as made by unknown code"
    )


@pytest.mark.parametrize("header", ["x: 2001-99-99\n", "x: " + "[" * 5000 + "\n"])
def test_an_experiment_that_no_yaml_reader_takes_is_one_of_others(
    folder: Path, prime_run: Run, header: str
) -> None:
    path = folder / "experiment.yaml"
    path.write_text(header + path.read_text())
    before = figures(folder)
    prime_run()
    assert figures(folder) == before
    assert open_run(folder).config.name == "toy"
