"""Writes what a LeRobot v3 data set says of its episodes, under ``meta/``."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from prime_core.datasets.files import layout
from prime_core.datasets.files.statistics import Statistics, merge, plain


@dataclass(frozen=True, eq=False)
class WrittenEpisode:
    """What is kept of an episode once it is written.

    Attributes:
        task: What is done, in words.
        first_frame: Index of its first frame in the data set.
        end_frame: Index after its last one.
        file_number: In which data file it is.
        statistics: Of each feature.
    """

    task: str
    first_frame: int
    end_frame: int
    file_number: int
    statistics: Mapping[str, Statistics]


def place_of(file_number: int) -> dict[str, int]:
    """Return the numbers in a file's path."""
    chunk, file = divmod(file_number, layout.CHUNK_SIZE)
    return {"chunk_index": chunk, "file_index": file}


def write_tasks(folder: Path, tasks: Sequence[str]) -> None:
    """Write the tasks as pandas would, with the task as the index: LeRobot reads it by that."""
    import pyarrow as pa

    def column(name: str, kind: str, stored: str) -> dict[str, Any]:
        return {
            "name": name,
            "field_name": name,
            "pandas_type": kind,
            "numpy_type": stored,
            "metadata": None,
        }

    frame = {
        "index_columns": ["task"],
        "column_indexes": [],
        "columns": [column("task_index", "int64", "int64"), column("task", "unicode", "object")],
        "creator": {"library": "pyarrow", "version": pa.__version__},
        "pandas_version": "2.2.0",
    }
    numbers = pa.array(range(len(tasks)), pa.int64())
    table = pa.table({"task_index": numbers, "task": pa.array(tasks, pa.string())})
    write_table(
        folder / layout.TASKS_FILE, table.replace_schema_metadata({"pandas": json.dumps(frame)})
    )


def write_episodes(
    folder: Path, episodes: Sequence[WrittenEpisode], features: Mapping[str, Any], fps: int
) -> None:
    """Write where each episode is, and its statistics; each has videos of its own."""
    import pyarrow as pa

    places = [place_of(episode.file_number) for episode in episodes]
    starts = np.array([episode.first_frame for episode in episodes], dtype=np.int64)
    ends = np.array([episode.end_frame for episode in episodes], dtype=np.int64)
    zeros = np.zeros(len(episodes), dtype=np.int64)
    columns = {
        "episode_index": pa.array(range(len(episodes)), pa.int64()),
        "tasks": pa.array([[episode.task] for episode in episodes], pa.list_(pa.string())),
        "length": pa.array(ends - starts),
        "data/chunk_index": pa.array([place["chunk_index"] for place in places], pa.int64()),
        "data/file_index": pa.array([place["file_index"] for place in places], pa.int64()),
        "dataset_from_index": pa.array(starts),
        "dataset_to_index": pa.array(ends),
    }
    videos = [place_of(number) for number in range(len(episodes))]
    for key, feature in features.items():
        if feature["dtype"] == "video":
            for name in ("chunk_index", "file_index"):
                numbers = [place[name] for place in videos]
                columns[f"videos/{key}/{name}"] = pa.array(numbers, pa.int64())
            columns[f"videos/{key}/from_timestamp"] = pa.array(zeros.astype(np.float64))
            columns[f"videos/{key}/to_timestamp"] = pa.array((ends - starts) / fps)
    listed = [{key: plain(of) for key, of in item.statistics.items()} for item in episodes]
    for key, statistics in listed[0].items():
        for name in statistics:
            columns[f"stats/{key}/{name}"] = pa.array([item[key][name] for item in listed])
    columns["meta/episodes/chunk_index"] = pa.array(zeros)
    columns["meta/episodes/file_index"] = pa.array(zeros)
    path = folder / layout.EPISODES_FILE.format(chunk_index=0, file_index=0)
    write_table(path, pa.table(columns))


def write_info(
    folder: Path,
    episodes: Sequence[WrittenEpisode],
    features: Mapping[str, Any],
    *,
    fps: int,
    robot_type: str,
) -> None:
    """Write ``meta/info.json`` and the statistics of all episodes together."""
    totals = {
        key: plain(merge([episode.statistics[key] for episode in episodes]))
        for key in episodes[0].statistics
    }
    write_json(folder / layout.STATISTICS_FILE, totals)
    has_videos = any(feature["dtype"] == "video" for feature in features.values())
    info = {
        "codebase_version": layout.CODEBASE_VERSION,
        "fps": fps,
        "features": dict(features),
        "total_episodes": len(episodes),
        "total_frames": episodes[-1].end_frame,
        "total_tasks": len({episode.task for episode in episodes}),
        "chunks_size": layout.CHUNK_SIZE,
        "data_files_size_in_mb": layout.DATA_FILE_MEGABYTES,
        "video_files_size_in_mb": layout.VIDEO_FILE_MEGABYTES,
        "data_path": layout.DATA_FILE,
        "video_path": layout.VIDEO_FILE if has_videos else None,
        "robot_type": robot_type,
        "splits": {"train": f"0:{len(episodes)}"},
    }
    write_json(folder / layout.INFO_FILE, info)


def write_json(path: Path, content: object) -> None:
    """Write plain data as JSON, and its folder if need be."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(content, indent=4, ensure_ascii=False), encoding="utf-8")


def write_table(path: Path, table: Any) -> None:
    """Write an arrow table as a parquet file, and its folder if need be."""
    import pyarrow.parquet as pq

    path.parent.mkdir(parents=True, exist_ok=True)
    pq.write_table(table, path, compression="snappy")
