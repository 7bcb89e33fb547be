"""The stage that trains the inverse dynamics model."""

from collections.abc import Iterator, Sequence
from typing import ClassVar

from prime_core.collection.rollouts import FrameConfig, RolloutTable
from prime_core.configuration import ConfigDump
from prime_core.contracts.idm import IdmConfig, InverseDynamicsModel
from prime_core.contracts.perception import Perception
from prime_core.contracts.training import ModelContext
from prime_core.execution.world import World
from prime_core.experiments.stages.collection import Collection
from prime_core.experiments.stages.images import CollectionImages
from prime_core.experiments.stages.model_training import ModelTraining
from prime_core.experiments.stages.perception import PerceptionTraining
from prime_core.experiments.stages.stage import Result
from prime_core.learning.idm_report import report_on
from prime_core.learning.perceived import PerceivedIdm, perceived_calls
from prime_core.learning.training_pairs import PairConfig, training_pairs
from prime_core.registry.fields import read_settings
from prime_core.seeds import Stream, generator_of


class IdmTraining(ModelTraining):
    """An IDM, trained on the collected rollouts."""

    title: ClassVar[str] = "idm"

    collection: Collection
    rollout_images: CollectionImages | None = None
    """Where the IDM or the perception before it sees images."""
    perception: PerceptionTraining | None = None
    """What tells the IDM object poses; None for the simulator."""
    pairs: ConfigDump
    idm: ConfigDump

    @property
    def config(self) -> IdmConfig:
        """Which model."""
        return read_settings(IdmConfig, self.idm)

    def process(self, items: Sequence[str]) -> Iterator[Result]:
        """Train the model and test it on held-out rollouts."""
        for item in items:
            world = self.collection.build_world()
            space = world.space
            pairs = PairConfig.model_validate(self.pairs)
            generator = generator_of(Stream.IDM, self.seed)
            cut, perception = self.collection.first_held_out, self._perception()
            table = self._table(FrameConfig(around=pairs.around), end=cut)
            data = training_pairs(table, space, pairs, generator)
            if perception is not None:
                data = perceived_calls(perception, data)
            context = self.training_context(self._context(world), item)
            model = self._seen_through(perception, self.config.fit(data, context))
            exact = pairs.model_copy(update={"jittered_copies": 0, "late_ends": False})
            few = cut == self.collection.config.episodes
            left_out = table if few else self._table(FrameConfig(), start=cut)
            held_out = training_pairs(left_out, space, exact, generator)
            yield report_on(model, held_out)

    def _context(self, world: World) -> ModelContext:
        images = self.rollout_images if "images" in self.config.modalities else None
        return world.context(self.device, None if images is None else images.config)

    def _perception(self) -> Perception | None:
        return None if self.perception is None else self.perception.load()

    def _seen_through(
        self, perception: Perception | None, model: InverseDynamicsModel
    ) -> InverseDynamicsModel:
        return model if perception is None else PerceivedIdm(perception, model)

    def _table(self, frames: FrameConfig, start: int = 0, end: int | None = None) -> RolloutTable:
        """Return the rollouts of some episodes; with images those frames that have some."""
        if self.rollout_images is not None:
            return self.rollout_images.table(start, end)
        return RolloutTable(self.collection.episodes(start, end), frames)

    def load(self) -> InverseDynamicsModel:
        """Return the trained model."""
        self.results()
        world = self.collection.build_world()
        model = self.config.load(self.folder / "model", self._context(world))
        return self._seen_through(self._perception(), model)
