"""Data sets that were changed so that reading may take all memory, or fail at odd places."""

from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from prime_core.datasets.files import parquet_reader

from .edits import INFO, edit_info, refusal
from .samples import DATA, EPISODES, write

LEROBOTS = "LeRobot has 'data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet'"
WANTED = f"it should be a path inside of the data set: {LEROBOTS}"


@pytest.mark.parametrize(
    "template",
    [
        "{chunk_index:999999999999d}",
        "data/{chunk_index:0999999999d}/{file_index}",
        "{chunk_index.__class__}",
        "{chunk_index!r}",
        "{episode_chunk}",
        "{",
        "data/\0.parquet",
        "",
    ],
)
def test_a_path_of_data_holds_two_short_numbers_and_nothing_else(
    tmp_path: Path, template: str
) -> None:
    folder = tmp_path / "set"
    write(folder)
    edit_info(folder, lambda info: info.update(data_path=template))
    assert refusal(folder) == f"{INFO}: data_path is {template!r}; {WANTED}"


@pytest.mark.parametrize("key", ["fps", "total_episodes"])
def test_a_number_beyond_all_floats_is_a_number(tmp_path: Path, key: str) -> None:
    folder = tmp_path / "set"
    write(folder)
    edit_info(folder, lambda info: info.update({key: 10**400}))
    assert refusal(folder).startswith(f"{INFO}: {key} is 1000")


@pytest.mark.parametrize(("name", "key"), [(DATA, "frame_index"), (EPISODES, "length")])
def test_a_small_file_of_very_many_equal_numbers_is_not_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str, key: str
) -> None:
    folder = tmp_path / "set"
    write(folder)
    few = pq.read_table(folder / name).slice(0, 1)
    many: Any = pa.concat_tables([few] * 2000)
    pq.write_table(many, folder / name)
    assert (folder / name).stat().st_size < 100_000
    monkeypatch.setattr(parquet_reader, "MOST_NUMBERS", 5000)
    text = refusal(folder)
    assert text.startswith(f"{name} holds ")
    assert text.endswith(
        " numbers in the columns that are read; at most 5000 of a file are read: LeRobot begins "
        "another file after 100 MB"
    )
