"""Writes demonstrations as a LeRobot v3 data set, whole or not at all."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np

from prime_core.configuration import ConfigDump
from prime_core.contracts.calls import PrimitiveSpace
from prime_core.contracts.demonstration import Demonstration
from prime_core.contracts.description import SceneDescription
from prime_core.contracts.environment import ACTION_NAMES, CONTROL_FREQUENCY
from prime_core.contracts.observations import ENVIRONMENT_STATE_KEY, STATE_KEY
from prime_core.datasets import segments as parsed
from prime_core.datasets.files import layout
from prime_core.datasets.files.metadata_writer import write_json, write_table
from prime_core.datasets.images.videos import check_sizes
from prime_core.datasets.parquet_writer import Columns, Episode, episode_of, write_files
from prime_core.errors import DatasetError
from prime_core.files import new_folder


def write_dataset(
    folder: Path | str,
    demonstrations: Iterable[Demonstration],
    description: SceneDescription,
    *,
    environment: ConfigDump | None = None,
    segments: parsed.SegmentLists | None = None,
    space: PrimitiveSpace | None = None,
    motion_rows: bool = True,
    videos: bool = False,
    replace: bool = False,
) -> None:
    """Write demonstrations as a LeRobot v3 data set, with their images if they have some.

    Demonstrations are taken, and their images read, one after another.

    Args:
        folder: Of the data set; its parent is made if need be.
        demonstrations: At least one.
        description: Of the environment that they come from.
        environment: Its settings, kept in ``meta/prime.json``.
        segments: Those of each demonstration, if they are parsed.
        space: The primitives of the segments; goes with ``segments``.
        motion_rows: Whether segments are also written as LeRobot's ``language_persistent`` rows
            of style ``motion``. They put lists into the items of a ``LeRobotDataset``, which
            only LeRobot's own collate function can batch.
        videos: Whether images are kept as videos, which lose a little of them, as LeRobot has them
            by default; else as PNG files. Heights and widths must be even.
        replace: Whether a data set that is there already gives way, once the new one is complete.

    Raises:
        DatasetError: If there is something already, or a demonstration does not fit.
        OSError: If it cannot be written; nothing is left half-written.
        ValueError: If the segments do not fit the demonstrations.
    """
    folder = Path(folder)
    _check_target(folder, replace)
    if (segments is None) != (space is None):
        raise ValueError("segments and space go together")
    first, others = _first_of(demonstrations)
    form = _Form.of(first, description)
    if videos:
        check_sizes(form.images)
    contents = layout.Contents(
        simulator_state_width=form.widths.get(layout.SIMULATOR_STATE_KEY, 0),
        images=form.images,
        videos=videos,
        segments=segments is not None,
        motion_rows=segments is not None and motion_rows,
    )
    features = layout.features_of(description, contents)
    episodes: Iterable[Episode] = map(form.episode, enumerate(chain([first], others)))
    if segments is not None and space is not None:
        episodes = _labelled(episodes, segments, space, motion_rows)
    with new_folder(folder) as partial:
        robot = "unknown" if description.robot is None else description.robot.name
        write_files(partial, episodes, features, fps=CONTROL_FREQUENCY, robot_type=robot)
        _write_prime_files(partial, environment, segments, space)


def _check_target(folder: Path, replace: bool) -> None:
    if not folder.exists():
        return
    if not replace:
        raise DatasetError(
            f"{folder} is there already: write to another folder, or ask for it to be replaced"
        )
    # A slip in a path must not cost somebody a folder of other things.
    if not (folder / layout.INFO_FILE).is_file():
        raise DatasetError(
            f"{folder} is no data set (it has no {layout.INFO_FILE}), so it is not replaced"
        )


def _first_of(
    demonstrations: Iterable[Demonstration],
) -> tuple[Demonstration, Iterator[Demonstration]]:
    """Return the first demonstration and what gives the others."""
    others = iter(demonstrations)
    for first in others:
        return first, others
    raise DatasetError("no demonstrations to write: a data set has at least one episode")


@dataclass(frozen=True)
class _Form:
    """What each demonstration of a data set holds.

    Attributes:
        widths: How many numbers a frame has, by feature.
        images: Height, width and 3 of each camera's images.
    """

    widths: Mapping[str, int]
    images: Mapping[str, tuple[int, ...]]

    @classmethod
    def of(cls, first: Demonstration, description: SceneDescription) -> "_Form":
        """Return that of a data set which begins with a demonstration."""
        widths = {
            STATE_KEY: description.state_width,
            ENVIRONMENT_STATE_KEY: description.environment_state_width,
            layout.ACTION_KEY: len(ACTION_NAMES),
        }
        if first.simulator_states is not None:
            widths[layout.SIMULATOR_STATE_KEY] = first.simulator_states.shape[1]
        images = first.observations.images
        return cls(widths, {name: each.shape[1:] for name, each in images.items()})

    def episode(self, numbered: tuple[int, Demonstration]) -> Episode:
        """Return a demonstration as an episode.

        Args:
            numbered: It, and its number.

        Raises:
            DatasetError: If it is not of this form.
        """
        number, demonstration = numbered
        episode = episode_of(demonstration)
        _check_columns(number, episode.columns, self.widths)
        self._check_images(number, demonstration)
        return episode

    def _check_images(self, number: int, demonstration: Demonstration) -> None:
        seen = demonstration.observations
        found = {name: images.shape for name, images in seen.images.items()}
        wanted = {name: (len(seen), *shape) for name, shape in self.images.items()}
        if found != wanted or any(shape[3:] != (3,) for shape in found.values()):
            raise DatasetError(
                f"demonstration {number} has images {found or 'of no camera'}; it should have "
                f"{wanted or 'none'}: one of each frame, (height, width, 3), of the same cameras "
                "as demonstration 0"
            )


def _check_columns(number: int, columns: Columns, wanted: Mapping[str, int]) -> None:
    if ENVIRONMENT_STATE_KEY in wanted and ENVIRONMENT_STATE_KEY not in columns:
        raise DatasetError(
            f"demonstration {number} does not tell where objects are, and data sets of this "
            "environment do: only demonstrations with known object poses can be written"
        )
    if set(columns) != set(wanted):
        raise DatasetError(
            f"demonstration {number} holds {sorted(columns)} and demonstration 0 {sorted(wanted)}: "
            "either all have simulator states or none"
        )
    frames = len(columns[layout.ACTION_KEY])
    for key, width in wanted.items():
        values = columns[key]
        if frames == 0 or values.shape != (frames, width):
            raise DatasetError(
                f"demonstration {number}: {key} has shape {values.shape}; it should be "
                f"({max(frames, 1)}, {width}): one row per frame, at least one frame"
            )
        if not np.isfinite(values).all():
            raise DatasetError(f"demonstration {number}: {key} holds NaN or infinity")


def _labelled(
    episodes: Iterable[Episode],
    segments: parsed.SegmentLists,
    space: PrimitiveSpace,
    motion_rows: bool,
) -> Iterator[Episode]:
    """Yield episodes with what their segments say, of which there are as many lists."""
    for episode, items in zip(episodes, segments, strict=True):
        frames = len(episode)
        parsed.check_segments(items, frames, space)
        episode.columns[layout.PRIMITIVE_INDEX_KEY] = parsed.frame_labels(items, frames, space)
        if motion_rows:
            rows = parsed.motion_rows(items, space, np.arange(frames) / CONTROL_FREQUENCY)
            episode.language = parsed.at_every_frame(rows, frames)
        yield episode


def _write_prime_files(
    folder: Path,
    environment: ConfigDump | None,
    segments: parsed.SegmentLists | None,
    space: PrimitiveSpace | None,
) -> None:
    from pydantic_core import to_jsonable_python

    content: dict[str, Any] = {"version": 1, "environment": to_jsonable_python(environment)}
    if segments is not None and space is not None:
        content["primitives"] = parsed.dump_space(space)
        write_table(folder / layout.PRIMITIVES_FILE, parsed.segment_table(segments))
    write_json(folder / layout.PRIME_FILE, content)
