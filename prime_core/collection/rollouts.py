"""The rollouts of many collected episodes as one table."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from itertools import repeat

import numpy as np
from pydantic import Field

from prime_core.arrays import Floats, Indices
from prime_core.collection.recording import CollectedEpisode
from prime_core.configuration import Config, Count
from prime_core.contracts.images import ChosenImages
from prime_core.contracts.observations import Observations


class FrameConfig(Config):
    """Which frames of episodes are learnt from, besides those where rollouts begin and end."""

    around: int = Field(0, ge=0, le=10_000)
    """Frames on either side of the ends of rollouts."""
    within: int = Field(0, ge=0, le=1000)
    """Frames inside of each rollout, evenly apart."""
    others: bool = True
    """Whether those too where pairs of `other` and late ends are."""
    most_others: Count | None = None
    """Pairs of `other` of an episode at most; None for all."""

    def others_of(self, episode: CollectedEpisode) -> Indices:
        """Return the pairs of `other` of an episode that are learnt from, ``(k, 2)``."""
        return episode.others[: self.most_others]


@dataclass(frozen=True, eq=False)
class EpisodeImages:
    """Images of some frames of an episode.

    Attributes:
        frames: Which, in order, ``(k,)``.
        images: By camera, ``(k, H, W, 3)``.
    """

    frames: Indices
    images: Mapping[str, ChosenImages]

    def at(self, frames: Indices) -> dict[str, ChosenImages]:
        """Return the images of some of the frames, unread.

        Raises:
            ValueError: If one has none.
        """
        if not np.isin(frames, self.frames).all():
            raise ValueError("a frame has no image: images were made with a smaller 'around'")
        rows = np.searchsorted(self.frames, frames)
        return {name: images.chosen(rows) for name, images in self.images.items()}


class RolloutTable:
    """The rollouts of many episodes, and the frames that are learnt from.

    Frames are counted through all episodes, end to end. Most of them lie inside of rollouts and
    motor actions, where nothing is learnt: they are not kept, so that the memory does not grow
    with the length of the episodes.

    Attributes:
        observations: Of the frames that were kept; `rows` tells where.
        rollouts: Start frame, end frame and primitive of each rollout, ``(n, 3)``.
        parameters: Of each rollout, ``(n, width)``.
        others: Start and end frame of pairs of `other`, ``(k, 2)``.
        late_ends: For each rollout a later frame that tells its parameters too, or its end,
            ``(n,)``.
        last: The last frame.

    Args:
        episodes: Each is looked at once.
        frames: Which frames are kept.
        images: Of each episode, at least those of the frames that are kept; None for none.
    """

    def __init__(
        self,
        episodes: Iterable[CollectedEpisode],
        frames: FrameConfig = FrameConfig(),  # noqa: B008
        images: Iterable[EpisodeImages] | None = None,
    ) -> None:
        first, starts = 0, []
        seen: list[Observations] = []
        numbers: list[Indices] = []
        rollouts: list[Indices] = []
        parameters: list[Floats] = []
        others: list[Indices] = []
        late_ends: list[Indices] = []
        for item, pictured in zip(episodes, repeat(None) if images is None else images):  # noqa: B905
            kept = learnt_frames(item, frames)
            starts.append(first)
            numbers.append(kept + first)
            shown = {} if pictured is None else pictured.at(kept)
            seen.append(Observations(item.state[kept], item.environment_state[kept], shown))
            rollouts.append(item.rollouts + np.array([first, first, 0]))
            parameters.append(item.parameters)
            others.append(frames.others_of(item) + first)
            late_ends.append(item.late_ends + first)
            first += len(item.state)
        self.observations = Observations.join(seen)
        self.rollouts = np.concatenate(rollouts)
        self.parameters = np.concatenate(parameters)
        self.others = np.concatenate(others)
        self.late_ends = np.concatenate(late_ends)
        self._starts, self._numbers = np.array(starts), np.concatenate(numbers)
        self.last = first - 1

    def rows(self, numbers: Indices) -> Indices:
        """Return where frames lie in `observations`, in the shape of their numbers.

        Raises:
            ValueError: If one was not kept.
        """
        if not np.isin(numbers, self._numbers).all():
            raise ValueError("a frame was not kept: RolloutTable was told to keep others")
        found: Indices = np.searchsorted(self._numbers, numbers)
        return found

    def episode(self, numbers: Indices) -> Indices:
        """Return the number of the episode that each frame is of."""
        found: Indices = np.searchsorted(self._starts, numbers, side="right") - 1
        return found


def learnt_frames(episode: CollectedEpisode, config: FrameConfig) -> Indices:
    """Return the frames of an episode that are learnt from, in order, ``(k,)``."""
    ends = episode.rollouts[:, :2].reshape(-1, 1)
    used: list[Indices] = [(ends + np.arange(-config.around, config.around + 1)).ravel()]
    if config.within:
        shares = np.arange(1, config.within + 1) / (config.within + 1)
        starts, lengths = episode.rollouts[:, :1], np.diff(episode.rollouts[:, :2], axis=1)
        used.append((starts + np.rint(shares * lengths).astype(np.int64)).ravel())
    if config.others:
        used += [config.others_of(episode).ravel(), episode.late_ends]
    kept: Indices = np.unique(np.clip(np.concatenate(used), 0, len(episode.state) - 1))
    return kept
