"""Broken LeRobot data sets are refused and told what is wrong; foreign ones are read."""

import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from prime_core.datasets.demonstrator import LeRobotDemonstratorConfig
from prime_core.datasets.read import read_dataset
from prime_core.errors import DatasetError

from .edits import edit_info
from .samples import (
    DATA,
    DESCRIPTION,
    EPISODES,
    assert_same,
    fingerprint,
    write,
)


def change_data(folder: Path, change: Callable[[Any], Any]) -> None:
    path = folder / "data/chunk-000/file-000.parquet"
    pq.write_table(change(pq.read_table(path, partitioning=None)), path)


def truncate(folder: Path, name: str) -> None:
    path = folder / name
    path.write_bytes(path.read_bytes()[:-200])


def holed(table: Any) -> Any:
    values = np.array(table["action"].to_pylist(), dtype=np.float32)
    values[35, 2] = np.nan
    column = pa.FixedSizeListArray.from_arrays(pa.array(values.ravel()), 5)
    return table.set_column(table.column_names.index("action"), "action", column)


def ragged(table: Any) -> Any:
    rows = table["action"].to_pylist()
    rows[3], rows[4] = rows[3][:4], [*rows[4], 0.0]
    column = pa.array(rows, pa.list_(pa.float32()))
    return table.set_column(table.column_names.index("action"), "action", column)


BREAKAGES: dict[str, tuple[Callable[[Path], object], str]] = {
    "no folder": (shutil.rmtree, r"set/meta/info.json is missing: a LeRobot v3 data set"),
    "no JSON": (lambda f: truncate(f, "meta/info.json"), r"info.json is not readable as JSON"),
    "version 2": (
        lambda f: edit_info(f, lambda info: info.update(codebase_version="v2.1")),
        r"codebase_version is 'v2.1'.*convert_dataset_v21_to_v30",
    ),
    "no version": (lambda f: (f / "meta/info.json").write_text("[]"), r"codebase_version is None"),
    "no fps": (
        lambda f: edit_info(f, lambda info: info.pop("fps")),
        r"fps is 'missing'; it should be a number",
    ),
    "other fps": (
        lambda f: edit_info(f, lambda info: info.update(fps=50)),
        r"fps is 50; motor actions here are steps of 20 a second",
    ),
    "no action": (
        lambda f: edit_info(f, lambda info: info["features"].pop("action")),
        r"info.json: no feature 'action'; it should be 5 numbers.*Features: .*observation.state",
    ),
    "wide action": (
        lambda f: edit_info(f, lambda info: info["features"]["action"].update(shape=[7])),
        r"'action' has 7 numbers; it should have 5 \(dx, dy, dz, dyaw, gripper\)",
    ),
    "whole numbers": (
        lambda f: edit_info(f, lambda info: info["features"]["action"].update(dtype="int64")),
        r"'action' is int64 of shape \[5\]; it should be 5 numbers",
    ),
    "strange path": (
        lambda f: edit_info(f, lambda info: info.update(data_path="data/{episode}")),
        r"data_path is 'data/\{episode\}'; it should be .*: LeRobot has 'data/chunk-",
    ),
    "other objects": (
        lambda f: edit_info(
            f,
            lambda info: info["features"]["observation.environment_state"]["names"].__setitem__(
                0, "cereal.x"
            ),
        ),
        r"feature 'observation.environment_state' has 'cereal.x' where this environment has "
        r"'milk.x'. It has cereal.x, milk.y,.*changed to these",
    ),
    "other width": (
        lambda f: edit_info(
            f, lambda info: info["features"]["observation.state"].update(shape=[14], names=None)
        ),
        r"'observation.state' has 14 numbers; this environment has 15: gripper.x",
    ),
    "no objects": (
        lambda f: edit_info(f, lambda info: info["features"].pop("observation.environment_state")),
        r"'observation.environment_state' is missing; this environment has 16: milk.x",
    ),
    "no episodes": (
        lambda f: shutil.rmtree(f / "meta/episodes"),
        r"meta/episodes has no file chunk-000/file-000.parquet",
    ),
    "truncated episodes": (
        lambda f: truncate(f, EPISODES),
        r"episodes/chunk-000/file-000.parquet: the file is broken or was never finished",
    ),
    "too few episodes": (
        lambda f: edit_info(f, lambda info: info.update(total_episodes=7)),
        r"lists 3 episodes and .*info.json says total_episodes 7",
    ),
    "no data": (lambda f: (f / DATA).unlink(), r"data/chunk-000/file-000.parquet is missing"),
    "truncated data": (
        lambda f: truncate(f, DATA),
        r"data/chunk-000/file-000.parquet: the file is broken or was never finished",
    ),
    "empty data": (lambda f: (f / DATA).write_bytes(b""), r"the file is broken"),
    "no column": (
        lambda f: change_data(f, lambda table: table.drop_columns("action")),
        r"file-000.parquet has no column 'action'; it has observation.state",
    ),
    "fewer frames": (
        lambda f: change_data(f, lambda table: table.slice(0, 50)),
        r"episode 1 has 20 frames; it should have the frames 0 to 24",
    ),
    "shuffled frames": (
        lambda f: change_data(f, lambda table: table.take(list(range(95, -1, -1)))),
        r"it should have the frames 0 to 29 in order",
    ),
    "NaN": (
        lambda f: change_data(f, holed),
        r"'action' holds NaN or infinity in episode 1, frame 5",
    ),
    "ragged": (lambda f: change_data(f, ragged), r"'action' has 4 numbers in row 3"),
    "no segments": (
        lambda f: (f / "meta/primitives.parquet").unlink(),
        r"primitives.parquet is missing",
    ),
    "newer release": (
        lambda f: (f / "meta/prime.json").write_text('{"version": 9}'),
        r"prime.json: version is 9; this release reads version 1",
    ),
    "strange primitives": (
        lambda f: (f / "meta/prime.json").write_text('{"version": 1, "primitives": [{}]}'),
        r"prime.json: primitives is not a list of names with their parameters",
    ),
}


@pytest.mark.parametrize("breakage", BREAKAGES)
def test_a_broken_set_is_refused_and_left_as_it_is(tmp_path: Path, breakage: str) -> None:
    break_it, text = BREAKAGES[breakage]
    write(tmp_path / "set", parsed=True)
    break_it(tmp_path / "set")
    before = fingerprint(tmp_path / "set")
    with pytest.raises(DatasetError, match=text) as caught:
        read_dataset(tmp_path / "set", DESCRIPTION)
    assert str(tmp_path / "set") in str(caught.value)
    assert fingerprint(tmp_path / "set") == before


def test_a_set_from_elsewhere_is_read(tmp_path: Path) -> None:
    written = write(tmp_path / "set")
    (tmp_path / "set/meta/prime.json").unlink()

    def foreign(info: dict[str, Any]) -> None:
        info["features"].pop("simulator_state")
        info["features"]["observation.state"]["names"] = None
        info["features"]["observation.environment_state"]["names"] = []
        info["features"]["action"]["dtype"] = "float64"

    edit_info(tmp_path / "set", foreign)

    def doubles(table: Any) -> Any:
        column = pa.array(table["action"].to_pylist(), pa.list_(pa.float64()))
        index = table.column_names.index("action")
        return table.drop_columns("simulator_state").set_column(index, "action", column)

    change_data(tmp_path / "set", doubles)
    found = read_dataset(tmp_path / "set", DESCRIPTION)
    assert found.environment is None and found.state_names is None
    for left, right in zip(found.demonstrations, written, strict=True):
        assert_same(left, replace(right, simulator_states=None))


def test_the_demonstrator(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    written = write(tmp_path / "set")
    monkeypatch.setattr(
        "prime_core.datasets.demonstrator._description_of", lambda environment: DESCRIPTION
    )
    environment: Any = None
    everything = LeRobotDemonstratorConfig(path=tmp_path / "set")
    assert everything.count_available() == 3
    assert_same(everything.demonstrate(environment, 1, seed=5), written[1])
    some = LeRobotDemonstratorConfig(path=tmp_path / "set", episodes=(2,))
    assert some.count_available() == 1
    assert_same(some.demonstrate(environment, 0, seed=5), written[2])
    with pytest.raises(DatasetError, match="gives 1 demonstrations, not 2"):
        some.demonstrate(environment, 1, seed=5)
