"""One bad demonstration does not end the others; files that cannot be read are told by name."""

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from prime_core.contracts.demonstration import Demonstration

from ..lost_rights import without_rights
from .hdf5_files import FRAMES, assert_same, good, read, record, refusal


def changed(states: Any, place: Any, value: float) -> Any:
    copy = states.copy()
    copy[place] = value
    return copy


def slower(states: Any) -> Any:
    return states * np.r_[2.0, np.ones(31)]


ROWS = "must hold two rows of finite numbers or more"
ALL = slice(None)
BAD: dict[str, tuple[Callable[[Any], dict[str, Any]], str]] = {
    "NaN": (lambda s: good(changed(s, (2, 3), np.nan)), f"/states of shape (6, 32) {ROWS}"),
    "no actions": (lambda s: {"states": s}, ": has no data set 'actions'; it holds states"),
    "no rows": (
        lambda s: good(s, actions=np.zeros((0, 7))),
        f"/actions of shape (0, 7) {ROWS}",
    ),
    "degrees": (
        lambda s: good(changed(s, (ALL, 2), 120.0)),
        ": a joint of the arm is at 120; it should be radians, at most 6.28319",
    ),
    "no turn": (
        lambda s: good(changed(s, (ALL, slice(13, 17)), 0.0)),
        ": the object's quaternion has the length 0 in row 0; it must be 1",
    ),
    "another rate": (
        lambda s: good(slower(s)),
        "/states: time goes on by 0.1 s after row 0; it must go on by 0.05 s, 20 times a second",
    ),
    "another length": (
        lambda s: good(s, num_samples=5),
        " has 6 actions; its num_samples says 5",
    ),
    "text": (
        lambda s: good(s, actions=np.array([["a"] * 7] * FRAMES, dtype="S1")),
        "/actions holds |S1; it must hold numbers",
    ),
    "nothing": (lambda s: {}, ": has no data set 'states'; it holds nothing"),
    "object in millimetres": (
        lambda s: good(changed(s, (ALL, 12), 830.0)),
        ": the object is at 830; it should be metres, at most 10",
    ),
    "finger in millimetres": (
        lambda s: good(changed(s, (ALL, 8), 40.0)),
        ": a finger is at 40; it should be metres, at most 0.3",
    ),
    "object far away": (
        lambda s: good(changed(s, (1, 10), -1e30)),
        ": the object is at 1e+30; it should be metres, at most 10",
    ),
    "too fast": (
        lambda s: good(changed(s, (1, 20), 1e300)),
        ": a velocity is 1e+300; it should be metres or radians a second, at most 10000",
    ),
}
"""A demonstration of states that is bad in some way, and what is said of it after its name."""


def test_bad_demonstrations_do_not_end_the_others(
    tmp_path: Path, states: Any, shown: Demonstration
) -> None:
    bad = {f"demo_{number}": make(states) for number, (make, _) in enumerate(BAD.values(), 1)}
    last = f"demo_{len(BAD) + 1}"
    demos = {"demo_0": good(states), **bad, last: good(states)}
    path = record(tmp_path / "a.hdf5", {"env": "Lift"}, **demos)
    first, *others, end = read(path)
    assert_same(first, shown)
    assert_same(end, shown)
    assert [str(item).removeprefix(f"{path}: data/") for item in others] == [
        f"{name}{text}" for name, (_, text) in zip(bad, BAD.values(), strict=True)
    ]


def test_what_is_no_demonstration_does_not_end_the_others(
    tmp_path: Path, states: Any, shown: Demonstration
) -> None:
    path = record(tmp_path / "a.hdf5", {"env": "Lift"}, demo_0=good(states))
    with h5py.File(path, "a") as file:
        file["data/demo_1"] = np.zeros(3)
        file["data/demo_2"] = h5py.SoftLink("/nowhere")
        file["data/demo_3/actions"] = h5py.ExternalLink("gone.hdf5", "/actions")
        file["data/demo_3/states"] = states
    found, *others = read(path)
    assert_same(found, shown)
    array, link, outside = (str(item).removeprefix(f"{path}: data/") for item in others)
    assert array == "demo_1 is no group of a demonstration"
    assert link.startswith("demo_2: cannot be read: ")
    assert outside == "demo_3: has no data set 'actions'; it holds actions, states"


def test_a_file_cut_in_half_is_told_so(tmp_path: Path, states: Any) -> None:
    path = record(tmp_path / "a.hdf5", {"env": "Lift"}, demo_1=good(states))
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    text = refusal(path)
    assert text.startswith("cannot be read: truncated file: eof = ")
    assert text.endswith("It was not closed or not copied to its end") and "\n" not in text


def test_a_file_that_is_written_elsewhere_is_told_so(tmp_path: Path, states: Any) -> None:
    path = record(tmp_path / "a.hdf5", {"env": "Lift"}, demo_1=good(states))
    code = f"import h5py; f = h5py.File({str(path)!r}, 'a'); print('open', flush=True); input()"
    with subprocess.Popen(
        [sys.executable, "-c", code], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as writer:
        assert writer.stdout is not None and writer.stdout.readline() == "open\n"
        text = refusal(path)
        writer.communicate("\n")
    assert text == "is open for writing elsewhere: end what records into it, then read it"


def test_a_folder_and_a_data_set_in_the_place_of_a_group_are_refused(tmp_path: Path) -> None:
    (tmp_path / "folder.hdf5").mkdir()
    assert refusal(tmp_path / "folder.hdf5") == "cannot be read: Is a directory"
    with h5py.File(tmp_path / "a.hdf5", "w") as file:
        file["data"] = np.zeros(3)
    assert refusal(tmp_path / "a.hdf5").startswith("has no group 'data'; it holds data. Expected")


def test_a_file_without_permission_is_told_so(tmp_path: Path, states: Any) -> None:
    path = record(tmp_path / "a.hdf5", {"env": "Lift"}, demo_1=good(states))
    for folder in (tmp_path, *tmp_path.parents[:2]):
        folder.chmod(0o755)
    with without_rights(path):
        text = refusal(path)
    assert text == "cannot be read: Permission denied"


def test_a_small_file_of_very_many_numbers_is_not_read(tmp_path: Path, states: Any) -> None:
    path = record(tmp_path / "a.hdf5", {"env": "Lift"}, demo_1=good(states))
    with h5py.File(path, "a") as file:
        file.create_dataset("data/demo_2/states", (10**9, 32), "f8", chunks=(1000, 32))
        file["data/demo_2/actions"] = np.zeros((FRAMES, 7))
    assert path.stat().st_size < 100_000
    _, refused = read(path)
    assert str(refused) == (
        f"{path}: data/demo_2/states has the shape (1000000000, 32); at most 20000000 numbers are "
        "read"
    )
