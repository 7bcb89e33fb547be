"""Files that settings name count by their content."""

import os
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from prime_core.errors import PrimeError
from prime_core.experiments.experiment import Experiment

from .test_stages import changed

Make = Callable[..., Experiment]


@pytest.fixture
def recorded(toy: Make, tmp_path: Path) -> Callable[[], Experiment]:
    """Make the toy experiment on a recording that is a folder of files."""
    folder = tmp_path / "recorded"
    (folder / "more").mkdir(parents=True)
    (folder / "first.txt").write_text("0.02\n0.03\n")
    (folder / "more" / "second.txt").write_text("0.01\n")
    (tmp_path / "disk").mkdir()
    (tmp_path / "disk" / "linked.txt").write_text("0.04\n")
    (folder / "link").symlink_to(tmp_path / "disk")
    (folder / "link" / "circle").symlink_to(folder)
    return lambda: toy(f"demonstrations={{type: toy/recorded, path: '{folder}'}}")


LEARNT = {"demonstrations", "parsing", "export", "replay", "policy.motor", "policy.calls"}


def rewrite(folder: Path) -> None:
    (folder / "more" / "second.txt").write_text("0.02\n")


def rewrite_in_secret(folder: Path) -> None:
    path = folder / "first.txt"
    before = path.stat()
    path.write_text("0.03\n0.02\n")
    os.utime(path, ns=(before.st_atime_ns, before.st_mtime_ns))


def add(folder: Path) -> None:
    (folder / "third.txt").write_text("0.02\n")


def rename(folder: Path) -> None:
    (folder / "first.txt").rename(folder / "z.txt")


def replace(folder: Path) -> None:
    shutil.rmtree(folder)
    folder.mkdir()
    (folder / "first.txt").write_text("0.04\n")


def rewrite_behind_a_link(folder: Path) -> None:
    (folder.parent / "disk" / "linked.txt").write_text("0.05\n")


@pytest.mark.parametrize(
    "change", [rewrite_behind_a_link, rewrite, rewrite_in_secret, add, rename, replace]
)
def test_other_content_is_another_stage(
    recorded: Callable[[], Experiment], tmp_path: Path, change: Callable[[Path], None]
) -> None:
    before = recorded()
    before.demonstrations.results()
    change(tmp_path / "recorded")
    after = recorded()
    found = changed(before, after)
    assert found >= LEARNT
    assert not found & {"collection", "idm"}
    assert after.demonstrations.missing() == after.demonstrations.items()
    assert before.identity != after.identity


def test_times_names_of_hidden_files_and_links_are_no_content(
    recorded: Callable[[], Experiment], tmp_path: Path
) -> None:
    before = recorded()
    folder = tmp_path / "recorded"
    (folder / "first.txt").touch()
    (folder / ".cache").mkdir()
    (folder / ".cache" / "x").write_text("x")
    shutil.move(folder, tmp_path / "elsewhere")
    folder.symlink_to(tmp_path / "elsewhere")
    assert changed(before, recorded()) == set()


def test_one_file_counts_like_a_folder(toy: Make, tmp_path: Path) -> None:
    file = tmp_path / "one.txt"
    settings = f"demonstrations={{type: toy/recorded, path: '{file}'}}"
    file.write_text("0.02\n")
    before = toy(settings)
    file.write_text("0.02\n0.03\n")
    assert changed(before, toy(settings)) >= LEARNT


def test_files_that_change_while_they_are_read_stop_the_run(
    recorded: Callable[[], Experiment], tmp_path: Path
) -> None:
    job = recorded()
    rewrite(tmp_path / "recorded")
    with pytest.raises(PrimeError, match="'demonstrations' were changed while it read them"):
        job.demonstrations.load()
    assert job.demonstrations.missing() == job.demonstrations.items()
