"""The stages that keep images that models learn from: made of poses, or those that came along."""

from abc import abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import ClassVar, Literal

import numpy as np

from prime_core.arrays import Indices
from prime_core.collection.rollouts import EpisodeImages, FrameConfig, RolloutTable, learnt_frames
from prime_core.configuration import ConfigDump
from prime_core.contracts.demonstration import Demonstration
from prime_core.contracts.environment import EnvironmentConfig
from prime_core.contracts.images import CameraConfig, ChosenImages
from prime_core.contracts.observations import Observations
from prime_core.datasets.images.files import SUFFIX, ImageFile, write_images
from prime_core.execution.demonstrated_images import DemonstratedImages
from prime_core.execution.live_images import with_live_images
from prime_core.experiments.stages.collection import Collection
from prime_core.experiments.stages.demonstrations import LEFT_OUT, Demonstrations
from prime_core.experiments.stages.stage import Result, Stage
from prime_core.registry.fields import read_settings

AT_ONCE = 64  # images in memory while they are made


class ImageStage(Stage):
    """Images of observations, a file for each item and camera."""

    title: ClassVar[str] = "images"

    cameras: ConfigDump

    @property
    def config(self) -> CameraConfig:
        """Which cameras."""
        return CameraConfig.model_validate(self.cameras)

    @property
    @abstractmethod
    def environment(self) -> ConfigDump:
        """An environment that the images are of."""

    @abstractmethod
    def frames_to_learn(self) -> Observations:
        """Return the frames with images that models learn from; images are unread."""

    @abstractmethod
    def held_out_frames(self) -> Observations | None:
        """Return frames with images that models are tested on, or None if there are none."""

    def file(self, item: str, camera: str) -> Path:
        """Return where an item's images of a camera are kept."""
        return self.folder / f"{item}-{camera}{SUFFIX}"

    def outputs(self, item: str) -> list[Path]:
        """Return an item's files."""
        return [self.file(item, camera) for camera in self.config.cameras]

    def write(self, item: str, parts: Sequence[Observations]) -> Result:
        """Write an item's files.

        Args:
            item: Whose.
            parts: Observations with images, in order; of each camera a few are read at a time.

        Returns:
            How many images there are of a camera, and the bytes of all.
        """
        config, written = self.config, 0
        count = sum(map(len, parts))
        for camera in config.cameras:
            batches = (
                np.asarray(seen.images[camera][start : start + AT_ONCE])
                for seen in parts
                for start in range(0, len(seen), AT_ONCE)
            )
            shape = (count, config.size, config.size, 3)
            written += write_images(self.file(item, camera), batches, shape)
        return {"images": count * len(config.cameras), "bytes": written}

    def read(self, item: str) -> dict[str, ChosenImages]:
        """Return an item's images by camera, unread."""
        cameras = self.config.cameras
        return {name: ChosenImages.joined([ImageFile(self.file(item, name))]) for name in cameras}


class CollectionImages(ImageStage):
    """Images of frames of the rollouts that are learnt from, by the collection's shards."""

    unit: ClassVar[str] = "shards"

    kind: Literal["rollouts"] = "rollouts"
    collection: Collection
    frames: ConfigDump

    @property
    def environment(self) -> ConfigDump:
        """The first one that was collected in."""
        return self.collection.environments[0]

    @property
    def chosen(self) -> FrameConfig:
        """Which frames."""
        return FrameConfig.model_validate(self.frames)

    def items(self) -> list[str]:
        """Return the shards' numbers."""
        return self.collection.items()

    def process(self, items: Sequence[str]) -> Iterator[Result]:
        """Make the images of shards."""
        settings, chosen = self.collection.environments, self.chosen
        shown = [read_settings(EnvironmentConfig, dump).build() for dump in settings]
        for item in items:
            numbers = self.collection.config.shard_episodes(int(item))
            episodes = self.collection.episodes(numbers.start, numbers.stop)
            parts, frames = [], []
            for number, episode in zip(numbers, episodes, strict=True):
                kept = learnt_frames(episode, chosen)
                seen = Observations(episode.state[kept], episode.environment_state[kept])
                parts.append(with_live_images(seen, shown[number % len(shown)], self.config))
                frames.append(kept)
            yield {
                **self.write(item, parts),
                "frames": np.concatenate(frames),
                "counts": [len(kept) for kept in frames],
            }

    def episodes(self, start: int = 0, end: int | None = None) -> Iterator[EpisodeImages]:
        """Return the images of episodes, unread; see `Collection.episodes`."""
        config = self.collection.config
        end = config.episodes if end is None else end
        for item, result in zip(self.items(), self.results(), strict=True):
            images, first = self.read(item), 0
            frames: Indices = np.array(result["frames"])
            numbers = config.shard_episodes(int(item))
            for number, count in zip(numbers, result["counts"], strict=True):
                rows = slice(first, first + count)
                first += count
                if start <= number < end:
                    chosen = {name: each.chosen(rows) for name, each in images.items()}
                    yield EpisodeImages(frames[rows], chosen)

    def table(self, start: int = 0, end: int | None = None) -> RolloutTable:
        """Return the rollouts of episodes, and the frames that have images."""
        episodes = self.collection.episodes(start, end)
        return RolloutTable(episodes, self.chosen, self.episodes(start, end))

    def frames_to_learn(self) -> Observations:
        """Return those of all episodes but the held-out ones."""
        return self.table(end=self.collection.first_held_out).observations

    def held_out_frames(self) -> Observations | None:
        """Return those of the held-out episodes."""
        first = self.collection.first_held_out
        return None if first == self.collection.config.episodes else self.table(first).observations


class DemonstrationImages(ImageStage):
    """Images of all frames of demonstrations, one an item."""

    unit: ClassVar[str] = "demonstrations"

    kind: Literal["demonstrations"] = "demonstrations"
    demonstrations: Demonstrations

    @property
    def environment(self) -> ConfigDump:
        """The task's."""
        return self.demonstrations.environment

    def items(self) -> list[str]:
        """Return the demonstrations' numbers."""
        return self.demonstrations.items()

    def process(self, items: Sequence[str]) -> Iterator[Result]:
        """Take the images that demonstrations come with, and make those of the others."""
        environment = read_settings(EnvironmentConfig, self.environment)
        images, shown = DemonstratedImages(environment, self.config), self.demonstrations.load()
        for item in items:
            if item not in shown:
                yield {LEFT_OUT: True}
                continue
            own = self.demonstrations.with_own_images(item)
            seen = shown[item].observations if own is None else own
            yield self.write(item, [images.of(seen, self.demonstrations.source)])

    def outputs(self, item: str) -> list[Path]:
        """Return an item's files; a demonstration that was left out has none."""
        return [path for path in super().outputs(item) if path.exists()]

    def load(self) -> Mapping[str, Mapping[str, ChosenImages]]:
        """Return the images of all demonstrations that can be used, by their items, unread."""
        pairs = zip(self.items(), self.results(), strict=True)
        return {item: self.read(item) for item, result in pairs if LEFT_OUT not in result}

    def frames_to_learn(self) -> Observations:
        """Return those of all demonstrations: of so few none can be spared."""
        shown = with_images(self.demonstrations, self)
        return Observations.join([one.observations for one in shown.values()])

    def held_out_frames(self) -> None:
        """Return None: there are no others."""


def with_images(
    demonstrations: Demonstrations, images: DemonstrationImages | None
) -> dict[str, Demonstration]:
    """Return all demonstrations that can be used, by their items, with images if they are given."""
    shown = demonstrations.load()
    if images is None:
        return shown
    return {
        item: replace(shown[item], observations=replace(shown[item].observations, images=each))
        for item, each in images.load().items()
    }
