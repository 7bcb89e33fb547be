"""One bad episode or file does not end the others, and is told by name; reading is linear."""

import os
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from prime_core.contracts.demonstration import Demonstration
from prime_core.datasets.demonstrator import LeRobotDemonstratorConfig
from prime_core.datasets.files.parquet_reader import read_table
from prime_core.datasets.read import read_demonstrations, write_dataset

from ...lost_rights import without_rights
from .edits import INFO, edit_column, refusal, rows
from .samples import DATA, DESCRIPTION, EPISODES, LENGTHS, assert_same, demonstration, write


def spoiled(folder: Path) -> list[Demonstration]:
    """Write three episodes: the first holds a NaN, the second is good, the third is empty."""
    written = write(folder)

    def holed(values: Any) -> Any:
        values[7, 2] = np.nan
        return values

    edit_column(folder, DATA, "action", rows(holed))
    edit_column(folder, EPISODES, "length", lambda column: pa.array([*LENGTHS[:2], 0]))
    path = folder / DATA
    pq.write_table(pq.read_table(path, partitioning=None).slice(0, sum(LENGTHS[:2])), path)
    return written


def test_one_bad_episode_does_not_end_the_others(tmp_path: Path) -> None:
    written = spoiled(tmp_path / "set")
    first, second, third = read_demonstrations(tmp_path / "set", DESCRIPTION)
    assert str(first) == (
        f"{tmp_path}/set/{DATA}: column 'action' holds NaN or infinity in episode 0, frame 7; all "
        "numbers should be finite"
    )
    assert isinstance(second, Demonstration)
    assert_same(second, written[1])
    assert str(third) == (
        f"{tmp_path}/set/{EPISODES}: episode 2 has length 0: there is nothing in it"
    )


def test_a_broken_data_file_costs_its_own_episodes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("prime_core.datasets.files.layout.DATA_FILE_MEGABYTES", 0.01)
    written = write(tmp_path / "set")
    broken = tmp_path / "set/data/chunk-000/file-001.parquet"
    broken.write_bytes(broken.read_bytes()[:500])
    first, second, third = read_demonstrations(tmp_path / "set", DESCRIPTION)
    assert isinstance(first, Demonstration) and isinstance(third, Demonstration)
    assert_same(third, written[2])
    assert str(second).startswith(f"{broken}: the file is broken or was never finished")


def test_one_frame_is_left_out(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    target = "prime_core.datasets.demonstrator._description_of"
    monkeypatch.setattr(target, lambda environment: DESCRIPTION)
    write_dataset(tmp_path / "set", [demonstration(1), demonstration(2)], DESCRIPTION)
    environment: Any = None
    source = LeRobotDemonstratorConfig(path=tmp_path / "set")
    still, moved = source.demonstrations(environment, [0, 1], 0)
    assert str(still) == f"{tmp_path}/set: episode 0 has one frame: no motor action was done"
    assert isinstance(moved, Demonstration)


@pytest.mark.parametrize("name", [INFO, EPISODES, DATA, "meta/episodes"])
def test_a_file_without_permission_is_told_so(name: str) -> None:
    with tempfile.TemporaryDirectory() as folder:
        os.chmod(folder, 0o755)
        root = Path(folder) / "set"
        write(root)
        with without_rights(root / name):
            text = refusal(root)
    assert text == f"{name} cannot be read: Permission denied"


def test_a_folder_in_the_place_of_a_file_is_told_so(tmp_path: Path) -> None:
    write(tmp_path / "set")
    (tmp_path / "set" / DATA).unlink()
    (tmp_path / "set" / DATA).mkdir()
    assert refusal(tmp_path / "set") == f"{DATA} cannot be read: Is a directory"


def test_reading_is_linear(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Four times the episodes take about four times as long, not sixteen; no file is read twice."""
    read: list[Path] = []

    def counted(path: Path, *arguments: Any) -> Any:
        read.append(path)
        return read_table(path, *arguments)

    monkeypatch.setattr("prime_core.datasets.files.episodes.read_table", counted)
    monkeypatch.setattr("prime_core.datasets.files.layout.DATA_FILE_MEGABYTES", 0.1)
    seconds = []
    for count in (200, 800):
        folder = tmp_path / str(count)
        items = [demonstration(20, 0, f"task {number}", simulated=False) for number in range(count)]
        write_dataset(folder, items, DESCRIPTION)
        start = time.process_time()
        assert sum(1 for _ in read_demonstrations(folder, DESCRIPTION)) == count
        seconds.append(time.process_time() - start)
    assert seconds[1] < 8 * seconds[0]
    assert len(read) > 10 and len(set(read)) == len(read)
