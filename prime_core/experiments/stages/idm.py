"""The stage that trains the inverse dynamics model."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import ClassVar

from prime_core.collection.rollouts import FrameConfig, RolloutTable
from prime_core.configuration import ConfigDump
from prime_core.contracts.idm import IdmConfig, InverseDynamicsModel
from prime_core.contracts.training import ModelContext, TrainingContext
from prime_core.execution.world import World
from prime_core.experiments.stages.collection import Collection
from prime_core.experiments.stages.images import CollectionImages
from prime_core.experiments.stages.stage import DEVICE_IS_NO_IDENTITY, Result, Stage
from prime_core.learning.idm_report import report_on
from prime_core.learning.training_pairs import PairConfig, training_pairs
from prime_core.registry.fields import read_settings
from prime_core.seeds import Stream, generator_of

HELD_OUT_SHARE = 0.1
"""Share of episodes, the last ones, that the IDM is tested on and does not see in training."""


class IdmTraining(Stage):
    """An IDM, trained on the collected rollouts."""

    title: ClassVar[str] = "idm"
    unit: ClassVar[str] = "models"

    collection: Collection
    rollout_images: CollectionImages | None = None
    pairs: ConfigDump
    idm: ConfigDump
    seed: int
    device: str = "auto"
    _exclude_from_cls_uid: ClassVar[tuple[str, ...]] = DEVICE_IS_NO_IDENTITY

    @property
    def config(self) -> IdmConfig:
        """Which model."""
        return read_settings(IdmConfig, self.idm)

    def items(self) -> list[str]:
        """Return the one item."""
        return ["model"]

    def outputs(self, item: str) -> list[Path]:
        """Return where the model is kept."""
        return [self.folder / item]

    def process(self, items: Sequence[str]) -> Iterator[Result]:
        """Train the model and test it on held-out rollouts."""
        for item in items:
            world = self.collection.build_world()
            space = world.space
            pairs = PairConfig.model_validate(self.pairs)
            generator = generator_of(Stream.IDM, self.seed)
            count = self.collection.config.episodes
            cut = max(1, count - round(count * HELD_OUT_SHARE))
            table = self._table(FrameConfig(around=pairs.around), end=cut)
            data = training_pairs(table, space, pairs, generator)
            context = TrainingContext(
                **vars(self._context(world)),
                folder=self.folder / item,
                seed=self.seed,
                progress=self.progress_writer(item),
            )
            model = self.config.fit(data, context)
            exact = pairs.model_copy(update={"jittered_copies": 0, "late_ends": False})
            left_out = self._table(FrameConfig(), start=cut) if cut < count else table
            held_out = training_pairs(left_out, space, exact, generator)
            yield report_on(model, held_out)

    def _context(self, world: World) -> ModelContext:
        images = self.rollout_images
        return world.context(self.device, None if images is None else images.config)

    def _table(self, frames: FrameConfig, start: int = 0, end: int | None = None) -> RolloutTable:
        """Return the rollouts of some episodes; with images those frames that have some."""
        episodes, pictured = self.collection.episodes(start, end), self.rollout_images
        if pictured is None:
            return RolloutTable(episodes, frames)
        return RolloutTable(episodes, pictured.chosen, pictured.episodes(start, end))

    def load(self) -> InverseDynamicsModel:
        """Return the trained model."""
        self.results()
        world = self.collection.build_world()
        return self.config.load(self.folder / "model", self._context(world))
