"""The stage that writes demonstrations as data sets of one episode, images included."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Annotated, ClassVar, Literal

from pydantic import Field, model_validator

from prime_core.configuration import Config, ConfigDump
from prime_core.contracts.demonstration import Demonstration, DemonstratorConfig
from prime_core.contracts.environment import Environment, EnvironmentConfig
from prime_core.contracts.images import Pixels
from prime_core.datasets.read import read_dataset, write_dataset
from prime_core.datasets.units import UnitCheck
from prime_core.errors import DemonstrationError
from prime_core.execution.live_images import live_images
from prime_core.experiments.stages.demonstrations import LEFT_OUT, check_left_out
from prime_core.experiments.stages.stage import Result, Stage
from prime_core.registry.fields import read_settings


class PictureConfig(Config):
    """Which images a data set has, and how they are kept."""

    cameras: Annotated[tuple[str, ...], Field(max_length=16)] = ()
    """Their names in the environment; without any there are no images."""
    height: Pixels = 84
    """[pixels]"""
    width: Pixels = 84
    """[pixels]"""
    kept_as: Literal["png", "video"] = "png"
    """``png`` files lie in the data files and lose nothing; ``video`` is smaller and loses a
    little. Both are LeRobot's."""

    @model_validator(mode="after")
    def _cameras_differ(self) -> "PictureConfig":
        if len(set(self.cameras)) != len(self.cameras):
            raise ValueError(f"found cameras {list(self.cameras)}: each may be named once only")
        return self

    @property
    def is_video(self) -> bool:
        """Whether images are kept as videos."""
        return self.kept_as == "video"


class Conversion(Stage):
    """Demonstrations as data sets of one episode each; of one that cannot be used, why.

    The episodes are put together at the end: who is stopped loses the one in hand alone.
    """

    title: ClassVar[str] = "conversion"
    unit: ClassVar[str] = "demonstrations"
    _exclude_from_cls_uid: ClassVar[tuple[str, ...]] = ("strict",)

    environment: ConfigDump
    demonstrator: ConfigDump
    pictures: ConfigDump
    strict: bool = False
    """Whether to stop at a demonstration that cannot be used."""

    @property
    def config(self) -> DemonstratorConfig:
        """The source."""
        return read_settings(DemonstratorConfig, self.demonstrator)

    @property
    def looks(self) -> PictureConfig:
        """Which images there are."""
        return PictureConfig.model_validate(self.pictures)

    def build_environment(self) -> Environment:
        """Build the environment that the demonstrations are of."""
        return read_settings(EnvironmentConfig, self.environment).build()

    def items(self) -> list[str]:
        """Return the demonstrations' numbers."""
        return [str(index) for index in range(self.config.count_available())]

    def outputs(self, item: str) -> list[Path]:
        """Return an episode's folder; a demonstration that was left out has none."""
        return [path for path in (self.folder / item,) if path.exists()]

    def process(self, items: Sequence[str]) -> Iterator[Result]:
        """Write demonstrations."""
        settings = read_settings(EnvironmentConfig, self.environment)
        built = self.build_environment()
        units = UnitCheck(built.description)
        shown = self.config.demonstrations(settings, [int(item) for item in items], seed=0)
        for item, found in zip(items, shown, strict=True):
            reason = _reason(item, found, units)
            if reason is None and isinstance(found, Demonstration):
                self._write(item, found, built)
                yield {"frames": len(found.observations)}
                continue
            if self.strict:
                check_left_out({item: str(reason)}, len(self.items()), strict=True)
            yield {LEFT_OUT: str(reason)}

    def _write(self, item: str, shown: Demonstration, built: Environment) -> None:
        looks, seen = self.looks, replace(shown.observations, images={})
        images = live_images(seen, built, looks.cameras, looks.height, looks.width)
        write_dataset(
            self.folder / item,
            [replace(shown, observations=replace(seen, images=images))],
            built.description,
            videos=looks.is_video,
            replace=True,
        )

    def left_out(self) -> dict[str, str]:
        """Return why demonstrations cannot be used, by their items."""
        pairs = zip(self.items(), self.results(), strict=True)
        return {item: result[LEFT_OUT] for item, result in pairs if LEFT_OUT in result}

    def frames(self) -> dict[str, int]:
        """Return how many frames there are of each demonstration that is used, by its item."""
        pairs = zip(self.items(), self.results(), strict=True)
        return {item: result["frames"] for item, result in pairs if LEFT_OUT not in result}

    def join(self, target: Path) -> None:
        """Write the episodes as one data set.

        Raises:
            DatasetError: If there is something already.
            OSError: If it cannot be written; nothing is left half-written.
        """
        built = self.build_environment()
        parts = (read_dataset(self.folder / item, built.description) for item in self.frames())
        try:
            write_dataset(
                target,
                (shown for part in parts for shown in part.demonstrations),
                built.description,
                environment=self.environment,
                videos=self.looks.is_video,
            )
        finally:
            built.close()


def _reason(item: str, found: Demonstration | DemonstrationError, units: UnitCheck) -> str | None:
    """Return why a demonstration cannot be used, None if it can."""
    if isinstance(found, DemonstrationError):
        return str(found)
    problem = units.problem(found)
    return None if problem is None else f"demonstration {item}: {problem}"
