"""The stage that trains what tells object poses from images."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Annotated, ClassVar

from pydantic import Field, PrivateAttr

from prime_core.configuration import ConfigDump
from prime_core.contracts.observations import Observations
from prime_core.contracts.perception import Perception, PerceptionConfig
from prime_core.contracts.training import ModelContext, TrainingContext
from prime_core.experiments.stages.images import CollectionImages, DemonstrationImages
from prime_core.experiments.stages.randomised_images import RandomisedImages
from prime_core.experiments.stages.stage import DEVICE_IS_NO_IDENTITY, Result, Stage
from prime_core.learning.perception_report import report_on_perception
from prime_core.registry.building import build_world
from prime_core.registry.fields import read_settings


class PerceptionTraining(Stage):
    """A perception, trained once: all models, and all seeds of a policy, see through it."""

    title: ClassVar[str] = "perception"
    unit: ClassVar[str] = "models"

    images: Annotated[CollectionImages | DemonstrationImages, Field(discriminator="kind")]
    """What it is taught on, and tested on."""
    randomised: RandomisedImages | None = None
    """What it is taught on besides."""
    perception: ConfigDump
    seed: int
    device: str = "auto"
    _exclude_from_cls_uid: ClassVar[tuple[str, ...]] = DEVICE_IS_NO_IDENTITY
    _loaded: Perception | None = PrivateAttr(None)  # each checkpoint of a policy asks for it

    @property
    def config(self) -> PerceptionConfig:
        """Which perception."""
        return read_settings(PerceptionConfig, self.perception)

    def items(self) -> list[str]:
        """Return the one item."""
        return ["model"]

    def outputs(self, item: str) -> list[Path]:
        """Return where the perception is kept."""
        return [self.folder / item]

    def process(self, items: Sequence[str]) -> Iterator[Result]:
        """Train the perception, and test it on frames that it has not seen."""
        for item in items:
            taught_on, held_out = self._frames_to_learn(), self.images.held_out_frames()
            context = TrainingContext(
                **vars(self._context()),
                folder=self.folder / item,
                seed=self.seed,
                progress=self.progress_writer(item),
            )
            perception = self.config.fit(taught_on, context)
            result: Result = {"frames": len(taught_on)}
            if held_out is not None:
                tested = report_on_perception(perception, held_out, context.description)
                result["objects"] = tested
            yield result

    def _frames_to_learn(self) -> Observations:
        frames = self.images.frames_to_learn()
        if self.randomised is None:
            return frames
        return Observations.join([frames, self.randomised.frames_to_learn()])

    def _context(self) -> ModelContext:
        world = build_world(self.images.environment, ())  # what it tells hangs on no primitive
        return world.context(self.device, self.images.config)

    def load(self) -> Perception:
        """Return the trained perception."""
        if self._loaded is None:
            self.results()
            self._loaded = self.config.load(self.folder / "model", self._context())
        return self._loaded
