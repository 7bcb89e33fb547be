"""Converts recordings into LeRobot data sets, outside of an experiment."""

import shutil
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.markup import escape

from prime_core.configuration import ConfigDump
from prime_core.contracts.demonstration import DemonstratorConfig
from prime_core.errors import DatasetError
from prime_core.experiments.compute import ComputeConfig
from prime_core.experiments.conversion.asked import check_is_data_set, environment_of
from prime_core.experiments.run_folder.code import digest_of
from prime_core.experiments.run_folder.contents import content_of
from prime_core.experiments.run_folder.lock import NAME as LOCK
from prime_core.experiments.run_folder.lock import alone_in
from prime_core.experiments.run_folder.place import place_told
from prime_core.experiments.run_folder.settings_of import settings_in
from prime_core.experiments.running import finish_stage
from prime_core.experiments.stages.demonstrations import check_left_out
from prime_core.experiments.stages.outputs.conversion import Conversion, PictureConfig
from prime_core.registry.fields import dump_choice
from prime_core.registry.sources import demonstrator_of

PARTS = ".parts"
"""Suffix of the folder beside a target that holds the episodes until all are there."""


@dataclass(frozen=True)
class Converted:
    """What a conversion gave.

    Attributes:
        demonstrations: How many there are in the data set.
        frames: How many frames they have.
        new_frames: How many of them were not there from an earlier call that was stopped.
        seconds: That reading, rendering and packing these took by the clock.
        left_out: Why the others cannot be used, by their numbers in the source.
    """

    demonstrations: int
    frames: int
    new_frames: int
    seconds: float
    left_out: Mapping[str, str]


def convert(
    source: Path,
    target: Path,
    pictures: PictureConfig,
    console: Console,
    *,
    environment: str | None = None,
    settings: Sequence[str] = (),
    workers: int,
    strict: bool = False,
) -> Converted:
    """Write a source's demonstrations as a LeRobot data set, with images made of their states.

    What is finished lies in a folder beside the target until all is; the same call goes on from
    there. Images that the source comes with are not copied.

    Args:
        source: An HDF5 file of robosuite or robomimic, or whatever an installed demonstrator reads.
        target: Folder of the data set, which must not exist.
        pictures: Which images.
        console: Where progress is shown.
        environment: The ``type`` of the environment, where the source does not tell it.
        settings: Changes to its settings, such as ``object=can``.
        workers: Processes that share the work; 0 does it all in this one.
        strict: Whether a demonstration that cannot be used is an error.

    Raises:
        PrimeError: If the source cannot be read, its environment is not known, none of its
            demonstrations can be used, no image can be made, or the target is there already.
    """
    check_is_data_set(target)
    parts = target.with_name(target.name + PARTS)
    _check_places(target, parts)
    demonstrator = demonstrator_of(source)
    chosen = environment_of(source, demonstrator, environment, settings)

    def say(text: str) -> None:
        console.print(f"[yellow]![/] {escape(text)}", highlight=False, soft_wrap=True)

    with place_told(target), alone_in(parts, say):
        _check_places(target, parts)  # another process may have been at it
        stage = _stage(demonstrator, chosen, pictures, parts, workers, strict)
        missing, start = set(stage.missing()), time.perf_counter()
        finish_stage("demonstrations", stage, console)
        seconds = time.perf_counter() - start
        left_out, frames = stage.left_out(), stage.frames()
        check_left_out(left_out, len(stage.items()), strict)
        with console.status(f"writing {escape(str(target))}"):
            stage.join(target)
    shutil.rmtree(parts)
    new = sum(count for item, count in frames.items() if item in missing)
    return Converted(len(frames), sum(frames.values()), new, seconds, left_out)


def _check_places(target: Path, parts: Path) -> None:
    if target.exists():
        raise DatasetError(f"{target}: is there already: choose another folder")
    # It is removed at the end: it must not be somebody's own.
    if parts.exists() and not (parts / LOCK).is_file():
        raise DatasetError(
            f"{parts}: is there already, and no conversion made it: episodes would be kept there "
            "until all are written. Move it, or choose another folder"
        )


def _stage(
    demonstrator: DemonstratorConfig,
    environment: ConfigDump,
    pictures: PictureConfig,
    folder: Path,
    workers: int,
    strict: bool,
) -> Conversion:
    """Return the stage of a conversion; what other code or another source made is another one."""
    fields: dict[str, Any] = {
        "environment": environment,
        "demonstrator": dump_choice(demonstrator),
        "pictures": pictures.model_dump(mode="json"),
        "strict": strict,
        "infra": ComputeConfig(workers=workers).infra(folder.resolve()),
    }
    fields["content"] = content_of(settings_in(fields))
    return Conversion(code=digest_of(Conversion(**fields).code_now()), **fields)
