"""The episodes of a LeRobot v3 data set: which there are, and the numbers of each."""

import itertools
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from prime_core.datasets.files import layout
from prime_core.datasets.files.header import Header
from prime_core.datasets.files.parquet_reader import (
    list_files,
    numbers,
    read_table,
    texts,
    whole_numbers,
)
from prime_core.errors import DatasetError, DemonstrationError

EPISODE_COLUMNS = ("episode_index", "length", "tasks", "data/chunk_index", "data/file_index")


FEW = 20
"""Episodes that are looked up in a file one by one; more are faster to pick out of all of it."""


CLOCK_TOLERANCE = 1e-3  # [s]; LeRobot's own is a tenth of it, but float32 has no more after hours


Columns = dict[str, NDArray[Any]]


_INDEX = re.compile(r"\{(chunk|file)_index(:0?[0-9]?d?)?\}")
"""What stands for a number in ``data_path`` and ``video_path``."""


@dataclass(frozen=True)
class EpisodeEntry:
    """What ``meta/episodes`` says of one episode.

    Attributes:
        index: Its number.
        length: Of so many frames.
        task: What is done, in words.
        file: Where its frames are.
        listed: The file that says so.
    """

    index: int
    length: int
    task: str
    file: Path
    listed: Path


def read_entries(header: Header) -> list[EpisodeEntry]:
    """Read ``meta/episodes``.

    Raises:
        DatasetError: If it is missing, broken or not what ``meta/info.json`` says.
    """
    root = header.folder / layout.EPISODES_FOLDER
    entries = []
    for path in list_files(root, "chunk-*/file-*.parquet"):
        table = read_table(path, EPISODE_COLUMNS)
        counts = (name for name in EPISODE_COLUMNS if name != "tasks")
        indices, lengths, chunks, files = (
            whole_numbers(path, table, name).tolist() for name in counts
        )
        rows = zip(indices, lengths, texts(path, table, "tasks"), chunks, files, strict=True)
        for index, length, task, chunk, file in rows:
            place = file_in(header, "data_path", layout.DATA_FILE, chunk, file)
            entries.append(EpisodeEntry(index, length, task, place, path))
    entries.sort(key=lambda entry: entry.index)
    count = header.info["total_episodes"]
    if len(entries) != count or [entry.index for entry in entries] != list(range(count)):
        raise DatasetError(
            f"{root} lists {len(entries)} episodes and {header.info_file} says total_episodes "
            f"{count}: they should be the same, numbered from 0. Was the recording interrupted?"
        )
    return entries


def file_in(
    header: Header, setting: str, usual: str, chunk: int, file: int, video_key: str = ""
) -> Path:
    """Return a file of a data set.

    Args:
        header: Of the data set.
        setting: Which key of ``meta/info.json`` says where.
        usual: What LeRobot has there.
        chunk: Number of its folder.
        file: Its own number.
        video_key: Of the feature that it holds, if its path is to name one.

    Raises:
        DatasetError: If the setting is no path inside of the data set.
    """
    template = header.info.get(setting)
    place = None
    if isinstance(template, str) and template:
        named = template.replace("{video_key}", "") if video_key else template
        # What else format() takes reaches into objects or fills the memory.
        if not set("{}\0") & set(_INDEX.sub("", named)):
            place = Path(template.format(chunk_index=chunk, file_index=file, video_key=video_key))
    if place is None or place.is_absolute() or ".." in place.parts:
        raise DatasetError(
            f"{header.info_file}: {setting} is {template!r}; it should be a path inside of the "
            f"data set: LeRobot has {usual!r}"
        )
    return header.folder / place


def read_episodes(
    header: Header, entries: Sequence[EpisodeEntry]
) -> Iterator[tuple[EpisodeEntry, Columns | DemonstrationError]]:
    """Read the numbers of episodes, each file once where its episodes follow each other.

    Yields:
        In the order of the entries, each feature's ``(length, width)``, and the ``(length,)``
        of ``timestamp`` if there is one, or why the episode cannot be used.
    """
    for path, group in itertools.groupby(entries, key=lambda entry: entry.file):
        mates = list(group)
        try:
            file = _DataFile(header, path, mates)
        except DatasetError as error:
            yield from ((entry, DemonstrationError(str(error))) for entry in mates)
            continue
        for entry in mates:
            try:
                yield entry, file.columns_of(entry)
            except DemonstrationError as error:
                yield entry, error


class _DataFile:
    """The numbers of some episodes of one file.

    Raises:
        DatasetError: If the file is missing or broken, or a column is no such numbers.
    """

    def __init__(self, header: Header, path: Path, entries: Sequence[EpisodeEntry]) -> None:
        self._path = path
        self._fps = header.info["fps"]
        timed = "timestamp" in header.info["features"]
        names = ["episode_index", "frame_index", *header.features, *["timestamp"] * timed]
        chosen = [entry.index for entry in entries]
        table = read_table(path, names, chosen if len(chosen) <= FEW else None)
        self._owner = whole_numbers(path, table, "episode_index")
        self._steps = whole_numbers(path, table, "frame_index")
        self._clock = numbers(path, table, "timestamp", 1)[:, 0] if timed else None
        self._columns = {
            key: numbers(path, table, key, feature.width)
            for key, feature in header.features.items()
        }
        self._finite = {
            key: np.isfinite(values).all(axis=1) for key, values in self._columns.items()
        }
        self._order = np.argsort(self._owner, kind="stable")

    def columns_of(self, entry: EpisodeEntry) -> Columns:
        """Return an episode's numbers.

        Raises:
            DemonstrationError: If they are not what they should be.
        """
        if entry.length < 1:
            raise DemonstrationError(
                f"{entry.listed}: episode {entry.index} has length {entry.length}: there is "
                "nothing in it"
            )
        ends = [entry.index, entry.index + 1]
        low, high = np.searchsorted(self._owner, ends, sorter=self._order)
        rows = self._order[low:high]
        complete = len(rows) == entry.length
        if not complete or not np.array_equal(self._steps[rows], np.arange(entry.length)):
            raise DemonstrationError(
                f"{self._path}: episode {entry.index} has {len(rows)} frames; it should have the "
                f"frames 0 to {entry.length - 1} in order, as {layout.EPISODES_FOLDER} says"
            )
        columns = {key: values[rows] for key, values in self._columns.items()}
        for key in columns:
            self._check_finite(entry.index, key, rows)
        if self._clock is not None:
            columns["timestamp"] = self._clock[rows].astype(np.float64)
            self._check_clock(entry.index, columns["timestamp"])
        return columns

    def _check_finite(self, episode: int, key: str, rows: NDArray[np.int64]) -> None:
        bad = ~self._finite[key][rows]
        if bad.any():
            raise DemonstrationError(
                f"{self._path}: column {key!r} holds NaN or infinity in episode {episode}, frame "
                f"{int(np.argmax(bad))}; all numbers should be finite"
            )

    def _check_clock(self, episode: int, clock: NDArray[np.float64]) -> None:
        steps = np.diff(clock)
        bad = ~(np.abs(steps - 1 / self._fps) <= CLOCK_TOLERANCE)
        if bad.any():
            frame = int(np.argmax(bad))
            raise DemonstrationError(
                f"{self._path}: column 'timestamp' goes on by {steps[frame]:.4g} s after frame "
                f"{frame} of episode {episode}; at {self._fps} frames a second it should go on by "
                f"{1 / self._fps:.4g} s: resample the episode"
            )
