"""Demonstrations as LeRobot v3 data sets: what a user keeps, shares or brings.

A frame is an instant, as in `Demonstration`: an episode of ``N`` frames has ``N`` states and
``N`` actions, the last of which is a hold. The last action of a set from elsewhere is not used.
"""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from prime_core.configuration import ConfigDump
from prime_core.contracts.calls import PrimitiveSpace
from prime_core.contracts.demonstration import Demonstration, Segment
from prime_core.contracts.description import SceneDescription
from prime_core.contracts.environment import ACTION_NAMES, CONTROL_FREQUENCY
from prime_core.contracts.images import ChosenImages, Images
from prime_core.contracts.observations import ENVIRONMENT_STATE_KEY, STATE_KEY, Observations
from prime_core.datasets import layout
from prime_core.datasets import segments as parsed
from prime_core.datasets.embedded_images import EmbeddedImages
from prime_core.datasets.episodes import Columns, EpisodeEntry, read_entries, read_episodes
from prime_core.datasets.header import Header, column_order, read_header, read_json
from prime_core.datasets.units import UnitCheck
from prime_core.datasets.video_images import VideoImages
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
    header = read_header(Path(folder), fps)
    own = _read_prime_file(header)
    entries = _choose(header, read_entries(header), episodes)
    demonstrations = []
    for found in _demonstrations(header, entries, description):
        if isinstance(found, DemonstrationError):
            raise found
        demonstrations.append(found)
    space = _read_space(header, own)
    names = {key: header.names(key) for key in (STATE_KEY, ENVIRONMENT_STATE_KEY)}
    if description is not None:  # by which they are ordered
        wanted = _wanted_names(description)
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
    folder: Path, description: SceneDescription, episodes: Sequence[int] | None = None
) -> Iterator[Demonstration | DemonstrationError]:
    """Read a data set's episodes one after another, each file of it once.

    Args:
        folder: Of the data set.
        description: Of the environment that it is for.
        episodes: Which, in this order; all if None.

    Yields:
        Each episode, or why it cannot be used.

    Raises:
        DatasetError: If the data set as a whole cannot be used.
    """
    header = read_header(folder, CONTROL_FREQUENCY)
    _read_prime_file(header)
    entries = _choose(header, read_entries(header), episodes)
    return _demonstrations(header, entries, description)


def count_episodes(folder: Path | str) -> int:
    """Return how many episodes a data set has, without reading them.

    Raises:
        DatasetError: If it is broken, or no LeRobot v3 data set.
    """
    return int(read_header(Path(folder), None).info["total_episodes"])


def read_environment(folder: Path | str) -> ConfigDump | None:
    """Return the settings of the environment that a data set comes from, None if it keeps none.

    Raises:
        DatasetError: If it is broken, or no LeRobot v3 data set.
    """
    found: ConfigDump | None = _read_prime_file(read_header(Path(folder), None)).get("environment")
    return found


def _read_prime_file(header: Header) -> dict[str, Any]:
    path = header.folder / layout.PRIME_FILE
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


def _wanted_names(description: SceneDescription) -> dict[str, list[str]]:
    return {
        STATE_KEY: description.state_names,
        ENVIRONMENT_STATE_KEY: description.environment_state_names,
    }


def _column_orders(
    header: Header, description: SceneDescription | None
) -> dict[str, list[int] | None]:
    """Return which column holds each number of each feature, once all of them fit."""
    wanted = {layout.ACTION_KEY: list(ACTION_NAMES)}
    if description is not None:
        _check_robot(header, description)
        wanted |= _wanted_names(description)
    for key, names in wanted.items():
        width = header.features[key].width if key in header.features else 0
        if width != len(names):
            raise DatasetError(
                f"{header.info_file}: feature {key!r} "
                + (f"has {width} numbers" if width else "is missing")
                + f"; this environment has {len(names)}: {', '.join(names)}"
            )
    return {key: column_order(header, key, names) for key, names in wanted.items()}


def _check_robot(header: Header, description: SceneDescription) -> None:
    """Check that a data set that names its robot names the environment's."""
    found = header.info.get("robot_type")
    wanted = None if description.robot is None else description.robot.name
    if not found or "unknown" in (found, wanted) or wanted is None:
        return
    # LeRobot's users write franka_panda or Panda.
    if wanted.lower() not in re.split(r"[^a-z0-9]+", str(found).lower()):
        raise DatasetError(
            f"{header.info_file}: robot_type is {found!r}; this environment's robot is {wanted!r}. "
            f"If it is the same one, write {wanted!r} or null there"
        )


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
    header: Header, entries: Sequence[EpisodeEntry], description: SceneDescription | None
) -> Iterator[Demonstration | DemonstrationError]:
    orders, units = _column_orders(header, description), UnitCheck(description)
    for entry, columns in read_episodes(header, entries):
        if isinstance(columns, DemonstrationError):
            yield columns
            continue
        for key, order in orders.items():
            if order is not None:
                columns[key] = columns[key][:, order]
        with np.errstate(over="ignore"):  # what float32 cannot hold is infinite: no unit of ours
            found = _demonstration(header, entry, columns, description)
        problem = units.problem(found)
        text = f"{entry.file}: episode {entry.index}: {problem}"
        yield found if problem is None else DemonstrationError(text)


def _demonstration(
    header: Header, entry: EpisodeEntry, columns: Columns, description: SceneDescription | None
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
            _images(header, entry, columns),
        ),
        actions=columns[layout.ACTION_KEY].astype(np.float32, copy=False),
        task=entry.task,
        simulator_states=None if states is None else states.astype(np.float64, copy=False),
    )


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
