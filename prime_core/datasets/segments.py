"""Segments in a LeRobot data set: our table, the label of each frame, LeRobot's motion rows."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from prime_core.contracts.calls import (
    OTHER,
    Parameter,
    ParameterSpace,
    PrimitiveCall,
    PrimitiveSpace,
)
from prime_core.contracts.demonstration import Segment
from prime_core.datasets.files.parquet_reader import (
    lists_of_numbers,
    numbers,
    read_table,
    texts,
    whole_numbers,
)

SegmentLists = Sequence[Sequence[Segment]]


SEGMENT_COLUMNS = ("episode", "start", "end", "primitive", "parameters", "log_probability")


CONFIDENCE = "confidence"
"""A column that older data sets have not."""


MOTION = "motion"
"""LeRobot's style of rows that say what a robot does."""


def check_segments(segments: Sequence[Segment], frames: int, space: PrimitiveSpace) -> None:
    """Check the segments of one demonstration.

    Raises:
        ValueError: If they overlap, leave the demonstration, or call what is not in the space.
    """
    reached = 0
    for segment in segments:
        if not reached <= segment.start < segment.end < frames:
            raise ValueError(
                f"segment {segment.start} to {segment.end} does not fit: segments are in order, "
                f"the next begins at {reached} or later and ends at {frames - 1} or earlier"
            )
        name = segment.call.primitive
        if name != OTHER and name not in space.names:
            known = ", ".join(space.names)
            raise ValueError(f"segment calls {name!r}; the space has {known} and {OTHER}")
        count = 0 if name == OTHER else len(_parameters_of(space, name))
        if segment.call.parameters.shape != (count,):
            raise ValueError(
                f"segment {segment.start} to {segment.end}: {name} has {count} parameters, "
                f"not an array of shape {segment.call.parameters.shape}"
            )
        reached = segment.end


def frame_labels(
    segments: Sequence[Segment], frames: int, space: PrimitiveSpace
) -> NDArray[np.int64]:
    """Return the class of each frame, ``(frames,)``; frames without a segment are `other`.

    The last frame, which no action leaves, has the class of the segment that ends there.
    """
    classes = (*space.names, OTHER)
    labels = np.full(frames, len(space.names), dtype=np.int64)
    for segment in segments:
        end = frames if segment.end == frames - 1 else segment.end
        labels[segment.start : end] = classes.index(segment.call.primitive)
    return labels


def motion_text(call: PrimitiveCall, space: PrimitiveSpace) -> str:
    """Return a primitive call in words, such as ``grasp(x=0.512 m, yaw=0.310 rad)``."""
    if call.primitive == OTHER:
        return OTHER
    parameters = _parameters_of(space, call.primitive).parameters
    pairs = zip(parameters, call.parameters, strict=True)
    words = ", ".join(f"{item.name}={value:.3f} {item.unit}" for item, value in pairs)
    return f"{call.primitive}({words})"


def _parameters_of(space: PrimitiveSpace, primitive: str) -> ParameterSpace:
    return space.parameter_spaces[space.names.index(primitive)]


def motion_rows(segments: Sequence[Segment], space: PrimitiveSpace, clock: NDArray[Any]) -> Any:
    """Return LeRobot's persistent language rows of one episode, one a segment.

    A row holds from its timestamp until the next row of its style, so `other` has rows too.

    Args:
        segments: Of the episode.
        space: Their primitives.
        clock: Timestamps of the episode's frames [s], ``(frames,)``.
    """
    import pyarrow as pa

    texts = [motion_text(segment.call, space) for segment in segments]
    count = len(segments)
    return pa.StructArray.from_arrays(
        [
            pa.array(["assistant"] * count, pa.string()),
            pa.array(texts, pa.string()),
            pa.array([MOTION] * count, pa.string()),
            pa.array([clock[segment.start] for segment in segments], pa.float32()),
            pa.nulls(count, pa.string()),
            pa.nulls(count, pa.list_(pa.json_())),
        ],
        names=["role", "content", "style", "timestamp", "camera", "tool_calls"],
    )


def at_every_frame(rows: Any, frames: int) -> Any:
    """Return a column that holds an episode's rows at each of its frames, as LeRobot has them."""
    import pyarrow as pa

    count = len(rows)
    offsets = pa.array(np.arange(frames + 1, dtype=np.int32) * count)
    repeats = pa.array(np.tile(np.arange(count, dtype=np.int64), frames))
    return pa.ListArray.from_arrays(offsets, rows.take(repeats))


def segment_table(segments: SegmentLists) -> Any:
    """Return the segments of all episodes as an arrow table."""
    import pyarrow as pa

    rows = [(episode, item) for episode, items in enumerate(segments) for item in items]
    return pa.table(
        {
            "episode": pa.array([episode for episode, _ in rows], pa.int64()),
            "start": pa.array([item.start for _, item in rows], pa.int64()),
            "end": pa.array([item.end for _, item in rows], pa.int64()),
            "primitive": pa.array([item.call.primitive for _, item in rows], pa.string()),
            "parameters": pa.array(
                [item.call.parameters.tolist() for _, item in rows], pa.list_(pa.float64())
            ),
            "log_probability": pa.array([item.log_probability for _, item in rows], pa.float64()),
            CONFIDENCE: pa.array([item.confidence for _, item in rows], pa.float64()),
        }
    )


def read_segments(path: Path) -> dict[int, tuple[Segment, ...]]:
    """Return the segments in a parquet file, by episode.

    Raises:
        DatasetError: If it is not the file of such a table.
    """
    table = read_table(path, SEGMENT_COLUMNS, optional=[CONFIDENCE])
    episodes, starts, ends = (
        whole_numbers(path, table, name).tolist() for name in ("episode", "start", "end")
    )
    primitives = texts(path, table, "primitive")
    parameters = lists_of_numbers(path, table, "parameters")
    scores = numbers(path, table, "log_probability", 1)[:, 0].tolist()
    confidences = _confidences(path, table)
    found: dict[int, list[Segment]] = {}
    columns = zip(episodes, starts, ends, primitives, parameters, scores, confidences, strict=True)
    for episode, start, end, primitive, values, score, confidence in columns:
        segment = Segment(start, end, PrimitiveCall(primitive, values), score, confidence)
        found.setdefault(episode, []).append(segment)
    return {episode: tuple(items) for episode, items in found.items()}


def _confidences(path: Path, table: Any) -> list[float | None]:
    """Return the confidence of each segment; None where none is known."""
    if CONFIDENCE not in table.column_names or table[CONFIDENCE].null_count == len(table):
        return [None] * len(table)
    found: list[float | None] = numbers(path, table, CONFIDENCE, 1)[:, 0].tolist()
    return found


def dump_space(space: PrimitiveSpace) -> list[dict[str, Any]]:
    """Return a primitive space as plain data."""
    pairs = zip(space.names, space.parameter_spaces, strict=True)
    return [
        {"name": name, "parameters": [vars(item) for item in parameters.parameters]}
        for name, parameters in pairs
    ]


def load_space(dump: Sequence[Mapping[str, Any]]) -> PrimitiveSpace:
    """Return the primitive space that `dump_space` made plain.

    Raises:
        KeyError: If a name is missing.
        TypeError: If a parameter has not the keys of `Parameter`, or a name is no text.
    """
    for item in dump:
        if not isinstance(item["name"], str):
            raise TypeError(f"the name of a primitive is {item['name']!r}")
    spaces = (
        ParameterSpace(tuple(Parameter(**parameter) for parameter in item["parameters"]))
        for item in dump
    )
    return PrimitiveSpace(tuple(item["name"] for item in dump), tuple(spaces))
