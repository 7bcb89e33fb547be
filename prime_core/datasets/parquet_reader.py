"""Reads the files of a LeRobot v3 data set, and says clearly what is wrong with a broken one."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from prime_core.contracts.environment import ACTION_NAMES
from prime_core.contracts.observations import ENVIRONMENT_STATE_KEY, STATE_KEY
from prime_core.datasets import layout
from prime_core.errors import DatasetError

REQUIRED_INFO: dict[str, tuple[type, ...]] = {
    "features": (dict,),
    "fps": (int, float),
    "total_episodes": (int,),
    "data_path": (str,),
}


EPISODE_COLUMNS = ("episode_index", "length", "tasks", "data/chunk_index", "data/file_index")


BROKEN = (
    "the file is broken or was never finished (LeRobot's recorder completes its files in "
    "finalize(); a recording that was killed before cannot be read): record it again, or take a "
    "whole copy"
)


Columns = dict[str, NDArray[Any]]


@dataclass(frozen=True)
class Header:
    """What ``meta/info.json`` says.

    Attributes:
        folder: Of the data set.
        info: All of it.
        widths: Numbers of each feature that is read.
    """

    folder: Path
    info: dict[str, Any]
    widths: dict[str, int]

    @property
    def info_file(self) -> Path:
        """Path of ``meta/info.json``."""
        return self.folder / layout.INFO_FILE

    def names(self, key: str) -> tuple[str, ...] | None:
        """Return the names of a feature's numbers, if it has a list of them."""
        names = self.info["features"].get(key, {}).get("names")
        return tuple(names) if isinstance(names, list) else None


@dataclass(frozen=True)
class EpisodeEntry:
    """What ``meta/episodes`` says of one episode."""

    index: int
    length: int
    task: str
    file: Path


def read_json(path: Path) -> Any:
    """Read a JSON file.

    Raises:
        DatasetError: If it is not there or not JSON.
    """
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise DatasetError(
            f"{path} is missing: a LeRobot v3 data set is a folder with {layout.INFO_FILE}, "
            f"{layout.EPISODES_FOLDER}/ and data/"
        ) from None
    except (OSError, ValueError) as error:
        raise DatasetError(f"{path} is not readable as JSON: {error}") from error


def read_table(path: Path, columns: Sequence[str], episodes: Sequence[int] | None = None) -> Any:
    """Read columns of a parquet file as an arrow table.

    Args:
        path: The file.
        columns: Which columns.
        episodes: Which episodes; all if None.

    Raises:
        DatasetError: If the file is missing or broken, or a column is missing.
    """
    import pyarrow as pa
    import pyarrow.parquet as pq

    if not path.is_file():
        raise DatasetError(f"{path} is missing: the data set is not complete")
    try:
        present = pq.read_schema(path).names
        missing = [name for name in columns if name not in present]
        if not missing:
            chosen = None if episodes is None else [("episode_index", "in", list(episodes))]
            # Without partitioning=None a folder named "seed=0" would become a column.
            return pq.read_table(path, columns=list(columns), filters=chosen, partitioning=None)
    except (pa.ArrowException, OSError, ValueError) as error:
        raise DatasetError(f"{path}: {BROKEN} ({error})") from error
    raise DatasetError(
        f"{path} has no column {missing[0]!r}; it has {', '.join(present[:12])}. "
        "A data set's features are those of its meta/info.json"
    )


def read_header(folder: Path, fps: int | None) -> Header:
    """Read and check ``meta/info.json``.

    Args:
        folder: Of the data set.
        fps: Frames a second that are wanted; None takes any.

    Raises:
        DatasetError: If it is not that of a LeRobot v3 data set with states and actions.
    """
    path = folder / layout.INFO_FILE
    info = read_json(path)
    version = info.get("codebase_version") if isinstance(info, dict) else None
    if not str(version).startswith("v3."):
        raise DatasetError(
            f"{path}: codebase_version is {version!r}, and only LeRobot's v3 is read. A v2.1 set "
            "is converted by `python -m lerobot.scripts.convert_dataset_v21_to_v30`"
        )
    for key, kind in REQUIRED_INFO.items():
        if not isinstance(info.get(key), kind):
            listing = ", ".join(REQUIRED_INFO)
            raise DatasetError(
                f"{path}: {key} is {info.get(key, 'missing')!r}; LeRobot v3 sets have {listing}"
            )
    if fps is not None and info["fps"] != fps:
        raise DatasetError(
            f"{path}: fps is {info['fps']}; motor actions here are steps of {fps} a second: "
            f"resample the data set to {fps}"
        )
    features = info["features"]
    widths = {
        STATE_KEY: _width(path, features, STATE_KEY, None),
        layout.ACTION_KEY: _width(path, features, layout.ACTION_KEY, len(ACTION_NAMES)),
    }
    for key in (ENVIRONMENT_STATE_KEY, layout.SIMULATOR_STATE_KEY):
        if key in features:
            widths[key] = _width(path, features, key, None)
    return Header(folder, info, widths)


def _width(path: Path, features: Mapping[str, Any], key: str, wanted: int | None) -> int:
    asked = f"{wanted} numbers" if wanted else "a vector of numbers"
    if key not in features:
        listing = ", ".join(sorted(features))
        raise DatasetError(
            f"{path}: no feature {key!r}; it should be {asked} per frame. Features: {listing}"
        )
    kind, shape = features[key].get("dtype"), features[key].get("shape")
    floating = kind in ("float32", "float64")
    if not floating or not isinstance(shape, list) or len(shape) != 1:
        raise DatasetError(
            f"{path}: feature {key!r} is {kind} of shape {shape}; it should be {asked} per frame, "
            "float32 or float64"
        )
    if wanted is not None and shape[0] != wanted:
        raise DatasetError(
            f"{path}: feature {key!r} has {shape[0]} numbers; it should have {wanted} "
            f"({', '.join(ACTION_NAMES)})"
        )
    return int(shape[0])


def read_entries(header: Header) -> list[EpisodeEntry]:
    """Read ``meta/episodes``.

    Raises:
        DatasetError: If it is missing, broken or not what ``meta/info.json`` says.
    """
    root = header.folder / layout.EPISODES_FOLDER
    files = sorted(root.glob("chunk-*/file-*.parquet"))
    if not files:
        raise DatasetError(f"{root} has no file chunk-000/file-000.parquet: no episodes are listed")
    entries = []
    for path in files:
        columns = read_table(path, EPISODE_COLUMNS).to_pydict()
        for index, length, tasks, chunk, file in zip(
            *(columns[name] for name in EPISODE_COLUMNS), strict=True
        ):
            task = tasks[0] if tasks else ""
            entries.append(EpisodeEntry(index, length, task, _data_file(header, chunk, file)))
    entries.sort(key=lambda entry: entry.index)
    count = header.info["total_episodes"]
    if [entry.index for entry in entries] != list(range(count)):
        raise DatasetError(
            f"{root} lists {len(entries)} episodes and {header.info_file} says total_episodes "
            f"{count}: they should be the same, numbered from 0. Was the recording interrupted?"
        )
    return entries


def _data_file(header: Header, chunk: int, file: int) -> Path:
    template = header.info["data_path"]
    try:
        return header.folder / str(template.format(chunk_index=chunk, file_index=file))
    except (LookupError, TypeError, ValueError, AttributeError):
        raise DatasetError(
            f"{header.info_file}: data_path is {template!r}; LeRobot has {layout.DATA_FILE!r}"
        ) from None


def read_columns(header: Header, entries: Sequence[EpisodeEntry]) -> dict[int, Columns]:
    """Read the numbers of episodes.

    Returns:
        For each episode's index, each feature's ``(length, width)``.

    Raises:
        DatasetError: If a file is missing or broken, or holds something else than it should.
    """
    everything = len(entries) == header.info["total_episodes"]
    result: dict[int, Columns] = {}
    for path in dict.fromkeys(entry.file for entry in entries):
        mates = [entry for entry in entries if entry.file == path]
        chosen = None if everything else [entry.index for entry in mates]
        table = read_table(path, ["episode_index", "frame_index", *header.widths], chosen)
        owner = _numbers(path, table, "episode_index", 1)[:, 0]
        steps = _numbers(path, table, "frame_index", 1)[:, 0]
        columns = {key: _numbers(path, table, key, width) for key, width in header.widths.items()}
        order = np.argsort(owner, kind="stable")
        for entry in mates:
            low, high = np.searchsorted(owner, [entry.index, entry.index + 1], sorter=order)
            rows = order[low:high]
            if not np.array_equal(steps[rows], np.arange(entry.length)):
                raise DatasetError(
                    f"{path}: episode {entry.index} has {len(rows)} frames; it should have the "
                    f"frames 0 to {entry.length - 1} in order, as {layout.EPISODES_FOLDER} says"
                )
            result[entry.index] = {key: values[rows] for key, values in columns.items()}
            _check_finite(path, entry.index, result[entry.index])
    return result


def _numbers(path: Path, table: Any, key: str, width: int) -> NDArray[Any]:
    """Return a column as ``(rows, width)``."""
    import pyarrow.types as kinds

    column = table[key].combine_chunks()
    kind = column.type
    nested = kinds.is_list(kind) or kinds.is_large_list(kind) or kinds.is_fixed_size_list(kind)
    flat = column.flatten() if nested else column
    fits = kinds.is_floating(flat.type) or kinds.is_integer(flat.type)
    if column.null_count or not fits or flat.null_count or len(flat) != len(column) * width:
        raise DatasetError(
            f"{path}: column {key!r} is {kind}, with {column.null_count} empty rows and "
            f"{len(flat)} numbers in {len(column)} rows; it should be {width} numbers in every row"
        )
    if nested and not kinds.is_fixed_size_list(kind) and len(column):
        lengths = np.diff(column.offsets.to_numpy())
        if np.any(lengths != width):
            row = int(np.argmax(lengths != width))
            raise DatasetError(
                f"{path}: column {key!r} has {lengths[row]} numbers in row {row}; it should be "
                f"{width} in every row"
            )
    values: NDArray[Any] = flat.to_numpy(zero_copy_only=False)
    return values.reshape(len(column), width)


def _check_finite(path: Path, episode: int, columns: Columns) -> None:
    for key, values in columns.items():
        bad = ~np.isfinite(values).all(axis=1)
        if bad.any():
            raise DatasetError(
                f"{path}: column {key!r} holds NaN or infinity in episode {episode}, frame "
                f"{int(np.argmax(bad))}; all numbers should be finite"
            )
