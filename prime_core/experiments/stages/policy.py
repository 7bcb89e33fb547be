"""The stage that trains policies, one for each seed."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import ClassVar

import numpy as np

from prime_core.collection.rollouts import RolloutTable
from prime_core.configuration import ConfigDump
from prime_core.contracts.policy import PolicyConfig
from prime_core.errors import PrimeError
from prime_core.execution.world import World
from prime_core.experiments.stages.parsing import Parsing
from prime_core.experiments.stages.stage import Result, Stage
from prime_core.learning.augmentation import (
    AugmentationConfig,
    augmented_policy_data,
    rollout_policy_data,
)
from prime_core.registry.building import build_world
from prime_core.registry.fields import validate_choice

_STREAM = 3


class PolicyTraining(Stage):
    """Policies trained on parsed demonstrations, one seed an item."""

    title: ClassVar[str] = "policy"
    unit: ClassVar[str] = "seeds"

    parsing: Parsing
    augmentation: ConfigDump
    policy: ConfigDump
    seeds: tuple[int, ...]

    @property
    def config(self) -> PolicyConfig:
        """Which policy."""
        config = validate_choice("policy", self.policy)
        assert isinstance(config, PolicyConfig)
        return config

    def build_world(self) -> World:
        """Build where the policy acts."""
        collection = self.parsing.idm.collection
        return build_world(self.parsing.demonstrations.environment, collection.primitives)

    def items(self) -> list[str]:
        """Return the seeds."""
        return [str(seed) for seed in self.seeds]

    def process(self, items: Sequence[str]) -> Iterator[Result]:
        """Train policies."""
        config, world, parsed = self.config, self.build_world(), self.parsing.load()
        idm = self.parsing.idm.load()
        rollouts = None
        if config.pretrain:
            rollouts = rollout_policy_data(RolloutTable(self.parsing.idm.collection.episodes()))
        settings = AugmentationConfig.model_validate(self.augmentation)
        for item in items:
            generator = np.random.default_rng([int(item), _STREAM])
            data = augmented_policy_data(parsed, idm, settings, generator)
            if not len(data.type_frames):
                raise PrimeError(
                    "no segment of the demonstrations was explained by a primitive, so that "
                    "there is nothing for a policy to learn from: look at the parsed "
                    "demonstrations, collect more rollouts, or add the primitive that is missing"
                )
            checkpoints = config.fit(
                rollouts,
                data,
                world.description,
                idm.space,
                self.folder / f"seed-{item}",
                int(item),
                self.progress_writer(item),
            )
            yield {"checkpoints": [str(path.relative_to(self.folder)) for path in checkpoints]}

    def checkpoints(self, seed: str) -> list[Path]:
        """Return the checkpoints of a seed, oldest first."""
        (result,) = self.compute([seed])
        return [self.folder / name for name in result["checkpoints"]]
