"""Windows of episodes to draw batches from."""

import hashlib
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
import torch
from torch import Tensor

from prime_core.contracts.demonstration import Demonstration
from prime_core.errors import DatasetError
from prime_core.learning.scene_features import FeatureEncoder


class WindowBatch(NamedTuple):
    """Windows of ``T`` steps.

    Attributes:
        features: What was seen before each step, ``(n, T, features)``.
        actions: What was done then, in its own units, ``(n, T, A)``.
        padded: Which steps lie outside of the episode and repeat its first or last one, ``(n, T)``.
    """

    features: Tensor
    actions: Tensor
    padded: Tensor


class Windows:
    """All windows of some steps in a row, one for each step of an episode, which draws it.

    It begins with that step, or some steps before it. As in robomimic and LeRobot, a window that
    reaches past the end of its episode repeats the last step; one that reaches before its start
    repeats the first. The last frame draws no window and is in none: its action was never done.

    Each episode is looked at once. Features and actions of all steps are held, ``4 (F + A)`` bytes
    a step: 60 MB of half a million steps with one object; states and images are not.

    Args:
        episodes: What was done.
        encoder: Of what was seen.
        steps: Of a window.
        source: What the episodes are, for error texts.
        before: Steps of a window before the one that draws it.

    Attributes:
        features: Of all steps, end to end, ``(N, F)``.
        actions: ``(N, A)``.

    Raises:
        DatasetError: If no action was done, or actions are not equally wide.
    """

    def __init__(
        self,
        episodes: Iterable[Demonstration],
        encoder: FeatureEncoder,
        steps: int,
        source: str,
        before: int = 0,
    ) -> None:
        features, actions, starts, ends, count = [], [], [], [], 0
        for episode in episodes:
            features.append(torch.from_numpy(encoder.encode(episode.observations[:-1])))
            actions.append(torch.from_numpy(episode.actions[:-1].astype(np.float32)))
            starts.append(torch.full((episode.steps,), count))
            count += episode.steps
            ends.append(torch.full((episode.steps,), count - 1))
        if not count:
            raise DatasetError(f"there is nothing to learn from: no motor action is in {source}")
        widths = sorted({part.shape[1] for part in actions})
        if len(widths) > 1:
            raise DatasetError(f"actions of {source} have {widths} numbers: all must have as many")
        self.features, self.actions = torch.cat(features), torch.cat(actions)
        self._starts, self._ends = torch.cat(starts), torch.cat(ends)
        self._steps = torch.arange(-before, steps - before)

    def __len__(self) -> int:
        return len(self.features)

    def draws(self, generator: np.random.Generator, count: int) -> Tensor:
        """Draw windows with replacement, ``(count,)``."""
        return torch.from_numpy(generator.integers(len(self), size=count))

    def batch(self, chosen: Tensor) -> WindowBatch:
        """Return the windows that some steps draw."""
        rows = chosen[:, None] + self._steps
        inside = rows.clamp(self._starts[chosen][:, None], self._ends[chosen][:, None])
        return WindowBatch(self.features[inside], self.actions[inside], inside != rows)

    def ends(self, chosen: Tensor) -> Tensor:
        """Return the last step of the episode of each of some steps."""
        return self._ends[chosen]

    @property
    def digest(self) -> str:
        """What tells them apart from others."""
        total = hashlib.blake2b(digest_size=16)
        for part in (self.features, self.actions, self._ends):
            total.update(repr((part.shape, part.dtype)).encode())
            total.update(part.numpy().data)
        return total.hexdigest()


def common_width(rollouts: Windows | None, demonstrations: Windows) -> int:
    """Return how many numbers an action has, in rollouts as in demonstrations.

    Raises:
        DatasetError: If they are not as many.
    """
    shown = demonstrations.actions.shape[1]
    if rollouts is not None and rollouts.actions.shape[1] != shown:
        raise DatasetError(
            f"actions of the rollouts have {rollouts.actions.shape[1]} numbers, those of the "
            f"demonstrations {shown}: pretraining needs as many"
        )
    return shown
