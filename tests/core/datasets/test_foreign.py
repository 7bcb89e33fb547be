"""Data sets from elsewhere are read by the names of their columns, never by position."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from prime_core.datasets.read import read_dataset, write_dataset

from .edits import INFO, edit_column, edit_info, refusal, rows
from .samples import DATA, DESCRIPTION, EPISODES, assert_same, demonstration, write

STATE, OBJECTS = "observation.state", "observation.environment_state"


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
