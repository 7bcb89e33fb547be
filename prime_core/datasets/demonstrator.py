"""Demonstrations that come from a LeRobot data set."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Annotated

from pydantic import Field

from prime_core.configuration import GREATEST_COUNT, ConfigDump, LocalPath
from prime_core.contracts.demonstration import Demonstration, RecordedDemonstratorConfig
from prime_core.contracts.description import SceneDescription
from prime_core.contracts.environment import EnvironmentConfig
from prime_core.datasets.columns.settings import ColumnsConfig
from prime_core.datasets.read import count_episodes, read_demonstrations, read_environment
from prime_core.errors import DemonstrationError

Index = Annotated[int, Field(ge=0, lt=GREATEST_COUNT)]

_descriptions: dict[tuple[type[EnvironmentConfig], str], SceneDescription] = {}


class LeRobotDemonstratorConfig(RecordedDemonstratorConfig):
    """Takes demonstrations from a LeRobot v3 data set, as they are.

    Columns are matched by the names of ``meta/info.json``; where there are none, they are taken in
    our order. ``columns`` says which they are where they are others.
    """

    path: LocalPath
    """Folder of the data set."""
    episodes: tuple[Index, ...] | None = Field(None, min_length=1)
    """Indices of the episodes to take, in this order; all if null."""
    columns: ColumnsConfig | None = None
    """Which columns hold what, where features are not ours."""

    @classmethod
    def reads(cls, source: Path) -> bool:
        """Whether it looks like one: packs may read other folders."""
        return (source / "meta").is_dir()

    def recorded_environment(self) -> ConfigDump | None:
        """Return the environment that is kept in the data set, if it is one of prime's."""
        return read_environment(self.path)

    def count_available(self) -> int:
        """How many demonstrations it gives."""
        return count_episodes(self.path) if self.episodes is None else len(self.episodes)

    def demonstrations(
        self, environment: EnvironmentConfig, indices: Sequence[int], seed: int
    ) -> Iterator[Demonstration | DemonstrationError]:
        """Return some demonstrations; the seed plays no part."""
        self.check_indices(indices)
        chosen = indices if self.episodes is None else [self.episodes[index] for index in indices]
        description = _description_of(environment)
        found = read_demonstrations(self.path, description, chosen, columns=self.columns)
        for episode, item in zip(chosen, found, strict=True):
            if isinstance(item, Demonstration) and not item.steps:
                text = f"{self.path}: episode {episode} has one frame: no motor action was done"
                item = DemonstrationError(text)
            yield item


def _description_of(environment: EnvironmentConfig) -> SceneDescription:
    # Building an environment takes seconds.
    key = (type(environment), environment.model_dump_json())
    if key not in _descriptions:
        built = environment.build()
        _descriptions[key] = built.description
        built.close()
    return _descriptions[key]
