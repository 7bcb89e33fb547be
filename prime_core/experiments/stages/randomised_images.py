"""The stage that makes images of frames with object poses drawn at random."""

from collections.abc import Iterator, Sequence
from typing import Annotated, ClassVar

import numpy as np
from pydantic import Field

from prime_core.collection.random_poses import with_random_poses
from prime_core.configuration import ConfigDump
from prime_core.contracts.environment import EnvironmentConfig
from prime_core.contracts.observations import Observations
from prime_core.execution.live_images import with_live_images
from prime_core.experiments.stages.images import CollectionImages, DemonstrationImages, ImageStage
from prime_core.experiments.stages.stage import Result
from prime_core.registry.fields import read_settings
from prime_core.seeds import Stream, generator_of


class RandomisedImages(ImageStage):
    """Frames that have images once more, with objects elsewhere, and fallen."""

    unit: ClassVar[str] = "shards"

    images: Annotated[CollectionImages | DemonstrationImages, Field(discriminator="kind")]
    """Where the frames come from."""
    share: float
    seed: int

    @property
    def environment(self) -> ConfigDump:
        """That of the frames."""
        return self.images.environment

    def items(self) -> list[str]:
        """Return as many as those of the images that frames come from."""
        return self.images.items()

    def process(self, items: Sequence[str]) -> Iterator[Result]:
        """Make the images of shards: of every so many frames, the share that is drawn."""
        environment = read_settings(EnvironmentConfig, self.environment).build()
        seen = self.images.frames_to_learn().only(("proprioception", "objects"))
        names = self.items()
        for item in items:
            number = names.index(item)
            generator = generator_of(Stream.RANDOM_POSES, self.seed, number)
            frames = generator.permutation(np.arange(number, len(seen), len(names)))
            chosen = np.sort(frames[: round(self.share * len(frames))])
            moved = with_random_poses(seen[chosen], generator)
            yield {
                **self.write(item, [with_live_images(moved, environment, self.config)]),
                "state": moved.state,
                "environment_state": moved.environment_state,
            }

    def frames_to_learn(self) -> Observations:
        """Return all of them."""
        return Observations.join(
            [
                Observations(
                    np.array(result["state"]),
                    np.array(result["environment_state"]),
                    self.read(item),
                )
                for item, result in zip(self.items(), self.results(), strict=True)
            ]
        )

    def held_out_frames(self) -> None:
        """Return None: no scene is like these where a model is at work."""
