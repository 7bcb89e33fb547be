"""Reads the parquet files of a LeRobot v3 data set, and says clearly what is wrong with one."""

import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from prime_core.errors import DatasetError

MOST_NUMBERS = 100_000_000
"""In a file; those of LeRobot's size hold a fifth of it."""

BROKEN = (
    "the file is broken or was never finished (LeRobot's recorder completes its files in "
    "finalize(); a recording that was killed before cannot be read): record it again, or take a "
    "whole copy"
)


def list_files(root: Path, pattern: str) -> list[Path]:
    """Return a folder's files in order.

    Raises:
        DatasetError: If there are none, or the folder cannot be read.
    """
    try:
        os.listdir(root)  # glob keeps silent about a folder that it may not read
    except (FileNotFoundError, NotADirectoryError):
        pass
    except OSError as error:
        raise DatasetError(f"{root} cannot be read: {error.strerror or error}") from error
    files = sorted(root.glob(pattern))
    if not files:
        raise DatasetError(f"{root} has no file chunk-000/file-000.parquet: no episodes are listed")
    return files


def read_table(
    path: Path,
    columns: Sequence[str],
    episodes: Sequence[int] | None = None,
    optional: Sequence[str] = (),
) -> Any:
    """Read columns of a parquet file as an arrow table.

    Args:
        path: The file.
        columns: Which columns.
        episodes: Which episodes; all if None.
        optional: More columns, which need not be there.

    Raises:
        DatasetError: If the file is missing or broken, or a column is missing.
    """
    import pyarrow.parquet as pq

    try:
        with path.open("rb"):
            pass
    except (FileNotFoundError, NotADirectoryError):
        raise DatasetError(f"{path} is missing: the data set is not complete") from None
    except OSError as error:
        raise DatasetError(f"{path} cannot be read: {error.strerror or error}") from error
    with _broken_told(path):
        metadata = pq.read_metadata(path)
        present = metadata.schema.to_arrow_schema().names
        columns = [*columns, *(name for name in optional if name in present)]
        _check_columns(path, present, columns)
        _check_size(path, metadata, columns)
        chosen = None if episodes is None else [("episode_index", "in", list(episodes))]
        # Without partitioning=None a folder named "seed=0" would become a column.
        return pq.read_table(path, columns=columns, filters=chosen, partitioning=None)


def row_groups(path: Path) -> Iterator[tuple[Any, str]]:
    """Yield the row groups of a parquet file one after another, all columns of each.

    Yields:
        An arrow table, and by what it is compressed, as `pyarrow.parquet.ParquetWriter` has it.

    Raises:
        DatasetError: If the file is missing or broken.
    """
    import pyarrow.parquet as pq

    read_table(path, [])
    with pq.ParquetFile(path) as file:
        for number in range(file.num_row_groups):
            with _broken_told(path):
                codec = file.metadata.row_group(number).column(0).compression.lower()
                table = file.read_row_group(number)
            yield table, "none" if codec == "uncompressed" else codec


def whole_table(path: Path) -> Any:
    """Return all columns of a parquet file as an arrow table.

    Raises:
        DatasetError: If the file is missing or broken.
    """
    import pyarrow.parquet as pq

    read_table(path, [])
    with _broken_told(path):
        return pq.read_table(path, partitioning=None)


@contextmanager
def _broken_told(path: Path) -> Iterator[None]:
    """Turn arrow's errors into what a user can mend."""
    import pyarrow as pa

    try:
        yield
    except (pa.ArrowException, OSError, ValueError, TypeError) as error:
        raise DatasetError(f"{path}: {BROKEN} ({_first_line(error)})") from error


def _check_columns(path: Path, present: Sequence[str], columns: Sequence[str]) -> None:
    """Make sure that each column stands there once.

    Raises:
        DatasetError: If one does not.
    """
    for name in columns:
        if name not in present:
            raise DatasetError(
                f"{path} has no column {name!r}; it has {', '.join(present[:12])}. "
                "A data set's features are those of its meta/info.json"
            )
        if present.count(name) > 1:
            raise DatasetError(f"{path}: column {name!r} stands {present.count(name)} times")


def _check_size(path: Path, metadata: Any, columns: Sequence[str]) -> None:
    """Make sure that memory holds what a file stands for: equal values take up next to nothing.

    Raises:
        DatasetError: If it does not.
    """
    groups = map(metadata.row_group, range(metadata.num_row_groups))
    chunks = (group.column(number) for group in groups for number in range(group.num_columns))
    wanted = tuple(f"{name}." for name in columns)  # names hold dots, and so do paths of lists
    count = sum(
        chunk.num_values for chunk in chunks if f"{chunk.path_in_schema}.".startswith(wanted)
    )
    if not 0 <= count <= MOST_NUMBERS:
        raise DatasetError(
            f"{path} holds {count} numbers in the columns that are read; at most {MOST_NUMBERS} of "
            "a file are read: LeRobot begins another file after 100 MB"
        )


def _first_line(error: Exception) -> str:
    return str(error).strip().partition("\n")[0]


def _whole(column: Any) -> Any:
    """Return a column as one array, and what pandas stores as categories as what it means."""
    import pyarrow.types as kinds

    column = column.combine_chunks()
    return column.dictionary_decode() if kinds.is_dictionary(column.type) else column


def _is_nested(kind: Any) -> bool:
    """Return whether a type is one of lists."""
    import pyarrow.types as kinds

    checks = (kinds.is_list, kinds.is_large_list, kinds.is_fixed_size_list)
    return any(check(kind) for check in checks)


def numbers(path: Path, table: Any, key: str, width: int) -> NDArray[Any]:
    """Return a column as ``(rows, width)``.

    Raises:
        DatasetError: If it holds anything but so many numbers in each row.
    """
    import pyarrow.types as kinds

    column = _whole(table[key])
    kind = column.type
    nested = _is_nested(kind)
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


def whole_numbers(path: Path, table: Any, key: str) -> NDArray[np.int64]:
    """Return a column of one whole number a row, ``(rows,)``.

    Raises:
        DatasetError: If it holds anything else.
    """
    import pyarrow.types as kinds

    column = _whole(table[key])
    if not kinds.is_integer(column.type) or column.null_count:
        empty = f", with {column.null_count} empty rows" if column.null_count else ""
        raise DatasetError(
            f"{path}: column {key!r} is {column.type}{empty}; it should be a whole number (int64) "
            "in every row: an editor may have changed its type"
        )
    return np.asarray(column.to_numpy(zero_copy_only=False)).astype(np.int64)


def lists_of_numbers(path: Path, table: Any, key: str) -> list[NDArray[np.float64]]:
    """Return a column of lists of any length.

    Raises:
        DatasetError: If it holds anything but lists of numbers.
    """
    import pyarrow.types as kinds

    column = _whole(table[key])
    kind = column.type
    inner = kind.value_type if _is_nested(kind) else kind
    fits = kinds.is_floating(inner) or kinds.is_integer(inner) or kinds.is_null(inner)
    if not _is_nested(kind) or not fits or column.null_count or column.flatten().null_count:
        raise DatasetError(
            f"{path}: column {key!r} is {kind}; it should be a list of numbers in every row"
        )
    return [np.array(row, dtype=np.float64) for row in column.to_pylist()]


def texts(path: Path, table: Any, key: str) -> list[str]:
    """Return a column of texts, the first of each row where rows are lists; "" where none is.

    Raises:
        DatasetError: If it holds anything else.
    """
    import pyarrow.types as kinds

    column = _whole(table[key])
    kind = column.type
    inner = kind.value_type if _is_nested(kind) else kind
    is_text = kinds.is_string(inner) or kinds.is_large_string(inner) or kinds.is_string_view(inner)
    if not is_text and not kinds.is_null(inner):
        raise DatasetError(
            f"{path}: column {key!r} is {kind}; it should be a list of texts in every row"
        )
    rows = column.to_pylist()
    firsts = [next(iter(row), None) if isinstance(row, list) else row for row in rows]
    return [first or "" for first in firsts]


def with_column(table: Any, key: str, values: Any) -> Any:
    """Return a table with a column in the place of the one of its name, or after all others."""
    import pyarrow as pa

    column = pa.array(values) if isinstance(values, list) else values
    if key not in table.column_names:
        return table.append_column(key, column)
    return table.set_column(table.column_names.index(key), key, column)
