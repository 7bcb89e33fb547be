"""HDF5 files of recordings: opening them, and what is wrong with others."""

import json
import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from prime_core.errors import DatasetError, DemonstrationError, PrimeError

SIGNATURE = b"\x89HDF\r\n\x1a\n"
MOST_NUMBERS = 20_000_000
"""In an array of a demonstration; an hour of Lift has a tenth of it."""
SIMULATOR_STATES = "simulator_states"
"""In a demonstration that prime wrote: whole states of each frame, the one after the last action
included. No other program reads it."""
LAYOUTS = (
    "Expected is the layout of robosuite's collect_human_demonstrations or of robomimic: a group "
    "'data' with a group for each demonstration"
)


@contextmanager
def open_file(path: Path) -> Iterator[Any]:
    """Open an HDF5 file for reading.

    Raises:
        DatasetError: If it cannot be opened.
    """
    import h5py

    try:
        with path.open("rb") as raw:
            begins = raw.read(len(SIGNATURE))
    except FileNotFoundError:
        raise DatasetError(
            f"{path}: there is no such file (path of demonstrator 'robosuite-hdf5')"
        ) from None
    except OSError as error:
        raise DatasetError(f"{path}: cannot be read: {error.strerror or error}") from error
    try:
        file = h5py.File(path, "r")
    except BlockingIOError as error:
        raise DatasetError(
            f"{path}: is open for writing elsewhere: end what records into it, then read it"
        ) from error
    except OSError as error:
        if begins != SIGNATURE:
            raise DatasetError(
                f"{path}: is not an HDF5 file; robosuite's recorder writes demo.hdf5"
            ) from error
        raise DatasetError(
            f"{path}: cannot be read: {_reason(error)}. It was not closed or not copied to its end"
        ) from error
    with file:
        yield file


@contextmanager
def told(where: str, kind: type[DatasetError]) -> Iterator[None]:
    """Tell what h5py cannot read as an error of ours.

    Args:
        where: File, and group if it is about one.
        kind: Of which kind.
    """
    # h5py tells damage inside a file by any of these.
    try:
        yield
    except PrimeError:
        raise
    except (OSError, MemoryError, RuntimeError, LookupError, ValueError, TypeError) as error:
        raise kind(f"{where}: cannot be read: {_reason(error)}") from error


def _reason(error: Exception) -> str:
    """Return what h5py says in brackets, which is the reason, or all of its first line."""
    line = (str(error.args[0]) if error.args else str(error)).strip().partition("\n")[0]
    inner = re.search(r"\((.+)\)$", line)
    return inner.group(1) if inner else line


def data_of(path: Path, file: Any) -> Any:
    """Return the group that holds the demonstrations."""
    import h5py

    if not isinstance(file.get("data"), h5py.Group):
        found = ", ".join(sorted(file)) or "nothing"
        raise DatasetError(f"{path}: has no group 'data'; it holds {found}. {LAYOUTS}")
    return file["data"]


def text_of(where: str, holder: Any, name: str) -> str | None:
    """Return an attribute that is a text, None where there is none.

    Args:
        where: File and group, for the error.
        holder: The group.
        name: Of the attribute.

    Raises:
        DatasetError: If it is anything else.
    """
    value = holder.attrs.get(name)
    if isinstance(value, np.ndarray) and value.size == 1:
        value = value.item()
    if isinstance(value, bytes):
        value = value.decode("utf-8", errors="replace")
    if value is not None and not isinstance(value, str):
        raise DatasetError(f"{where}: attribute {name!r} is {value!r}; it must be a text")
    return value


def table_of(where: str, holder: Any, name: str) -> dict[str, Any] | None:
    """Return an attribute that is a table in JSON, None where there is none.

    Raises:
        DatasetError: If it is anything else.
    """
    text = text_of(where, holder, name)
    if text is None:
        return None
    try:
        found = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise DatasetError(f"{where}: attribute {name!r} is not JSON: {error}") from None
    if not isinstance(found, dict):
        raise DatasetError(
            f"{where}: attribute {name!r} is {text[:60]!r}; it must be a table in JSON"
        )
    return found


def names_of(path: Path, data: Any, chosen: Sequence[str] | None) -> list[str]:
    """Return the groups to read.

    Args:
        path: Of the file.
        data: What `data_of` returned.
        chosen: Groups that are asked for; None for all, in the order of their numbers.

    Raises:
        DatasetError: If one of them is not in the file, or there are none.
    """
    found = sorted(data, key=_number)
    present = set(found)
    for name in chosen or ():
        if name not in present:
            groups = ", ".join(found) or "none"
            raise DatasetError(f"{path}: has no group data/{name}; there are: {groups}")
    names = list(found if chosen is None else chosen)
    if not names:
        raise DatasetError(f"{path}: holds no demonstration, group 'data' is empty")
    return names


def array_of(where: str, group: Any, key: str) -> NDArray[np.float64]:
    """Return a two-dimensional array of a demonstration as float64.

    Args:
        where: File and group.
        group: Of the demonstration.
        key: Of the array in the group.

    Raises:
        DemonstrationError: If there is no such array of finite numbers.
    """
    import h5py

    if not isinstance(group.get(key), h5py.Dataset):
        found = ", ".join(sorted(group)) or "nothing"
        raise DemonstrationError(f"{where}: has no data set {key!r}; it holds {found}")
    stored = group[key]
    if stored.dtype.kind not in "fiu":
        raise DemonstrationError(f"{where}/{key} holds {stored.dtype}; it must hold numbers")
    if stored.size is not None and stored.size > MOST_NUMBERS:
        # A file of kilobytes may stand for them: what was never written takes up nothing.
        raise DemonstrationError(
            f"{where}/{key} has the shape {stored.shape}; at most {MOST_NUMBERS} numbers are read"
        )
    values = np.asarray(stored, dtype=np.float64)
    least = 1 if SIMULATOR_STATES in group else 2  # where they hold the frame after the last action
    if values.ndim != 2 or len(values) < least or not np.all(np.isfinite(values)):
        raise DemonstrationError(
            f"{where}/{key} of shape {values.shape} must hold two rows of finite numbers or more"
        )
    return values


def _number(name: str) -> tuple[int, str]:
    """Return a key that sorts ``demo_10`` after ``demo_9``."""
    digits = re.search(r"\d+$", name)
    return (int(digits.group()) if digits else -1, name)
