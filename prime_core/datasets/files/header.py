"""What ``meta/info.json`` of a LeRobot v3 data set says, checked."""

import json
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeGuard

from prime_core.configuration import GREATEST_COUNT
from prime_core.contracts.environment import ACTION_NAMES
from prime_core.contracts.observations import ENVIRONMENT_STATE_KEY, IMAGE_PREFIX, STATE_KEY
from prime_core.datasets.columns.settings import ColumnsConfig, named_columns
from prime_core.datasets.files import layout
from prime_core.errors import ConfigurationError, DatasetError

FLOATS = ("float32", "float64")
"""Types of our own features."""

NUMBERS = (*FLOATS, "int64", "int32")
"""Types of features that a mapping may name."""


@dataclass(frozen=True)
class Feature:
    """One feature of a data set.

    Attributes:
        width: How many numbers it has in each frame.
        names: Theirs, in the order of the columns; None where the data set does not say.
    """

    width: int
    names: tuple[str, ...] | None


@dataclass(frozen=True)
class Camera:
    """One camera of a data set.

    Attributes:
        key: Of its feature.
        is_video: Whether its images are frames of videos; else they lie in the data files.
        shape: Of an image, ``(H, W, 3)``.
    """

    key: str
    is_video: bool
    shape: tuple[int, int, int]


@dataclass(frozen=True)
class Header:
    """What ``meta/info.json`` says.

    Attributes:
        folder: Of the data set.
        info: All of it.
        features: Those that are read.
        cameras: Those of colour, by their names.
    """

    folder: Path
    info: dict[str, Any]
    features: dict[str, Feature]
    cameras: dict[str, Camera]

    @property
    def info_file(self) -> Path:
        """Path of ``meta/info.json``."""
        return self.folder / layout.INFO_FILE

    def names(self, key: str) -> tuple[str, ...] | None:
        """Return the names of a feature's numbers, if it has any."""
        return self.features[key].names if key in self.features else None


def read_json(path: Path) -> Any:
    """Read a JSON file.

    Raises:
        DatasetError: If it is not there, cannot be opened, or is not JSON.
    """
    try:
        # Windows' editors begin a file with a byte order mark.
        return json.loads(path.read_text(encoding="utf-8-sig"))
    except (FileNotFoundError, NotADirectoryError):
        raise DatasetError(
            f"{path} is missing: a LeRobot v3 data set is a folder with {layout.INFO_FILE}, "
            f"{layout.EPISODES_FOLDER}/ and data/"
        ) from None
    except OSError as error:
        raise DatasetError(f"{path} cannot be read: {error.strerror or error}") from error
    except (ValueError, RecursionError) as error:
        raise DatasetError(f"{path} is not readable as JSON: {error}") from error


def read_info(folder: Path, fps: int | None) -> dict[str, Any]:
    """Read and check ``meta/info.json``, but for its features.

    Args:
        folder: Of the data set.
        fps: Frames a second that are wanted; None takes any.

    Raises:
        DatasetError: If it is not that of a LeRobot v3 data set.
    """
    path = folder / layout.INFO_FILE
    info = read_json(path)
    version = info.get("codebase_version") if isinstance(info, dict) else None
    if not str(version).startswith("v3."):
        raise DatasetError(
            f"{path}: codebase_version is {version!r}, and only LeRobot's v3 is read. A v2.1 set "
            "is converted by `python -m lerobot.scripts.convert_dataset_v21_to_v30`"
        )
    _check_values(path, info, fps)
    result: dict[str, Any] = info
    return result


def read_header(folder: Path, fps: int | None) -> Header:
    """Read and check ``meta/info.json``.

    Args:
        folder: Of the data set.
        fps: Frames a second that are wanted; None takes any.

    Raises:
        DatasetError: If it is not that of a LeRobot v3 data set with states and actions.
    """
    info, path = read_info(folder, fps), folder / layout.INFO_FILE
    features = info["features"]
    found = {
        STATE_KEY: _feature(path, features, STATE_KEY, "a vector of numbers"),
        layout.ACTION_KEY: _feature(
            path, features, layout.ACTION_KEY, f"{len(ACTION_NAMES)} numbers"
        ),
    }
    for key in (ENVIRONMENT_STATE_KEY, layout.SIMULATOR_STATE_KEY):
        if key in features:
            found[key] = _feature(path, features, key, "a vector of numbers")
    # There is nothing to be read where a scene has no objects.
    found = {key: item for key, item in found.items() if item.width}
    return Header(folder, info, found, _cameras(path, features))


def read_mapped_header(folder: Path, fps: int | None, mapping: ColumnsConfig) -> Header:
    """Read and check ``meta/info.json`` of a data set whose features a mapping names.

    Raises:
        ConfigurationError: If it names a feature that is not there; the text names the key.
        DatasetError: If it is not that of a LeRobot v3 data set, or a feature is no numbers.
    """
    info, path = read_info(folder, fps), folder / layout.INFO_FILE
    features, found = info["features"], {}
    for key, config in named_columns(mapping):
        if config.feature not in features:
            raise ConfigurationError(
                f"{key}.feature: {path} has no feature {config.feature!r}; it has "
                f"{', '.join(sorted(features))}"
            )
        if config.feature not in found:
            asked = "one or more numbers"
            found[config.feature] = _feature(path, features, config.feature, asked, NUMBERS)
    return Header(folder, info, found, _cameras(path, features))


def _check_values(path: Path, info: Mapping[str, Any], fps: int | None) -> None:
    """Check the values beside the features that are read."""
    asked: dict[str, tuple[type | tuple[type, ...], float, str]] = {
        "features": (dict, 0, "a table of features"),
        "fps": ((int, float), sys.float_info.max, "a number of frames a second above 0"),
        "total_episodes": (int, GREATEST_COUNT, f"a whole number, 1 to {GREATEST_COUNT}"),
        "data_path": (str, 0, f"a path such as {layout.DATA_FILE!r}"),
    }
    for key, (kind, most, what) in asked.items():
        value = info.get(key, "missing")
        outside = isinstance(value, int | float) and not 0 < value <= most
        if key not in info or not isinstance(value, kind) or isinstance(value, bool) or outside:
            raise DatasetError(f"{path}: {key} is {value!r}; it should be {what}")
    if fps is not None and info["fps"] != fps:
        raise DatasetError(
            f"{path}: fps is {info['fps']}; motor actions here are steps of {fps} a second: "
            f"resample the data set to {fps}"
        )


def _feature(
    path: Path,
    features: Mapping[str, Any],
    key: str,
    asked: str,
    kinds: Sequence[str] = FLOATS,
) -> Feature:
    if key not in features:
        listing = ", ".join(sorted(features))
        raise DatasetError(
            f"{path}: no feature {key!r}; it should be {asked} per frame. Features: {listing}"
        )
    entry = features[key]
    if not isinstance(entry, dict):
        raise DatasetError(
            f"{path}: feature {key!r} is {entry!r}; it should be a table with dtype, shape and "
            "names"
        )
    kind, shape = entry.get("dtype"), entry.get("shape")
    width = shape[0] if isinstance(shape, list) and len(shape) == 1 else None
    if kind not in kinds or not _is_count(width):
        raise DatasetError(
            f"{path}: feature {key!r} is {kind} of shape {shape}; it should be {asked} per frame, "
            f"{' or '.join(kinds)}"
        )
    if kinds == FLOATS:
        _check_width(path, key, width)
    return Feature(width, _names(path, key, entry.get("names"), width))


def _check_width(path: Path, key: str, width: int) -> None:
    """Check the width of a feature that every data set of ours has."""
    right = f"{len(ACTION_NAMES)} ({', '.join(ACTION_NAMES)})"
    if key == layout.ACTION_KEY and width != len(ACTION_NAMES):
        raise DatasetError(f"{path}: feature {key!r} has {width} numbers; it should have {right}")
    if key == STATE_KEY and not width:
        raise DatasetError(f"{path}: feature {key!r} has no numbers; it should have some")


def _cameras(path: Path, features: Mapping[str, Any]) -> dict[str, Camera]:
    cameras = {}
    for key, entry in features.items():
        kind = entry.get("dtype") if isinstance(entry, dict) else None
        if kind not in ("image", "video") or _is_depth(entry):
            continue
        shape = entry.get("shape")
        if not isinstance(shape, list) or len(shape) != 3 or not all(map(_is_count, shape)):
            raise DatasetError(
                f"{path}: feature {key!r} is {kind} of shape {shape}; it should be [height, width, "
                "3]"
            )
        # Older data sets of LeRobot name the channels first; the images are the same.
        height, width, channels = shape if shape[2] == 3 else (*shape[1:], shape[0])
        if channels == 3:
            name = key.removeprefix(IMAGE_PREFIX)
            cameras[name] = Camera(key, kind == "video", (height, width, channels))
    return cameras


def _is_depth(entry: Mapping[str, Any]) -> bool:
    """Return whether a feature is one of distances, by any of the marks that LeRobot made."""
    tables = [entry.get("info"), entry.get("video_info")]
    marks = ("is_depth_map", "video.is_depth_map")
    return any(table.get(mark) for table in tables if isinstance(table, dict) for mark in marks)


def _is_count(value: object) -> TypeGuard[int]:
    return isinstance(value, int) and not isinstance(value, bool) and value >= 0


def _names(path: Path, key: str, found: object, width: int) -> tuple[str, ...] | None:
    """Return the names of a feature's numbers.

    LeRobot's tools write them as a list, as a list under one heading such as ``motors``, or as
    a table of the columns' numbers.
    """
    if found is None or found == []:
        return None
    names = found
    numbered = isinstance(names, dict) and all(map(_is_count, names.values()))
    if isinstance(names, dict) and numbered and sorted(names.values()) == [*range(width)]:
        names = sorted(names, key=names.__getitem__)
    elif isinstance(names, dict) and len(names) == 1:
        (names,) = names.values()
    if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
        raise DatasetError(
            f"{path}: names of feature {key!r} is {found!r}; it should be a list of {width} names, "
            "or null"
        )
    if len(names) != width or len(set(names)) != width:
        raise DatasetError(
            f"{path}: feature {key!r} has {width} numbers and {len(set(names))} different names: "
            f"{', '.join(names)}. Give one name for each number, or null"
        )
    return tuple(names)
