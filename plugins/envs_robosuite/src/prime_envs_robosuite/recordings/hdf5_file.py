"""The HDF5 files of robosuite's recorder: opening them, and what is wrong with others."""

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from prime_core.errors import DatasetError


def open_file(path: Path) -> Any:
    """Open an HDF5 file for reading."""
    import h5py

    if not path.is_file():
        raise DatasetError(f"{path}: there is no such file (path of demonstrator 'robosuite-hdf5')")
    if not h5py.is_hdf5(path):
        raise DatasetError(f"{path}: is not an HDF5 file; robosuite's recorder writes demo.hdf5")
    return h5py.File(path, "r")


def data_of(path: Path, file: Any) -> Any:
    """Return the group that holds the demonstrations."""
    if "data" not in file:
        found = ", ".join(sorted(file)) or "nothing"
        raise DatasetError(
            f"{path}: has no group 'data'; it holds {found}. Expected is the layout of "
            "robosuite's collect_human_demonstrations"
        )
    return file["data"]


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
    for name in chosen or ():
        if name not in found:
            groups = ", ".join(found) or "none"
            raise DatasetError(f"{path}: has no group data/{name}; there are: {groups}")
    names = list(found if chosen is None else chosen)
    if not names:
        raise DatasetError(f"{path}: holds no demonstration, group 'data' is empty")
    return names


def array_of(path: Path, data: Any, key: str) -> NDArray[np.float64]:
    """Return a two-dimensional array of the file as float64."""
    if key not in data:
        raise DatasetError(f"{path}: has no data set data/{key}")
    values = np.asarray(data[key], dtype=np.float64)
    if values.ndim != 2 or len(values) < 2 or not np.all(np.isfinite(values)):
        raise DatasetError(
            f"{path}: data/{key} of shape {values.shape} must hold two rows of finite numbers or "
            "more"
        )
    return values


def _number(name: str) -> tuple[int, str]:
    """Return a key that sorts ``demo_10`` after ``demo_9``."""
    digits = re.search(r"\d+$", name)
    return (int(digits.group()) if digits else -1, name)
