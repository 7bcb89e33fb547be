"""Columns of another type, clock or unit are refused by their names."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from prime_core.datasets.read import read_dataset
from prime_core.errors import DatasetError

from .edits import edit_column, refusal, rows
from .samples import DATA, DESCRIPTION, EPISODES, write

STATE, OBJECTS = "observation.state", "observation.environment_state"


def scaled(column: int, factor: float) -> Callable[[Any], Any]:
    def change(values: Any) -> Any:
        values[:, column] *= factor
        return values

    return rows(change)


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
