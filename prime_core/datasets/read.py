"""Demonstrations as LeRobot v3 data sets: what a user keeps, shares or brings.

A frame is an instant, as in `Demonstration`: an episode of ``N`` frames has ``N`` states and
``N`` actions, the last of which is a hold. The last action of a set from elsewhere is not used.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from prime_core.configuration import ConfigDump
from prime_core.contracts.calls import PrimitiveSpace
from prime_core.contracts.demonstration import Demonstration, Segment
from prime_core.contracts.description import SceneDescription
from prime_core.contracts.environment import CONTROL_FREQUENCY
from prime_core.contracts.observations import ENVIRONMENT_STATE_KEY, STATE_KEY, Observations
from prime_core.datasets import layout
from prime_core.datasets import parquet_reader as reader
from prime_core.datasets import segments as parsed
from prime_core.datasets.write import write_dataset
from prime_core.errors import DatasetError

__all__ = ["Dataset", "count_episodes", "read_dataset", "write_dataset"]


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
        DatasetError: If it is broken, or is something else.
    """
    header = reader.read_header(Path(folder), fps)
    own = _read_prime_file(header)
    if description is not None:
        _check_features(header, description, names_too=bool(own))
    entries = _choose(header, reader.read_entries(header), episodes)
    columns = reader.read_columns(header, entries)
    space = _read_space(header, own)
    return Dataset(
        folder=header.folder,
        demonstrations=tuple(
            _demonstration(entry, columns[entry.index], description) for entry in entries
        ),
        episodes=tuple(entry.index for entry in entries),
        fps=header.info["fps"],
        state_names=header.names(STATE_KEY),
        environment_state_names=header.names(ENVIRONMENT_STATE_KEY),
        environment=own.get("environment"),
        space=space,
        segments=None if space is None else _read_segments(header, entries, space),
    )


def count_episodes(folder: Path | str) -> int:
    """Return how many episodes a data set has, without reading them.

    Raises:
        DatasetError: If it is broken, or no LeRobot v3 data set.
    """
    return int(reader.read_header(Path(folder), None).info["total_episodes"])


def _read_prime_file(header: reader.Header) -> dict[str, Any]:
    path = header.folder / layout.PRIME_FILE
    if not path.is_file():
        return {}
    content = reader.read_json(path)
    version = content.get("version") if isinstance(content, dict) else None
    if not isinstance(content, dict) or version != 1:
        raise DatasetError(
            f"{path}: version is {version!r}; this release reads version 1: write the data set "
            "anew, or remove the file to read it as one from elsewhere"
        )
    return content


def _check_features(header: reader.Header, description: SceneDescription, names_too: bool) -> None:
    wanted = {
        STATE_KEY: description.state_names,
        ENVIRONMENT_STATE_KEY: description.environment_state_names,
    }
    for key, names in wanted.items():
        width = header.widths.get(key, 0)
        if width != len(names):
            raise DatasetError(
                f"{header.info_file}: feature {key!r} "
                + (f"has {width} numbers" if width else "is missing")
                + f"; this environment has {len(names)}: {', '.join(names)}"
            )
        found = header.names(key)
        # Names from elsewhere are a matter of taste; ours say which objects are meant.
        if names_too and found is not None and list(found) != names:
            first = next(index for index, name in enumerate(names) if found[index] != name)
            raise DatasetError(
                f"{header.info_file}: feature {key!r} has {found[first]!r} where this environment "
                f"has {names[first]!r}: the data set is of another environment"
            )


def _choose(
    header: reader.Header,
    entries: Sequence[reader.EpisodeEntry],
    episodes: Sequence[int] | None,
) -> list[reader.EpisodeEntry]:
    if episodes is None:
        return list(entries)
    for index in episodes:
        if not 0 <= index < len(entries):
            raise DatasetError(
                f"{header.folder} has no episode {index}; it has 0 to {len(entries) - 1}"
            )
    return [entries[index] for index in episodes]


def _demonstration(
    entry: reader.EpisodeEntry, columns: reader.Columns, description: SceneDescription | None
) -> Demonstration:
    objects = columns.get(ENVIRONMENT_STATE_KEY)
    if objects is None and description is not None and not description.objects:
        # There is no such column where there is no object: nothing is unknown.
        objects = np.zeros((entry.length, 0), dtype=np.float32)
    states = columns.get(layout.SIMULATOR_STATE_KEY)
    return Demonstration(
        observations=Observations(
            columns[STATE_KEY].astype(np.float32, copy=False),
            None if objects is None else objects.astype(np.float32, copy=False),
        ),
        actions=columns[layout.ACTION_KEY].astype(np.float32, copy=False),
        task=entry.task,
        simulator_states=None if states is None else states.astype(np.float64, copy=False),
    )


def _read_space(header: reader.Header, own: dict[str, Any]) -> PrimitiveSpace | None:
    if "primitives" not in own:
        return None
    try:
        return parsed.load_space(own["primitives"])
    except (KeyError, TypeError) as error:
        raise DatasetError(
            f"{header.folder / layout.PRIME_FILE}: primitives is not a list of names with their "
            f"parameters ({error!r}): parse the demonstrations again"
        ) from error


def _read_segments(
    header: reader.Header, entries: Sequence[reader.EpisodeEntry], space: PrimitiveSpace
) -> tuple[tuple[Segment, ...], ...]:
    path = header.folder / layout.PRIMITIVES_FILE
    found = parsed.segments_of(reader.read_table(path, parsed.SEGMENT_COLUMNS))
    result = tuple(found.get(entry.index, ()) for entry in entries)
    for entry, segments in zip(entries, result, strict=True):
        try:
            parsed.check_segments(segments, entry.length, space)
        except ValueError as error:
            raise DatasetError(
                f"{path}: episode {entry.index}: {error}: parse the demonstrations again"
            ) from error
    return result
