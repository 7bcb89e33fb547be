"""The stage that trains what tells object poses from images."""

from collections.abc import Iterator, Sequence
from typing import Annotated, ClassVar

from pydantic import Field, PrivateAttr

from prime_core.configuration import ConfigDump
from prime_core.contracts.observations import Observations
from prime_core.contracts.perception import Perception, PerceptionConfig
from prime_core.contracts.training import ModelContext
from prime_core.experiments.stages.images import CollectionImages, DemonstrationImages
from prime_core.experiments.stages.model_training import ModelTraining
from prime_core.experiments.stages.randomised_images import RandomisedImages
from prime_core.experiments.stages.stage import Result
from prime_core.learning.perception_report import report_on_perception
from prime_core.registry.building import build_world
from prime_core.registry.fields import read_settings


class PerceptionTraining(ModelTraining):
    """A perception, trained once: all models, and all seeds of a policy, see through it."""

    title: ClassVar[str] = "perception"

    images: Annotated[CollectionImages | DemonstrationImages, Field(discriminator="kind")]
    """What it is taught on, and tested on."""
    randomised: RandomisedImages | None = None
    """What it is taught on besides."""
    perception: ConfigDump
    _loaded: Perception | None = PrivateAttr(None)  # each checkpoint of a policy asks for it

    @property
    def config(self) -> PerceptionConfig:
        """Which perception."""
        return read_settings(PerceptionConfig, self.perception)

    def process(self, items: Sequence[str]) -> Iterator[Result]:
        """Train the perception, and test it on frames that it has not seen."""
        for item in items:
            taught_on, held_out = self._frames_to_learn(), self.images.held_out_frames()
            context = self.training_context(self._context(), item)
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
