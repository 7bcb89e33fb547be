"""The stage that films an episode of a policy."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from prime_core.configuration import ConfigDump
from prime_core.contracts.scene import Scene
from prime_core.errors import PrimeError
from prime_core.execution.settings import RunnerConfig
from prime_core.execution.trial import run_trial
from prime_core.experiments.stages.motor_policy import AnyPolicyTraining
from prime_core.experiments.stages.stage import Result, Stage
from prime_core.reporting.video import write_video
from prime_core.seeds import Stream, generator_of

SIZE = 256
"""Height and width of the picture in pixels; software rendering makes larger ones slow."""


class Video(Stage):
    """An episode of the first seed's last checkpoint, filmed."""

    title: ClassVar[str] = "video"
    unit: ClassVar[str] = "episodes"
    optional: ClassVar[bool] = True

    training: AnyPolicyTraining
    runner: ConfigDump
    maximum_steps: int

    def items(self) -> list[str]:
        """Return the one item."""
        return ["episode"]

    def outputs(self, item: str) -> list[Path]:
        """Return the video."""
        return [self.folder / f"{item}.mp4"]

    def process(self, items: Sequence[str]) -> Iterator[Result]:
        """Film an episode."""
        for item in items:
            world = self.training.build_world()
            camera = world.environment.default_camera
            if camera is None:
                raise PrimeError("the environment has no camera that shows the whole scene")
            seed = self.training.items()[0]
            path = self.training.checkpoints(seed)[-1]
            runner = RunnerConfig.model_validate(self.runner)
            policy = self.training.load(path, world, runner)
            pictures: list[NDArray[np.uint8]] = []

            def film(_: Scene, pictures: list[NDArray[np.uint8]] = pictures) -> None:
                pictures.append(world.environment.render_camera(camera, SIZE, SIZE))  # noqa: B023

            trial = run_trial(
                world.environment,
                world.primitives,
                policy,
                generator_of(Stream.VIDEO, int(seed)),
                self.maximum_steps,
                on_step=film,
            )
            write_video(self.folder / f"{item}.mp4", np.array(pictures))
            yield {"file": f"{item}.mp4", "success": trial.success, "steps": trial.steps}
