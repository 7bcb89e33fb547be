"""Data sets from elsewhere: matched by name, checked for units and rate, never by position."""

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from prime_core.contracts.description import RobotDescription
from prime_core.datasets.read import read_dataset, write_dataset
from prime_core.errors import DatasetError

from .edits import INFO, edit_column, edit_info, refusal, rows
from .samples import DATA, DESCRIPTION, EPISODES, assert_same, demonstration, write

STATE, OBJECTS = "observation.state", "observation.environment_state"


def scaled(column: int, factor: float) -> Callable[[Any], Any]:
    def change(values: Any) -> Any:
        values[:, column] *= factor
        return values

    return rows(change)


@pytest.mark.parametrize("key", [STATE, OBJECTS, "action"])
@pytest.mark.parametrize("form", ["list", "heading", "numbers"])
def test_columns_are_matched_by_name(tmp_path: Path, key: str, form: str) -> None:
    written = write(tmp_path / "set")
    width = len(json.loads((tmp_path / "set" / INFO).read_text())["features"][key]["names"])
    order = np.random.default_rng(1).permutation(width)

    def rename(info: dict[str, Any]) -> None:
        names = info["features"][key]["names"]
        names = [names[index] for index in order]
        numbers = {name: names.index(name) for name in sorted(names)}
        forms = {"list": names, "heading": {"motors": names}, "numbers": numbers}
        info["features"][key]["names"] = forms[form]

    edit_info(tmp_path / "set", rename)
    edit_column(tmp_path / "set", DATA, key, rows(lambda values: values[:, order]))
    found = read_dataset(tmp_path / "set", DESCRIPTION)
    for left, right in zip(found.demonstrations, written, strict=True):
        assert_same(left, right)
    assert found.state_names == tuple(DESCRIPTION.state_names)
    write_dataset(tmp_path / "again", found.demonstrations, DESCRIPTION)
    again = read_dataset(tmp_path / "again", DESCRIPTION).demonstrations[0]
    assert_same(again, written[0])


NAMES = "it should be a list of 5 names, or null"
INFO_EDITS: dict[str, tuple[Callable[[dict[str, Any]], object], str]] = {
    "a feature is a text": (
        lambda info: info["features"].update({"action": "float32"}),
        "feature 'action' is 'float32'; it should be a table with dtype, shape and names",
    ),
    "a feature is a list": (
        lambda info: info["features"].update({STATE: [15]}),
        f"feature '{STATE}' is [15]; it should be a table with dtype, shape and names",
    ),
    "names are a text": (
        lambda info: info["features"]["action"].update(names="dx dy dz dyaw gripper"),
        f"names of feature 'action' is 'dx dy dz dyaw gripper'; {NAMES}",
    ),
    "names are numbers": (
        lambda info: info["features"]["action"].update(names=[0, 1, 2, 3, 4]),
        f"names of feature 'action' is [0, 1, 2, 3, 4]; {NAMES}",
    ),
    "a name is missing": (
        lambda info: info["features"]["action"]["names"].pop(),
        "feature 'action' has 5 numbers and 4 different names: dx, dy, dz, dyaw. Give one name "
        "for each number, or null",
    ),
    "a name is there twice": (
        lambda info: info["features"]["action"].update(names=["dx", "dx", "dz", "dyaw", "g"]),
        "feature 'action' has 5 numbers and 4 different names: dx, dx, dz, dyaw, g. Give one "
        "name for each number, or null",
    ),
    "other actions": (
        lambda info: info["features"]["action"].update(names=["dx", "dy", "dz", "roll", "gripper"]),
        "feature 'action' has 'roll' where this environment has 'dyaw'. It has dx, dy, dz, roll, "
        "gripper; wanted are, in any order, dx, dy, dz, dyaw, gripper. Either the data set is of "
        "another environment, or its names have to be changed to these",
    ),
    "a shape is a text": (
        lambda info: info["features"]["action"].update(shape="[5]"),
        "feature 'action' is float32 of shape [5]; it should be 5 numbers per frame, float32 or "
        "float64",
    ),
    "a shape is no whole number": (
        lambda info: info["features"]["action"].update(shape=[5.0]),
        "feature 'action' is float32 of shape [5.0]; it should be 5 numbers per frame, float32 or "
        "float64",
    ),
    "features are a list": (
        lambda info: info.update(features=[STATE]),
        f"features is ['{STATE}']; it should be a table of features",
    ),
    "a count is a text": (
        lambda info: info.update(total_episodes="3"),
        "total_episodes is '3'; it should be a whole number, 1 to 100000",
    ),
    "a count is a fraction": (
        lambda info: info.update(total_episodes=3.0),
        "total_episodes is 3.0; it should be a whole number, 1 to 100000",
    ),
    "no episodes": (
        lambda info: info.update(total_episodes=0),
        "total_episodes is 0; it should be a whole number, 1 to 100000",
    ),
    "too many episodes to count": (
        lambda info: info.update(total_episodes=10**18),
        "total_episodes is 1000000000000000000; it should be a whole number, 1 to 100000",
    ),
    "a rate is a text": (
        lambda info: info.update(fps="20"),
        "fps is '20'; it should be a number of frames a second above 0",
    ),
    "a rate is true": (
        lambda info: info.update(fps=True),
        "fps is True; it should be a number of frames a second above 0",
    ),
    "another rate": (
        lambda info: info.update(fps=10),
        "fps is 10; motor actions here are steps of 20 a second: resample the data set to 20",
    ),
    "no state": (
        lambda info: info["features"][STATE].update(shape=[0], names=None),
        f"feature '{STATE}' has no numbers; it should have some",
    ),
    **{
        f"data in {path[:30]!r}": (
            lambda info, path=path: info.update(data_path=path),
            f"data_path is {path!r}; it should be a path inside of the data set: LeRobot has "
            "'data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet'",
        )
        for path in (
            "/etc/passwd",
            "../other/{chunk_index}.parquet",
            "a\0b",
            "{chunk_index:>999999999}",
            "{chunk_index.__class__}",
            "data/{episode_chunk:03d}/episode_{episode_index:06d}.parquet",
        )
    },
}


@pytest.mark.parametrize("edit", INFO_EDITS)
def test_an_edited_info_is_refused_by_key(tmp_path: Path, edit: str) -> None:
    change, text = INFO_EDITS[edit]
    write(tmp_path / "set")
    edit_info(tmp_path / "set", change)
    assert refusal(tmp_path / "set") == f"{INFO}: {text}"


def test_an_info_of_another_robot_is_refused(tmp_path: Path) -> None:
    write(tmp_path / "set")
    robot = RobotDescription(mjcf="", joint_names=(), end_effector="", name="panda")
    ours = replace(DESCRIPTION, robot=robot)
    for same in (None, "unknown", "Franka_Panda", "panda"):
        edit_info(tmp_path / "set", lambda info, name=same: info.update(robot_type=name))
        read_dataset(tmp_path / "set", ours)
    edit_info(tmp_path / "set", lambda info: info.update(robot_type="so100"))
    with pytest.raises(DatasetError) as caught:
        read_dataset(tmp_path / "set", ours)
    assert str(caught.value) == (
        f"{tmp_path}/set/{INFO}: robot_type is 'so100'; this environment's robot is 'panda'. If it "
        "is the same one, write 'panda' or null there"
    )


def test_an_info_with_a_byte_order_mark_is_read(tmp_path: Path) -> None:
    write(tmp_path / "set")
    path = tmp_path / "set" / INFO
    path.write_text(path.read_text(), encoding="utf-8-sig")
    assert len(read_dataset(tmp_path / "set", DESCRIPTION).demonstrations) == 3


def test_tasks_may_be_texts_or_lists(tmp_path: Path) -> None:
    written = write(tmp_path / "set")
    edit_column(
        tmp_path / "set",
        EPISODES,
        "tasks",
        lambda column: pa.array([row[0] for row in column.to_pylist()]),
    )
    found = read_dataset(tmp_path / "set", DESCRIPTION).demonstrations
    assert [item.task for item in found] == [item.task for item in written]
    edit_column(tmp_path / "set", EPISODES, "tasks", lambda column: column.dictionary_encode())
    found = read_dataset(tmp_path / "set", DESCRIPTION).demonstrations
    assert [item.task for item in found] == [item.task for item in written]


WHOLE = "it should be a whole number (int64) in every row: an editor may have changed its type"
COLUMN_EDITS: dict[str, tuple[str, str, Callable[[Any], Any], str]] = {
    "lengths as pandas leaves them": (
        EPISODES,
        "length",
        lambda column: column.cast(pa.float64()),
        f"column 'length' is double; {WHOLE}",
    ),
    "lengths as texts": (
        EPISODES,
        "length",
        lambda column: column.cast(pa.string()),
        f"column 'length' is string; {WHOLE}",
    ),
    "a length that is not there": (
        EPISODES,
        "length",
        lambda column: pa.array([30, None, 41]),
        f"column 'length' is int64, with 1 empty rows; {WHOLE}",
    ),
    "files as lists": (
        EPISODES,
        "data/file_index",
        lambda column: pa.array([[0], [0], [0]]),
        f"column 'data/file_index' is list<element: int64>; {WHOLE}",
    ),
    "tasks as numbers": (
        EPISODES,
        "tasks",
        lambda column: pa.array([[0], [1], [0]]),
        "column 'tasks' is list<element: int64>; it should be a list of texts in every row",
    ),
    "frames as fractions": (
        DATA,
        "frame_index",
        lambda column: column.cast(pa.float64()),
        f"column 'frame_index' is double; {WHOLE}",
    ),
    "actions as texts": (
        DATA,
        "action",
        lambda column: pa.array([str(row) for row in column.to_pylist()]),
        "column 'action' is string, with 0 empty rows and 96 numbers in 96 rows; it should be 5 "
        "numbers in every row",
    ),
    "no objects at all": (
        DATA,
        OBJECTS,
        rows(lambda values: values[:, :0]),
        f"column '{OBJECTS}' is list<element: float>, with 0 empty rows and 0 numbers in 96 rows; "
        "it should be 16 numbers in every row",
    ),
    "parameters as texts": (
        "meta/primitives.parquet",
        "parameters",
        lambda column: pa.array([str(row) for row in column.to_pylist()]),
        "column 'parameters' is string; it should be a list of numbers in every row",
    ),
    "starts as fractions": (
        "meta/primitives.parquet",
        "start",
        lambda column: column.cast(pa.float64()),
        f"column 'start' is double; {WHOLE}",
    ),
    "another clock": (
        DATA,
        "timestamp",
        lambda column: pa.array(2 * column.to_numpy()),
        "column 'timestamp' goes on by 0.1 s after frame 0 of episode 0; at 20 frames a second it "
        "should go on by 0.05 s: resample the episode",
    ),
}


@pytest.mark.parametrize("edit", COLUMN_EDITS)
def test_an_edited_column_is_refused_by_name(tmp_path: Path, edit: str) -> None:
    name, key, change, text = COLUMN_EDITS[edit]
    write(tmp_path / "set", parsed=True)
    edit_column(tmp_path / "set", name, key, change)
    assert refusal(tmp_path / "set") == f"{name}: {text}"


POSITIONS = "positions are metres in the world frame"
ACTIONS = (
    "motor actions are at most 0.05 m and 0.5 rad a step, and -1 to 1 of the gripper: are they "
    r"scaled to -1 to 1\?"
)
UNITS: dict[str, tuple[str, Callable[[Any], Any], str]] = {
    "actions that are scaled": (
        "action",
        scaled(2, 20.0),
        rf"dz is \S+ in frame \d+, but {ACTIONS}",
    ),
    "turns in degrees": ("action", scaled(3, 57.3), rf"dyaw is \S+ in frame \d+, but {ACTIONS}"),
    "grippers in percent": (
        "action",
        scaled(4, 100),
        rf"gripper is \S+ in frame \d+, but {ACTIONS}",
    ),
    "millimetres": (
        STATE,
        scaled(0, 1000.0),
        r"gripper.x is \S+ in frame \d+, but the workspace is \[0.0, 0.0, 0.0\] to "
        rf"\[1.0, 1.0, 1.0\]: {POSITIONS}",
    ),
    "openings in millimetres": (
        STATE,
        scaled(7, 1000.0),
        "gripper.opening is .*, but the opening is the distance between the fingers in metres",
    ),
    "joints in degrees": (
        STATE,
        scaled(9, 1000.0),
        r"joint_1 is \S+ in frame \d+, but joint positions are radians",
    ),
    "objects in millimetres": (
        OBJECTS,
        scaled(2, 1000.0),
        rf"milk.z is \S+ in .*, but {POSITIONS}",
    ),
    "held as a force": (
        OBJECTS,
        scaled(15, 7.0),
        r"bin.held is 7 in frame \d+, but it is 1 while the object is held, else 0",
    ),
    "no quaternion": (
        OBJECTS,
        scaled(4, 0.0),
        r"milk.qw, qx, qy, qz have the length \S+ in frame \d+, but it is a unit quaternion, w "
        "first",
    ),
}


@pytest.mark.parametrize("unit", UNITS)
def test_other_units_are_refused(tmp_path: Path, unit: str) -> None:
    key, change, text = UNITS[unit]
    write(tmp_path / "set")
    edit_column(tmp_path / "set", DATA, key, change)
    with pytest.raises(DatasetError, match=rf"^\S+set/{DATA}: episode 0: {text}$"):
        read_dataset(tmp_path / "set", DESCRIPTION)


def test_a_column_that_stands_twice_is_refused_by_name(tmp_path: Path) -> None:
    write(tmp_path / "set")
    path = tmp_path / "set" / DATA
    table = pq.read_table(path, partitioning=None)
    pq.write_table(table.append_column("action", table["action"]), path)
    assert refusal(tmp_path / "set") == f"{DATA}: column 'action' stands 2 times"


def test_an_empty_column_of_objects_is_a_scene_without_any(tmp_path: Path) -> None:
    alone = replace(DESCRIPTION, objects=())
    one = demonstration(9, simulated=False)
    seen = replace(one.observations, environment_state=np.zeros((9, 0), np.float32))
    write_dataset(tmp_path / "set", [replace(one, observations=seen)], alone)
    feature = {"dtype": "float32", "shape": [0], "names": []}
    edit_info(tmp_path / "set", lambda info: info["features"].update({OBJECTS: feature}))
    path = tmp_path / "set" / DATA
    table = pq.read_table(path, partitioning=None)
    pq.write_table(table.append_column(OBJECTS, pa.array([[]] * 9, pa.list_(pa.float32()))), path)
    (found,) = read_dataset(tmp_path / "set", alone).demonstrations
    assert_same(found, replace(one, observations=seen))
    assert f"feature '{OBJECTS}' is missing; this environment has 16" in refusal(tmp_path / "set")
