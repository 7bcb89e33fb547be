"""Segments in the data files: the label of each frame, and LeRobot's rows of style `motion`."""

import shutil
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from prime_core.contracts.calls import PrimitiveSpace
from prime_core.contracts.demonstration import Segment
from prime_core.datasets.files import layout
from prime_core.datasets.files.parquet_reader import (
    numbers,
    read_table,
    row_groups,
    whole_numbers,
    with_column,
)
from prime_core.datasets.segments import MOTION, at_every_frame, frame_labels, motion_rows
from prime_core.errors import DatasetError

KEYS = ("episode_index", "frame_index")


class Labels:
    """What the frames of a data set are labelled with.

    Args:
        segments: Of each episode.
        frames: How many each episode has.
        space: The primitives.
        fps: Frames a second, where frames have no timestamps.
    """

    def __init__(
        self,
        segments: Mapping[int, Sequence[Segment]],
        frames: Mapping[int, int],
        space: PrimitiveSpace,
        fps: float,
    ) -> None:
        self.segments, self.space, self.fps = segments, space, fps
        self._frames = frames

    @cached_property
    def by_episode(self) -> dict[int, NDArray[np.int64]]:
        """The class of each frame, ``(frames,)``, of each episode."""
        return {
            index: frame_labels(items, self._frames[index], self.space)
            for index, items in self.segments.items()
        }


def annotate_data_file(source: Path, target: Path, labels: Labels) -> None:
    """Write a data file anew with labels; its other columns hold the same, bit for bit.

    Args:
        source: The file, one row group in memory at a time.
        target: Where the new one goes.
        labels: Of all episodes.

    Raises:
        DatasetError: If the file is broken, or holds frames that its data set does not list.
    """
    import pyarrow.parquet as pq

    rows = _language_rows(source, labels)
    target.parent.mkdir(parents=True, exist_ok=True)
    with ExitStack() as stack:
        writer = None
        for group, compression in row_groups(source):
            table = _annotated(source, group, labels, rows)
            if writer is None:
                writer = stack.enter_context(
                    pq.ParquetWriter(target, table.schema, compression=compression)
                )
            # LeRobot, too, has one row group per episode: an episode is read alone quickly.
            writer.write_table(table, row_group_size=max(1, len(table)))
    shutil.copymode(source, target)


def _language_rows(path: Path, labels: Labels) -> dict[int, Any]:
    """Return our language rows of each episode in a file, once all its frames are known."""
    table = read_table(path, KEYS, optional=["timestamp"])
    episodes, frames = (whole_numbers(path, table, key) for key in KEYS)
    if not len(table):
        raise DatasetError(f"{path}: holds no frames: record the data set again")
    clock = frames / labels.fps
    if "timestamp" in table.column_names:
        clock = numbers(path, table, "timestamp", 1)[:, 0]
    result = {}
    for episode in np.unique(episodes).tolist():
        here = episodes == episode
        known = labels.by_episode.get(episode)
        if known is None or not np.array_equal(np.sort(frames[here]), np.arange(len(known))):
            raise DatasetError(
                f"{path}: the frames of episode {episode} are not those that "
                f"{layout.EPISODES_FOLDER} lists: record the data set again, or take a whole copy"
            )
        times = clock[here][np.argsort(frames[here])]
        result[episode] = motion_rows(labels.segments[episode], labels.space, times)
    return result


def _annotated(path: Path, table: Any, labels: Labels, rows: Mapping[int, Any]) -> Any:
    """Return a part of a data file with labels and language rows."""
    import pyarrow as pa

    episodes, frames = (whole_numbers(path, table, key) for key in KEYS)
    runs = np.split(np.arange(len(table)), np.flatnonzero(np.diff(episodes)) + 1)
    classes = [labels.by_episode[int(episodes[run[0]])][frames[run]] for run in runs]
    pieces = [rows[int(episodes[run[0]])] for run in runs]
    counts = [len(run) for run in runs]
    table = with_column(table, layout.PRIMITIVE_INDEX_KEY, pa.array(np.concatenate(classes)))
    if layout.MOTION_KEY not in table.column_names:
        parts = [at_every_frame(piece, count) for piece, count in zip(pieces, counts, strict=True)]
        return with_column(table, layout.MOTION_KEY, pa.concat_arrays(parts))
    given = table[layout.MOTION_KEY].combine_chunks()
    return with_column(table, layout.MOTION_KEY, _merged(path, given, pieces, counts))


def _merged(path: Path, given: Any, pieces: Sequence[Any], counts: Sequence[int]) -> Any:
    """Return language rows with ours in the place of those of style `motion`, in order of time.

    Args:
        path: Of the file.
        given: Its column of rows, ``(frames,)``.
        pieces: Our rows of some episodes, one after another.
        counts: How many frames of each of them there are.
    """
    import pyarrow as pa

    rows, names = given.values if pa.types.is_list(given.type) else None, []
    if rows is not None and pa.types.is_struct(rows.type):
        names = [field.name for field in rows.type]
    if rows is None or {"style", "timestamp"} - {*names}:
        raise DatasetError(
            f"{path}: column {layout.MOTION_KEY!r} is {given.type}; it should be LeRobot's "
            "language rows: a list of role, content, style, timestamp, camera and tool_calls"
        )
    ours = pa.concat_arrays([_as(piece, rows.type) for piece in pieces])
    every = pa.concat_arrays([rows, ours])
    times = every.field("timestamp").to_numpy(zero_copy_only=False)
    is_kept = np.array([style != MOTION for style in rows.field("style").to_pylist()], dtype=bool)
    firsts = given.offsets.to_numpy()
    lengths = np.nan_to_num(given.value_lengths().to_numpy(zero_copy_only=False)).astype(np.int64)
    order, sizes, frame, own = [], [], 0, len(rows)
    for piece, count in zip(pieces, counts, strict=True):
        new = np.arange(own, own + len(piece))
        for row in range(frame, frame + count):
            old = firsts[row] + np.arange(lengths[row])
            chosen = np.concatenate((old[is_kept[old]], new))
            order.append(chosen[np.argsort(times[chosen], kind="stable")])
            sizes.append(len(chosen))
        frame, own = frame + count, own + len(piece)
    offsets = pa.array(np.concatenate(([0], np.cumsum(sizes))).astype(np.int32))
    # Arrow takes nothing of an empty array of JSON.
    chosen = every.take(pa.array(np.concatenate(order))) if len(every) else every
    return pa.ListArray.from_arrays(offsets, chosen, type=given.type)


def _as(rows: Any, kind: Any) -> Any:
    """Return our rows with the fields of others' rows; what these have more of is null."""
    import pyarrow as pa

    own = [field.name for field in rows.type]
    columns = []
    for field in kind:
        # There is nothing in our tool calls and cameras, whatever type others have there.
        if field.name in own and rows.field(field.name).null_count < len(rows):
            columns.append(rows.field(field.name).cast(field.type))
        else:
            columns.append(pa.nulls(len(rows), field.type))
    return pa.StructArray.from_arrays(columns, fields=list(kind))
