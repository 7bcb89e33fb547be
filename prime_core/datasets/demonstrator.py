"""Demonstrations that come from a LeRobot data set."""

from pathlib import Path
from typing import Annotated

from pydantic import Field

from prime_core.configuration import GREATEST_COUNT, LocalPath
from prime_core.contracts.demonstration import Demonstration, DemonstratorConfig
from prime_core.contracts.description import SceneDescription
from prime_core.contracts.environment import EnvironmentConfig
from prime_core.datasets.read import count_episodes, read_dataset
from prime_core.errors import DatasetError

Index = Annotated[int, Field(ge=0, lt=GREATEST_COUNT)]

_descriptions: dict[tuple[type[EnvironmentConfig], str], SceneDescription] = {}


class LeRobotDemonstratorConfig(DemonstratorConfig):
    """Takes demonstrations from a LeRobot v3 data set, as they are."""

    path: LocalPath
    """Folder of the data set."""
    episodes: tuple[Index, ...] | None = Field(None, min_length=1)
    """Indices of the episodes to take, in this order; all if null."""

    @classmethod
    def reads(cls, source: Path) -> bool:
        """Whether it looks like one: packs may read other folders."""
        return (source / "meta").is_dir()

    def count_available(self) -> int:
        """How many demonstrations it gives."""
        return count_episodes(self.path) if self.episodes is None else len(self.episodes)

    def demonstrate(self, environment: EnvironmentConfig, index: int, seed: int) -> Demonstration:
        """Return one demonstration; the seed plays no part."""
        available = self.count_available()
        if not 0 <= index < available:
            raise DatasetError(f"{self.path} gives {available} demonstrations, not {index + 1}")
        episode = index if self.episodes is None else self.episodes[index]
        found = read_dataset(self.path, _description_of(environment), episodes=[episode])
        return found.demonstrations[0]


def _description_of(environment: EnvironmentConfig) -> SceneDescription:
    # Building an environment takes seconds, and this is asked for every demonstration.
    key = (type(environment), environment.model_dump_json())
    if key not in _descriptions:
        built = environment.build()
        _descriptions[key] = built.description
        built.close()
    return _descriptions[key]
