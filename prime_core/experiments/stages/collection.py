"""The stage that collects rollouts of random primitives."""

from collections.abc import Iterator, Sequence
from dataclasses import fields
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from prime_core.collection.draws import Draws
from prime_core.collection.episode import Collector
from prime_core.collection.recording import CollectedEpisode
from prime_core.collection.settings import CollectionConfig
from prime_core.configuration import ConfigDump
from prime_core.execution.world import World
from prime_core.experiments.stages.learned_primitives import LearnedPrimitives
from prime_core.experiments.stages.stage import Result, Stage
from prime_core.registry.building import build_world
from prime_core.seeds import Stream, generator_of

HELD_OUT_SHARE = 0.1
"""Share of episodes, the last ones, that models are tested on and do not learn from."""


class Collection(Stage):
    """Rollouts of random primitives and motor actions, by shards of a few episodes."""

    title: ClassVar[str] = "collection"
    unit: ClassVar[str] = "shards"

    environments: tuple[ConfigDump, ...] = Field(min_length=1)
    primitives: tuple[ConfigDump, ...]
    learned: LearnedPrimitives | None = None
    """Trains those of the primitives that are to be trained."""
    settings: ConfigDump
    seed: int

    @property
    def config(self) -> CollectionConfig:
        """How to collect, but for where."""
        return CollectionConfig.model_validate(self.settings)

    @property
    def first_held_out(self) -> int:
        """Number of the first episode that models are tested on and do not learn from.

        That of the one after the last where there are too few for any.
        """
        count = self.config.episodes
        return max(1, count - round(count * HELD_OUT_SHARE))

    def build_world(self) -> World:
        """Build where the first episode is collected; the others' worlds have the same models."""
        return build_world(self.environments[0], self.built_from)

    @property
    def built_from(self) -> tuple[ConfigDump, ...]:
        """Settings that the primitives are built from, all of them trained."""
        return self.primitives if self.learned is None else self.learned.trained(self.primitives)

    def items(self) -> list[str]:
        """Return the shards' numbers."""
        return [str(index) for index in range(self.config.shards)]

    def process(self, items: Sequence[str]) -> Iterator[Result]:
        """Collect shards; an episode depends on the seed and its number only."""
        config, primitives = self.config, self.built_from
        worlds = [build_world(dump, primitives) for dump in self.environments]
        space = worlds[0].space
        for item in items:
            episodes = []
            draws = Draws.none(len(space.names))
            for number in config.shard_episodes(int(item)):
                collector = Collector(worlds[number % len(worlds)], config)
                generator = generator_of(Stream.COLLECTION, self.seed, number)
                episode, counted = collector.collect(generator)
                episodes.append(_kept(episode))
                draws.counts += counted.counts
            yield {
                "episodes": episodes,
                "draws": draws.counts,
                "width": space.width,
                "primitives": list(space.names),
            }

    def episodes(self, start: int = 0, end: int | None = None) -> Iterator[CollectedEpisode]:
        """Read episodes one after another, which bounds the memory.

        Args:
            start: Number of the first one.
            end: Number of the one after the last; None for all that follow.
        """
        config = self.config
        end = config.episodes if end is None else end
        for item in self.items():
            numbers = config.shard_episodes(int(item))
            if numbers.stop <= start or numbers.start >= end:
                continue
            (shard,) = self.results([item])
            for number, episode in zip(numbers, shard["episodes"], strict=True):
                if start <= number < end:
                    yield _restored(episode, shard["width"])


def _kept(episode: CollectedEpisode) -> dict[str, np.ndarray[Any, Any]]:
    """Return an episode's arrays but for empty ones, which exca cannot keep."""
    arrays = {part.name: getattr(episode, part.name) for part in fields(episode)}
    return {name: values for name, values in arrays.items() if values.size}


def _restored(arrays: dict[str, Any], width: int) -> CollectedEpisode:
    """Return an episode from the arrays that were kept of it."""
    empty: dict[str, NDArray[Any]] = {
        "environment_state": np.empty((len(arrays["state"]), 0), dtype=np.float32),
        "rollouts": np.empty((0, 3), dtype=np.int64),
        "parameters": np.empty((0, width)),
        "others": np.empty((0, 2), dtype=np.int64),
        "late_ends": np.empty(0, dtype=np.int64),
    }
    kept = {name: np.array(values) for name, values in arrays.items()}
    return CollectedEpisode(**{**empty, **kept})
