"""Writes the files of a LeRobot v3 data set, one episode after another.

LeRobot's own recorder writes frame by frame; the files here are the same, column by column.
"""

import contextlib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from prime_core.contracts.demonstration import Demonstration
from prime_core.contracts.images import Images
from prime_core.contracts.observations import ENVIRONMENT_STATE_KEY, IMAGE_PREFIX, STATE_KEY
from prime_core.datasets.files import layout
from prime_core.datasets.files.metadata_writer import (
    WrittenEpisode,
    place_of,
    write_episodes,
    write_info,
    write_tasks,
)
from prime_core.datasets.files.statistics import Statistics, statistics_of
from prime_core.datasets.images.embedded import embedded
from prime_core.datasets.images.videos import write_frames

Columns = dict[str, NDArray[Any]]


@dataclass(eq=False)
class Episode:
    """One episode that is to be written.

    Attributes:
        task: What is done, in words.
        columns: The numbers of each feature, ``(N,)`` or ``(N, width)``.
        images: Of each feature of images; they are read when they are written.
        language: LeRobot's language rows as an arrow array, or None.
    """

    task: str
    columns: Columns
    images: Mapping[str, Images] = field(default_factory=dict)
    language: Any = None

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
    episodes: Iterable[Episode],
    features: Mapping[str, Any],
    *,
    fps: int,
    robot_type: str,
) -> None:
    """Write all files that LeRobot knows into an empty folder, one episode in memory at a time.

    Args:
        folder: Where to.
        episodes: What, one at least.
        features: The table of features.
        fps: Frames a second.
        robot_type: As LeRobot calls the robot.
    """
    tasks: dict[str, int] = {}
    written: list[WrittenEpisode] = []
    with contextlib.closing(_DataFiles(folder)) as files:
        for number, episode in enumerate(episodes):
            first = written[-1].end_frame if written else 0
            task = tasks.setdefault(episode.task, len(tasks))
            episode.columns |= _books(len(episode), number, first, task, fps)
            table, statistics = _data_table(episode, features)
            place = files.write(table)
            for key in episode.images:
                if features[key]["dtype"] == "video":
                    name = layout.VIDEO_FILE.format(video_key=key, **place_of(number))
                    statistics[key] = write_frames(folder / name, episode.images[key], fps)
            statistics = {key: statistics[key] for key in features if key in statistics}
            end = first + len(episode)
            written.append(WrittenEpisode(episode.task, first, end, place, statistics))
    write_tasks(folder, [*tasks])
    write_episodes(folder, written, features, fps)
    write_info(folder, written, features, fps=fps, robot_type=robot_type)


def _books(frames: int, episode: int, first: int, task: int, fps: int) -> Columns:
    """Return LeRobot's bookkeeping columns of an episode."""
    steps = np.arange(frames, dtype=np.int64)
    return {
        "timestamp": (steps / fps).astype(np.float32),
        "frame_index": steps,
        "episode_index": np.full(frames, episode),
        "index": steps + first,
        "task_index": np.full(frames, task),
    }


class _DataFiles:
    """The data files, of which another is begun where LeRobot would.

    Args:
        folder: Of the data set.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._writer: Any = None
        self._bytes, self._number = 0, 0

    def write(self, table: Any) -> int:
        """Write an episode and return the number of its file."""
        import pyarrow.parquet as pq

        numbers = [table[key] for key in table.column_names if key != layout.MOTION_KEY]
        size = sum(column.nbytes for column in numbers)
        if self._writer is not None and self._bytes + size > layout.DATA_FILE_MEGABYTES * 2**20:
            self.close()
            self._bytes, self._number = 0, self._number + 1
        if self._writer is None:
            path = self._folder / layout.DATA_FILE.format(**place_of(self._number))
            path.parent.mkdir(parents=True, exist_ok=True)
            self._writer = pq.ParquetWriter(path, table.schema, compression="snappy")
        # LeRobot, too, has one row group per episode: an episode is read alone quickly.
        self._writer.write_table(table)
        self._bytes += size
        return self._number

    def close(self) -> None:
        """Write the end of the last file."""
        if self._writer is not None:
            self._writer.close()
            self._writer = None


def _data_table(episode: Episode, features: Mapping[str, Any]) -> tuple[Any, dict[str, Statistics]]:
    """Return an episode as an arrow table without videos, and the statistics of what is in it."""
    import pyarrow as pa

    columns, statistics = {}, {}
    for key in features:
        if key == layout.MOTION_KEY:
            columns[key] = episode.language
        elif features[key]["dtype"] == "video":
            continue
        elif key in episode.images:
            columns[key], statistics[key] = embedded(episode.images[key])
        else:
            columns[key] = _arrow(episode.columns[key])
            statistics[key] = statistics_of(episode.columns[key])
    return pa.table(columns), statistics


def _arrow(values: NDArray[Any]) -> Any:
    import pyarrow as pa

    flat = pa.array(np.ascontiguousarray(values).reshape(-1))
    # LeRobot stores features of one number as plain numbers.
    if values.ndim == 1 or values.shape[1] == 1:
        return flat
    return pa.FixedSizeListArray.from_arrays(flat, values.shape[1])
