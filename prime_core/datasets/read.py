"""Demonstrations as LeRobot v3 data sets: what a user keeps, shares or brings.

A frame is an instant, as in `Demonstration`: an episode of ``N`` frames has ``N`` states and
``N`` actions, the last of which is a hold. The last action of a set from elsewhere is not used.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError

from prime_core.configuration import ConfigDump
from prime_core.contracts.calls import PrimitiveSpace
from prime_core.contracts.demonstration import Demonstration, Segment
from prime_core.contracts.description import SceneDescription
from prime_core.contracts.environment import CONTROL_FREQUENCY
from prime_core.contracts.images import ChosenImages, Images
from prime_core.contracts.observations import ENVIRONMENT_STATE_KEY, STATE_KEY, Observations
from prime_core.datasets import segments as parsed
from prime_core.datasets.columns.settings import ColumnsConfig
from prime_core.datasets.feature_columns import MappedColumns, OwnColumns, wanted_names
from prime_core.datasets.files import layout
from prime_core.datasets.files.episodes import Columns, EpisodeEntry, read_entries, read_episodes
from prime_core.datasets.files.header import (
    Header,
    read_header,
    read_info,
    read_json,
    read_mapped_header,
)
from prime_core.datasets.images.embedded import EmbeddedImages
from prime_core.datasets.images.videos import VideoImages
from prime_core.datasets.units import UnitCheck
from prime_core.datasets.write import write_dataset
from prime_core.errors import DatasetError, DemonstrationError

__all__ = ["Dataset", "count_episodes", "read_dataset", "read_demonstrations", "write_dataset"]


@dataclass(frozen=True, eq=False)
class Dataset:
    """What was read from a data set.

    Attributes:
        folder: Where it is.
        demonstrations: The episodes that were asked for.
        episodes: Their indices in the data set.
        fps: Observations a second.
        state_names: Names of the numbers of ``observation.state``, if it has them.
        environment_state_names: The same of ``observation.environment_state``.
        environment: Settings of the environment it comes from, if it is one of ours.
        space: The primitives it was parsed into; None where it is not parsed.
        segments: Of each demonstration; None where the set is not parsed. An episode that was
            added to a parsed set later has none.
    """

    folder: Path
    demonstrations: tuple[Demonstration, ...]
    episodes: tuple[int, ...]
    fps: float
    state_names: tuple[str, ...] | None
    environment_state_names: tuple[str, ...] | None
    environment: ConfigDump | None = None
    space: PrimitiveSpace | None = None
    segments: tuple[tuple[Segment, ...], ...] | None = None


def read_dataset(
    folder: Path | str,
    description: SceneDescription | None = None,
    *,
    episodes: Sequence[int] | None = None,
    fps: int | None = CONTROL_FREQUENCY,
) -> Dataset:
    """Read a LeRobot v3 data set: one of ours, or any whose features fit.

    Args:
        folder: Of the data set. It is left as it is.
        description: Of the environment that it is for, which its features must fit; None takes
            features of any width.
        episodes: Indices of the episodes to read, in this order; all if None.
        fps: Observations a second that it must have; None takes any.

    Raises:
        DatasetError: If it or one of its episodes is broken, or is something else.
    """
    header, own, mapping = open_dataset(Path(folder), fps, None)
    entries = _choose(header, read_entries(header), episodes)
    demonstrations = []
    for found in _demonstrations(header, entries, description, mapping):
        if isinstance(found, DemonstrationError):
            raise found
        demonstrations.append(found)
    space = _read_space(header, own)
    names = {key: header.names(key) for key in (STATE_KEY, ENVIRONMENT_STATE_KEY)}
    if description is not None:  # by which they are ordered
        wanted = wanted_names(description)
        names = {key: tuple(wanted[key]) if found else None for key, found in names.items()}
    return Dataset(
        folder=header.folder,
        demonstrations=tuple(demonstrations),
        episodes=tuple(entry.index for entry in entries),
        fps=header.info["fps"],
        state_names=names[STATE_KEY],
        environment_state_names=names[ENVIRONMENT_STATE_KEY],
        environment=own.get("environment"),
        space=space,
        segments=None if space is None else _read_segments(header, entries, space),
    )


def read_demonstrations(
    folder: Path,
    description: SceneDescription,
    episodes: Sequence[int] | None = None,
    *,
    columns: ColumnsConfig | None = None,
    fps: int | None = CONTROL_FREQUENCY,
) -> Iterator[Demonstration | DemonstrationError]:
    """Read a data set's episodes one after another, each file of it once.

    Args:
        folder: Of the data set.
        description: Of the environment that it is for.
        episodes: Which, in this order; all if None.
        columns: Which columns hold what; None takes what the data set was annotated by, or else
            features as ours.
        fps: Observations a second that it must have; None takes any.

    Yields:
        Each episode, or why it cannot be used.

    Raises:
        ConfigurationError: If ``columns`` do not fit; the text names the key.
        DatasetError: If the data set as a whole cannot be used.
    """
    header, _, mapping = open_dataset(folder, fps, columns)
    entries = _choose(header, read_entries(header), episodes)
    return _demonstrations(header, entries, description, mapping)


def count_episodes(folder: Path | str) -> int:
    """Return how many episodes a data set has, without reading them.

    Raises:
        DatasetError: If it is broken, or no LeRobot v3 data set.
    """
    return int(read_info(Path(folder), None)["total_episodes"])


def read_environment(folder: Path | str) -> ConfigDump | None:
    """Return the settings of the environment that a data set comes from, None if it keeps none.

    Raises:
        DatasetError: If it is broken, or no LeRobot v3 data set.
    """
    read_info(Path(folder), None)
    found: ConfigDump | None = read_prime_file(Path(folder)).get("environment")
    return found


def open_dataset(
    folder: Path, fps: int | None, columns: ColumnsConfig | None
) -> tuple[Header, dict[str, Any], ColumnsConfig | None]:
    """Return a data set's header, what our own file in it says, and which columns hold what.

    Args:
        folder: Of the data set.
        fps: Observations a second that it must have; None takes any.
        columns: Which columns hold what; None takes what the data set was annotated by.

    Raises:
        ConfigurationError: If ``columns`` name what is not there; the text names the key.
        DatasetError: If it is broken, or no LeRobot v3 data set.
    """
    own = read_prime_file(folder)
    if columns is None and own.get("columns") is not None:
        try:
            columns = ColumnsConfig.model_validate(own["columns"])
        except ValidationError as error:
            raise DatasetError(
                f"{folder / layout.PRIME_FILE}: columns is no mapping of columns ({error}): "
                "annotate the data set again"
            ) from None
    if columns is None:
        return read_header(folder, fps), own, None
    return read_mapped_header(folder, fps, columns), own, columns


def read_prime_file(folder: Path) -> dict[str, Any]:
    """Return what our own file in a data set says; nothing where there is none.

    Raises:
        DatasetError: If it is broken, or of another release.
    """
    path = folder / layout.PRIME_FILE
    if not path.is_file():
        return {}
    content = read_json(path)
    version = content.get("version") if isinstance(content, dict) else None
    if not isinstance(content, dict) or version != 1:
        raise DatasetError(
            f"{path}: version is {version!r}; this release reads version 1: write the data set "
            "anew, or remove the file to read it as one from elsewhere"
        )
    return content


def _choose(
    header: Header, entries: Sequence[EpisodeEntry], episodes: Sequence[int] | None
) -> list[EpisodeEntry]:
    if episodes is None:
        return list(entries)
    for index in episodes:
        if not 0 <= index < len(entries):
            raise DatasetError(
                f"{header.folder} has no episode {index}; it has 0 to {len(entries) - 1}"
            )
    return [entries[index] for index in episodes]


def _demonstrations(
    header: Header,
    entries: Sequence[EpisodeEntry],
    description: SceneDescription | None,
    mapping: ColumnsConfig | None,
) -> Iterator[Demonstration | DemonstrationError]:
    if mapping is None:
        table: OwnColumns | MappedColumns = OwnColumns(header, description)
    elif description is None:
        raise DatasetError(
            f"{header.folder}: its columns are not ours, but those of a mapping: it is read for an "
            "environment, by whose names the mapping calls objects"
        )
    else:
        table = MappedColumns(header, description, mapping)
    return _shown(header, entries, table, UnitCheck(description))


def _shown(
    header: Header,
    entries: Sequence[EpisodeEntry],
    table: OwnColumns | MappedColumns,
    units: UnitCheck,
) -> Iterator[Demonstration | DemonstrationError]:
    for entry, columns in read_episodes(header, entries):
        if isinstance(columns, DemonstrationError):
            yield columns
            continue
        with np.errstate(over="ignore"):  # what float32 cannot hold is infinite: no unit of ours
            arrays = table.arrays(columns)
        seen = Observations(arrays.state, arrays.environment_state, _images(header, entry, columns))
        found = Demonstration(seen, arrays.actions, entry.task, arrays.simulator_states)
        problem = units.problem(found)
        text = f"{entry.file}: episode {entry.index}: {problem}"
        yield found if problem is None else DemonstrationError(text)


def _images(header: Header, entry: EpisodeEntry, columns: Columns) -> dict[str, ChosenImages]:
    """Return an episode's images by camera, unread."""
    images: dict[str, ChosenImages] = {}
    clock = columns.get("timestamp", np.arange(entry.length) / header.info["fps"])
    for name, camera in header.cameras.items():
        if camera.is_video:
            source: Images = VideoImages(header, entry, camera, clock)
        else:
            source = EmbeddedImages(header, entry, camera)
        images[name] = ChosenImages.joined([source])
    return images


def _read_space(header: Header, own: dict[str, Any]) -> PrimitiveSpace | None:
    if "primitives" not in own:
        return None
    try:
        return parsed.load_space(own["primitives"])
    except (KeyError, TypeError, ValueError) as error:
        raise DatasetError(
            f"{header.folder / layout.PRIME_FILE}: primitives is not a list of names with their "
            f"parameters ({error!r}): parse the demonstrations again"
        ) from error


def _read_segments(
    header: Header, entries: Sequence[EpisodeEntry], space: PrimitiveSpace
) -> tuple[tuple[Segment, ...], ...]:
    path = header.folder / layout.PRIMITIVES_FILE
    found = parsed.read_segments(path)
    result = tuple(found.get(entry.index, ()) for entry in entries)
    for entry, segments in zip(entries, result, strict=True):
        try:
            parsed.check_segments(segments, entry.length, space)
        except ValueError as error:
            raise DatasetError(
                f"{path}: episode {entry.index}: {error}: parse the demonstrations again"
            ) from error
    return result
