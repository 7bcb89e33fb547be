"""The stage that trains policies over primitives."""

from collections.abc import Iterator, Sequence
from typing import Literal

from prime_core.collection.rollouts import RolloutTable
from prime_core.configuration import ConfigDump
from prime_core.contracts.policy import PrimitivePolicyConfig
from prime_core.contracts.training import CallData
from prime_core.errors import PrimeError
from prime_core.execution.world import World
from prime_core.experiments.stages.parsing import Parsing
from prime_core.experiments.stages.policy import PolicyTraining
from prime_core.experiments.stages.stage import Result
from prime_core.learning.augmentation import AugmentationConfig, augmented_calls, rollout_calls
from prime_core.learning.perceived import perceived_calls
from prime_core.registry.building import build_world
from prime_core.registry.fields import read_settings
from prime_core.seeds import Stream, generator_of


class PrimitivePolicyTraining(PolicyTraining):
    """Policies over primitives, trained on rollouts and on parsed demonstrations."""

    kind: Literal["primitives"] = "primitives"
    parsing: Parsing
    augmentation: ConfigDump

    @property
    def config(self) -> PrimitivePolicyConfig:
        """Which policy."""
        return read_settings(PrimitivePolicyConfig, self.policy)

    def build_world(self) -> World:
        """Build where the policy acts."""
        collection = self.parsing.idm.collection
        return build_world(self.parsing.demonstrations.environment, collection.built_from)

    def process(self, items: Sequence[str]) -> Iterator[Result]:
        """Train policies."""
        config, world, perception = self.config, self.build_world(), self.load_perception()
        # An IDM of images looks at the demonstrations once more.
        parsed = [*self.parsing.load(self.images or self.parsing.images).values()]
        idm = self.parsing.idm.load()
        rollouts = self._rollouts() if config.pretrain else None
        if rollouts is not None and perception is not None:
            rollouts = perceived_calls(perception, rollouts)
        settings = AugmentationConfig.model_validate(self.augmentation)
        for item in items:
            generator = generator_of(Stream.POLICY, int(item))
            data = augmented_calls(parsed, idm, settings, generator)
            if not len(data.types):
                raise PrimeError(
                    "no segment of the demonstrations was explained by a primitive, so that "
                    "there is nothing for a policy to learn from: look at the parsed "
                    "demonstrations, collect more rollouts, or add the primitive that is missing"
                )
            if perception is not None:
                data = perceived_calls(perception, data)
            context = self.training_context(world, item)
            checkpoints = config.fit(rollouts, data, context)
            yield {"checkpoints": [str(path.relative_to(self.folder)) for path in checkpoints]}

    def _rollouts(self) -> CallData:
        if self.rollout_images is not None:
            return rollout_calls(self.rollout_images.table())
        return rollout_calls(RolloutTable(self.parsing.idm.collection.episodes()))
