"""What a conversion is asked for: which images, and of which environment."""

import re
from collections.abc import Sequence
from pathlib import Path

from pydantic import ValidationError

from prime_core.configuration import ConfigDump
from prime_core.contracts.demonstration import DemonstratorConfig
from prime_core.contracts.environment import EnvironmentConfig
from prime_core.datasets.images.videos import check_sizes
from prime_core.errors import ConfigurationError
from prime_core.experiments.reading import explain, read_choice
from prime_core.experiments.stages.outputs.conversion import PictureConfig
from prime_core.registry.fields import dump_choice
from prime_core.registry.loading import load_plugins


def read_pictures(cameras: Sequence[str], size: str, kept_as: str) -> PictureConfig:
    """Return which images are asked for.

    Args:
        cameras: Their names.
        size: Height and width [pixels], as in ``84`` or ``240x320``.
        kept_as: See `PictureConfig`.

    Raises:
        PrimeError: If one of them is wrong.
    """
    sides = re.fullmatch(r"(\d+)(?:x(\d+))?", size, re.ASCII)
    if sides is None:
        raise ConfigurationError(
            f"--size {size}: it must be a number of pixels, or HEIGHTxWIDTH such as 240x320"
        )
    height, width = sides.group(1), sides.group(2) or sides.group(1)
    try:
        pictures = PictureConfig(
            cameras=tuple(cameras), height=int(height), width=int(width), kept_as=kept_as
        )
    except ValidationError as error:
        raise ConfigurationError(explain(error, "images")) from None
    if pictures.is_video:
        check_sizes(dict.fromkeys(cameras, (pictures.height, pictures.width, 3)))
    return pictures


def environment_of(
    source: Path, demonstrator: DemonstratorConfig, name: str | None, settings: Sequence[str]
) -> ConfigDump:
    """Return the settings of the environment to build, all defaults written out.

    Raises:
        PrimeError: If they are not known, or wrong.
    """
    data: ConfigDump | None = {"type": name} if name else demonstrator.recorded_environment()
    if data is None:
        raise ConfigurationError(
            f"{source}: does not say which environment it was recorded in: name it, such as "
            "--environment robosuite/lift"
        )
    told = " ".join([f"--environment {name}" if name else f"environment of {source}", *settings])
    return dump_choice(read_choice(EnvironmentConfig, data, settings, told))


def check_is_data_set(target: Path) -> None:
    """Make sure that a target is named as a folder, not as a file of another format.

    Raises:
        ConfigurationError: If it ends like the files of a registered exporter.
    """
    for entry in load_plugins().registry.registrations("exporter"):
        suffix = getattr(entry.config_class, "suffix", "")
        if suffix and target.suffix == suffix:
            raise ConfigurationError(
                f"{target}: found the suffix {suffix!r}; it must be a folder, for a LeRobot data "
                f"set. 'prime export RUN --to {entry.name}' writes such files of a run's "
                "demonstrations"
            )
