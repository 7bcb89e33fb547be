"""Writes the files of a LeRobot v3 data set, many episodes at once.

LeRobot's own recorder writes frame by frame; the files here are the same, column by column.
"""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from prime_core.contracts.demonstration import Demonstration
from prime_core.contracts.images import Images
from prime_core.contracts.observations import ENVIRONMENT_STATE_KEY, IMAGE_PREFIX, STATE_KEY
from prime_core.datasets import layout
from prime_core.datasets.embedded_images import embedded
from prime_core.datasets.statistics import Statistics, merge, plain, statistics_of

Columns = dict[str, NDArray[Any]]


@dataclass(eq=False)
class Episode:
    """One episode as it is written.

    Attributes:
        task: What is done, in words.
        columns: The numbers of each feature, ``(N,)`` or ``(N, width)``.
        images: Of each feature of images; they are read when they are written.
        language: LeRobot's language rows as an arrow array, or None.
        first_frame: Index of its first frame in the data set.
        file_number: In which data file it is.
        statistics: Of each feature.
    """

    task: str
    columns: Columns
    images: Mapping[str, Images] = field(default_factory=dict)
    language: Any = None
    first_frame: int = 0
    file_number: int = 0
    statistics: dict[str, Statistics] = field(default_factory=dict)

    def __len__(self) -> int:
        return len(self.columns[layout.ACTION_KEY])


def episode_of(demonstration: Demonstration) -> Episode:
    """Return a demonstration as an episode, without LeRobot's bookkeeping columns."""
    columns: Columns = {
        STATE_KEY: np.asarray(demonstration.observations.state, dtype=np.float32),
        layout.ACTION_KEY: np.asarray(demonstration.actions, dtype=np.float32),
    }
    if demonstration.observations.environment_state is not None:
        objects = np.asarray(demonstration.observations.environment_state, dtype=np.float32)
        columns[ENVIRONMENT_STATE_KEY] = objects
    if demonstration.simulator_states is not None:
        states = np.asarray(demonstration.simulator_states, dtype=np.float64)
        columns[layout.SIMULATOR_STATE_KEY] = states
    shown = demonstration.observations.images
    images = {IMAGE_PREFIX + name: each for name, each in shown.items()}
    return Episode(demonstration.task, columns, images)


def write_files(
    folder: Path,
    episodes: Sequence[Episode],
    features: Mapping[str, Any],
    *,
    fps: int,
    robot_type: str,
) -> None:
    """Write all files that LeRobot knows into an empty folder.

    Args:
        folder: Where to.
        episodes: What; their bookkeeping is filled in.
        features: The table of features.
        fps: Frames a second.
        robot_type: As LeRobot calls the robot.
    """
    tasks = list(dict.fromkeys(episode.task for episode in episodes))
    _keep_books(episodes, tasks, fps)
    _write_data(folder, episodes, features)
    _write_tasks(folder / layout.TASKS_FILE, tasks)
    _write_episodes(folder, episodes)
    totals = {
        key: plain(merge([episode.statistics[key] for episode in episodes]))
        for key in episodes[0].statistics
    }
    write_json(folder / layout.STATISTICS_FILE, totals)
    info = {
        "codebase_version": layout.CODEBASE_VERSION,
        "fps": fps,
        "features": dict(features),
        "total_episodes": len(episodes),
        "total_frames": sum(len(episode) for episode in episodes),
        "total_tasks": len(tasks),
        "chunks_size": layout.CHUNK_SIZE,
        "data_files_size_in_mb": layout.DATA_FILE_MEGABYTES,
        "video_files_size_in_mb": layout.VIDEO_FILE_MEGABYTES,
        "data_path": layout.DATA_FILE,
        "video_path": None,
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


def _keep_books(episodes: Sequence[Episode], tasks: list[str], fps: int) -> None:
    frame = 0
    task_indices = {task: index for index, task in enumerate(tasks)}
    for number, episode in enumerate(episodes):
        count = len(episode)
        steps = np.arange(count, dtype=np.int64)
        episode.columns |= {
            "timestamp": (steps / fps).astype(np.float32),
            "frame_index": steps,
            "episode_index": np.full(count, number),
            "index": steps + frame,
            "task_index": np.full(count, task_indices[episode.task]),
        }
        episode.first_frame = frame
        frame += count


def _place(file_number: int) -> dict[str, int]:
    chunk, file = divmod(file_number, layout.CHUNK_SIZE)
    return {"chunk_index": chunk, "file_index": file}


def _write_data(folder: Path, episodes: Sequence[Episode], features: Mapping[str, Any]) -> None:
    """Write the data files, one episode in memory at a time, and say where each episode is."""
    import pyarrow.parquet as pq

    writer, written, file_number = None, 0, 0
    try:
        for episode in episodes:
            table = _data_table(episode, features)
            numbers = [table[key] for key in table.column_names if key != layout.MOTION_KEY]
            size = sum(column.nbytes for column in numbers)
            if writer is not None and written + size > layout.DATA_FILE_MEGABYTES * 2**20:
                writer.close()
                writer, written, file_number = None, 0, file_number + 1
            if writer is None:
                path = folder / layout.DATA_FILE.format(**_place(file_number))
                path.parent.mkdir(parents=True, exist_ok=True)
                writer = pq.ParquetWriter(path, table.schema, compression="snappy")
            # LeRobot, too, has one row group per episode: an episode is read alone quickly.
            writer.write_table(table)
            episode.file_number, written = file_number, written + size
    finally:
        if writer is not None:
            writer.close()


def _data_table(episode: Episode, features: Mapping[str, Any]) -> Any:
    """Return an episode as an arrow table, and keep its statistics."""
    import pyarrow as pa

    columns = {}
    for key in features:
        if key == layout.MOTION_KEY:
            columns[key] = episode.language
        elif key in episode.images:
            columns[key], episode.statistics[key] = embedded(episode.images[key])
        else:
            columns[key] = _arrow(episode.columns[key])
            episode.statistics[key] = statistics_of(episode.columns[key])
    return pa.table(columns)


def _arrow(values: NDArray[Any]) -> Any:
    import pyarrow as pa

    flat = pa.array(np.ascontiguousarray(values).reshape(-1))
    # LeRobot stores features of one number as plain numbers.
    if values.ndim == 1 or values.shape[1] == 1:
        return flat
    return pa.FixedSizeListArray.from_arrays(flat, values.shape[1])


def _write_tasks(path: Path, tasks: list[str]) -> None:
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
    write_table(path, table.replace_schema_metadata({"pandas": json.dumps(frame)}))


def _write_episodes(folder: Path, episodes: Sequence[Episode]) -> None:
    import pyarrow as pa

    places = [_place(episode.file_number) for episode in episodes]
    starts = np.array([episode.first_frame for episode in episodes], dtype=np.int64)
    lengths = np.array([len(episode) for episode in episodes], dtype=np.int64)
    zeros = np.zeros(len(episodes), dtype=np.int64)
    columns = {
        "episode_index": pa.array(range(len(episodes)), pa.int64()),
        "tasks": pa.array([[episode.task] for episode in episodes], pa.list_(pa.string())),
        "length": pa.array(lengths),
        "data/chunk_index": pa.array([place["chunk_index"] for place in places], pa.int64()),
        "data/file_index": pa.array([place["file_index"] for place in places], pa.int64()),
        "dataset_from_index": pa.array(starts),
        "dataset_to_index": pa.array(starts + lengths),
    }
    listed = [{key: plain(of) for key, of in item.statistics.items()} for item in episodes]
    for key, statistics in listed[0].items():
        for name in statistics:
            columns[f"stats/{key}/{name}"] = pa.array([item[key][name] for item in listed])
    columns["meta/episodes/chunk_index"] = pa.array(zeros)
    columns["meta/episodes/file_index"] = pa.array(zeros)
    path = folder / layout.EPISODES_FILE.format(chunk_index=0, file_index=0)
    write_table(path, pa.table(columns))
