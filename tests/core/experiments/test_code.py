"""The code that makes a stage: what is other code, and what becomes of what it made."""

import importlib
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace

import pytest
from rich.console import Console

from prime_core.errors import PrimeError
from prime_core.experiments.experiment import Experiment
from prime_core.experiments.run_folder.code import Code, code_of
from prime_core.experiments.run_folder.code_mark import read_mark, write_mark
from prime_core.experiments.stages.stage import Stage

MODULE = '''
from .depth import deep

class Grasp:
    """Grasps."""

    width: float = 0.08
    """Of the fingers [m]."""

    def close(self) -> float:
        from .late import HELD

        return deep(self.width) + HELD
'''
FILES = {
    "__init__.py": "",
    "grasp.py": MODULE,
    "depth.py": "def deep(x):\n    return x + 1\n",
    "late.py": "HELD = 1\n",
    "push.py": "class Push: ...\n",
}


@pytest.fixture
def code(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[..., Code]]:
    """Write a package with some files changed, and return the code of a class in it."""
    monkeypatch.syspath_prepend(tmp_path)
    names = []

    def make(start: str = "grasp", cls: str = "Grasp", **changed: str) -> Code:
        names.append(f"a_pack_{tmp_path.name}_{len(names)}".replace("-", "_"))
        folder = tmp_path / names[-1]
        folder.mkdir()
        for name, text in (FILES | {f"{key}.py": text for key, text in changed.items()}).items():
            (folder / name).write_text(text)
        importlib.invalidate_caches()
        module = importlib.import_module(f"{names[-1]}.{start}")
        found = code_of([getattr(module, cls)])
        return {name.removeprefix(names[-1]): digest for name, digest in found.items()}

    yield make
    for name in [name for name in sys.modules if name.partition(".")[0] in names]:
        del sys.modules[name]


def test_code_is_what_a_class_imports_inside_its_package(code: Callable[..., Code]) -> None:
    assert set(code()) == {".grasp", ".depth", ".late"}


@pytest.mark.parametrize(
    "text",
    [
        MODULE.replace('"""Grasps."""', '"""Grasps things."""'),
        MODULE.replace('    """Of the fingers [m]."""\n', ""),
        "# A note.\n" + MODULE.replace("deep(self.width) + HELD", "(deep(\n self.width) + HELD)"),
    ],
)
def test_words_and_layout_are_no_other_code(code: Callable[..., Code], text: str) -> None:
    assert code(grasp=text) == code()


@pytest.mark.parametrize(
    ("changed", "name"),
    [
        ({"grasp": MODULE.replace("0.08", "0.07")}, ".grasp"),
        ({"depth": "def deep(x):\n    return x + 2\n"}, ".depth"),
        ({"late": "HELD = 2\n"}, ".late"),
        ({"late": "HELD = 'x'\n"}, ".late"),
    ],
)
def test_what_is_done_otherwise_is_other_code(
    code: Callable[..., Code], changed: dict[str, str], name: str
) -> None:
    before, after = code(), code(**changed)
    assert {key for key in before if before[key] != after[key]} == {name}


def test_what_a_class_does_not_use_is_none_of_its_code(code: Callable[..., Code]) -> None:
    assert code(push="class Push:\n    far = 1\n") == code()


def test_what_a_class_inherits_is_its_code(code: Callable[..., Code]) -> None:
    child = "from .grasp import Grasp\n\n\nclass Wide(Grasp): ...\n"
    assert set(code("wide", "Wide", wide=child)) == {".wide", ".grasp", ".depth", ".late"}


@pytest.mark.filterwarnings("error")  # a library's text is its own affair
def test_installed_libraries_are_none_of_its_code_wherever_they_lie(
    code: Callable[..., Code], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    number = tmp_path.name.replace("-", "_")
    for folder, name in ((tmp_path / "other" / "site-packages", "library"), (tmp_path, "lab")):
        folder.mkdir(parents=True, exist_ok=True)
        monkeypatch.syspath_prepend(folder)
        (folder / f"{name}_{number}.py").write_text("PATTERN = '\\s'\n")
    uses = "".join(f"        import {name}_{number}\n" for name in ("library", "lab"))
    found = code(
        grasp=MODULE.replace("        from .late import HELD\n", f"{uses}        HELD = 1\n")
    )
    assert set(found) == {".grasp", ".depth", f"lab_{number}"}


def other_code(stage: Stage, module: str) -> None:
    """Mark a stage as made by code in which a module was another."""
    folder = stage.folder
    mark = read_mark(folder)
    assert mark is not None
    assert module in mark.made_by
    mark.made_by[module] = "0" * 12
    write_mark(folder, mark)


RISE = "tests.core.execution.toys"
Run = Callable[..., None]
Make = Callable[..., Experiment]


def made(job: Experiment) -> dict[str, float]:
    """Return when the first item of each stage of rollouts was made."""
    return {
        name: stage.results()[0]["timing"]["seconds"]
        for name, stage in job.stages.items()
        if name in ("demonstrations", "collection", "idm")
    }


def test_code_is_marked_and_the_same_code_goes_on(
    prime_run: Run, toy: Make, tmp_path: Path
) -> None:
    prime_run(until="idm")
    job = toy(folder=tmp_path / "toy")
    mark = read_mark(job.collection.folder)
    assert mark is not None
    assert RISE in mark.made_by
    assert "prime_core.collection.episode" in mark.made_by
    assert not any(name.startswith("prime_core.cli") for name in mark.made_by)
    before = made(job)
    prime_run(until="idm")
    assert made(toy(folder=tmp_path / "toy")) == before


def test_what_other_code_made_is_made_anew_and_kept_beside(
    prime_run: Run, toy: Make, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "toy"
    prime_run(until="idm")
    first = toy(folder=folder)
    before = made(first)
    other_code(first.collection, RISE)
    assert toy(folder=folder).collection.other_code() == [RISE]
    capsys.readouterr()
    prime_run(until="idm")  # nobody is there to be asked
    told = capsys.readouterr().out
    assert f"! collection was made by other code: {RISE}" in told
    assert "made anew" in told
    assert "--keep" in told
    again = toy(folder=folder)
    after = made(again)
    assert after["demonstrations"] == before["demonstrations"]
    assert after["collection"] != before["collection"]
    assert after["idm"] != before["idm"]  # what depends on it, too
    assert first.collection.folder != again.collection.folder
    assert not first.collection.missing()  # nothing was removed
    # When the first code is there again, so are its results.
    other_code(again.collection, RISE)
    mark = read_mark(first.collection.folder)
    assert mark is not None
    mark.made_by[RISE] = first.collection.code_now()[RISE]
    write_mark(first.collection.folder, mark)
    assert made(toy(folder=folder)) == before


def test_what_other_code_made_is_kept_on_a_word_and_shown(
    prime_run: Run, toy: Make, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "toy"
    prime_run(until="idm")
    first = toy(folder=folder)
    before = made(first)
    for stage in (first.collection, first.idm):
        other_code(stage, RISE)
    prime_run(until="idm", keep=True)
    assert made(toy(folder=folder)) == before
    results = (folder / "results.json").read_text()
    assert '"other_code": {\n  "collection": [\n   "tests.core.execution.toys"' in results
    capsys.readouterr()
    prime_run(until="idm")  # the word holds as long as the code is this one
    assert made(toy(folder=folder)) == before
    assert "made by other code" not in capsys.readouterr().out
    prime_run(until="idm", remake=True)
    assert made(toy(folder=folder)) != before
    with pytest.raises(PrimeError, match="--keep and --remake: say one of them"):
        prime_run(keep=True, remake=True)


def test_code_is_never_mixed_in_one_stage(toy: Make) -> None:
    job = toy()
    job.collection.compute(["0"])
    other_code(job.collection, RISE)
    with pytest.raises(
        PrimeError, match=rf"'collection' was begun by other code than there is now \({RISE}\)"
    ):
        toy().collection.compute(["1"])


def test_code_that_is_edited_while_a_run_goes_on_stops_it(
    prime_run: Run, toy: Make, tmp_path: Path
) -> None:
    job = toy(folder=tmp_path / "toy")
    job.collection.folder.mkdir(parents=True)
    job.collection.begin()
    other_code(job.collection, RISE)  # as a worker meets it that has other code than the run
    with pytest.raises(PrimeError, match="was begun by other code than there is now"):
        job.collection.results()
    prime_run(until="collection")  # nothing was made: the next run takes it
    assert toy(folder=tmp_path / "toy").collection.code == ""
    assert not toy(folder=tmp_path / "toy").collection.missing()


def test_a_stage_of_an_earlier_prime_is_taken_as_it_is(toy: Make) -> None:
    job = toy()
    job.collection.compute(["0"])
    (job.collection.folder / "code.json").unlink()
    job = toy()
    assert job.collection.other_code() == []
    job.collection.compute(["1"])
    assert job.collection.other_code() == ["unknown code"]
    assert job.collection.is_kept


def test_who_sits_at_a_terminal_is_asked(
    prime_run: Run, toy: Make, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    prime_run(until="collection")
    first = toy(folder=tmp_path / "toy")
    before = made(first)["collection"]
    other_code(first.collection, RISE)
    asked = []
    monkeypatch.setattr(Console, "is_terminal", True)
    monkeypatch.setattr(sys, "stdin", SimpleNamespace(isatty=lambda: True))
    monkeypatch.setattr(Console, "input", lambda self, text: asked.append(text) or "n")
    prime_run(until="collection")
    assert len(asked) == 1
    assert toy(folder=tmp_path / "toy").collection.results()[0]["timing"]["seconds"] == before
