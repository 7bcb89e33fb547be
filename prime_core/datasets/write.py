"""Writes demonstrations as a LeRobot v3 data set, whole or not at all."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from prime_core.configuration import ConfigDump
from prime_core.contracts.calls import PrimitiveSpace
from prime_core.contracts.demonstration import Demonstration
from prime_core.contracts.description import SceneDescription
from prime_core.contracts.environment import ACTION_NAMES, CONTROL_FREQUENCY
from prime_core.contracts.observations import ENVIRONMENT_STATE_KEY, STATE_KEY
from prime_core.datasets import layout
from prime_core.datasets import segments as parsed
from prime_core.datasets.parquet_writer import (
    Columns,
    Episode,
    episode_of,
    write_files,
    write_json,
    write_table,
)
from prime_core.errors import DatasetError
from prime_core.files import new_folder


def write_dataset(
    folder: Path | str,
    demonstrations: Sequence[Demonstration],
    description: SceneDescription,
    *,
    environment: ConfigDump | None = None,
    segments: parsed.SegmentLists | None = None,
    space: PrimitiveSpace | None = None,
    motion_rows: bool = True,
    replace: bool = False,
) -> None:
    """Write demonstrations as a LeRobot v3 data set, with their images if they have some.

    Images are read and written one demonstration after another.

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
    episodes = _episodes(demonstrations, description)
    if segments is not None and space is not None:
        _label(episodes, segments, space, motion_rows)
    contents = layout.Contents(
        simulator_state_width=_simulator_state_width(episodes),
        images=_images(demonstrations),
        segments=segments is not None,
        motion_rows=segments is not None and motion_rows,
    )
    features = layout.features_of(description, contents)
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


def _episodes(
    demonstrations: Sequence[Demonstration], description: SceneDescription
) -> list[Episode]:
    if not demonstrations:
        raise DatasetError("no demonstrations to write: a data set has at least one episode")
    wanted = {
        STATE_KEY: description.state_width,
        ENVIRONMENT_STATE_KEY: description.environment_state_width,
        layout.ACTION_KEY: len(ACTION_NAMES),
    }
    episodes = [episode_of(item) for item in demonstrations]
    width = _simulator_state_width(episodes)
    if width:
        wanted[layout.SIMULATOR_STATE_KEY] = width
    for number, episode in enumerate(episodes):
        _check_columns(number, episode.columns, wanted)
    return episodes


def _images(demonstrations: Sequence[Demonstration]) -> dict[str, tuple[int, ...]]:
    """Return height, width and 3 of each camera's images, once all demonstrations have the same."""
    shapes = [
        {name: images.shape for name, images in each.observations.images.items()}
        for each in demonstrations
    ]
    first = {name: shape[1:] for name, shape in shapes[0].items()}
    for number, (found, each) in enumerate(zip(shapes, demonstrations, strict=True)):
        wanted = {name: (len(each.observations), *shape) for name, shape in first.items()}
        if found != wanted or any(shape[3:] != (3,) for shape in found.values()):
            raise DatasetError(
                f"demonstration {number} has images {found or 'of no camera'}; it should have "
                f"{wanted or 'none'}: one of each frame, (height, width, 3), of the same cameras "
                "as demonstration 0"
            )
    return first


def _simulator_state_width(episodes: Sequence[Episode]) -> int:
    states = episodes[0].columns.get(layout.SIMULATOR_STATE_KEY)
    return 0 if states is None else int(states.shape[1])


def _check_columns(number: int, columns: Columns, wanted: dict[str, int]) -> None:
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


def _label(
    episodes: Sequence[Episode],
    segments: parsed.SegmentLists,
    space: PrimitiveSpace,
    motion_rows: bool,
) -> None:
    if len(segments) != len(episodes):
        raise ValueError(f"{len(segments)} lists of segments for {len(episodes)} demonstrations")
    for episode, items in zip(episodes, segments, strict=True):
        frames = len(episode)
        parsed.check_segments(items, frames, space)
        episode.columns[layout.PRIMITIVE_INDEX_KEY] = parsed.frame_labels(items, frames, space)
        if motion_rows:
            rows = parsed.motion_rows(items, space, np.arange(frames) / CONTROL_FREQUENCY)
            episode.language = parsed.at_every_frame(rows, frames)


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
