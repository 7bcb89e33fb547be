"""What skills are learnt from: sub-trajectories of the rollouts, each with a later one."""

from typing import NamedTuple

import numpy as np
import torch
from torch import Tensor

from prime_policies.motor.windows import Windows
from prime_policies.sailor.settings import SkillSettings


class SkillBatch(NamedTuple):
    """Sub-trajectories of ``T`` steps, and others of the same episodes that begin later.

    Attributes:
        features: ``(n, T, features)``.
        actions: In their own units, ``(n, T, A)``.
        later_features: Of the later ones.
        later_actions: Likewise.
        distances: How many steps later they begin, ``(n,)``, 0 at an episode's last step.
    """

    features: Tensor
    actions: Tensor
    later_features: Tensor
    later_actions: Tensor
    distances: Tensor


class SkillExamples:
    """Each sub-trajectory with each that begins later, but not too far.

    Half of the later ones begin `SkillSettings.near` steps later at most, the others `far`. One
    that would begin past the end of the episode begins with its last step.

    Args:
        windows: Of the rollouts; a sub-trajectory begins with the step that draws a window.
        settings: How long sub-trajectories are, and how far apart.
    """

    def __init__(self, windows: Windows, settings: SkillSettings) -> None:
        self._windows, self._steps = windows, settings.steps
        near, far = torch.arange(1, settings.near + 1), torch.arange(1, settings.far + 1)
        # As many of either kind, and each distance of a kind as often.
        self._ahead = torch.cat((near.repeat(settings.far), far.repeat(settings.near)))

    def draws(self, generator: np.random.Generator, count: int) -> Tensor:
        """Draw sub-trajectories and how far ahead the later ones begin, as one number each."""
        total = len(self._windows) * len(self._ahead)
        return torch.from_numpy(generator.integers(total, size=count))

    def batch(self, chosen: Tensor) -> SkillBatch:
        """Return the sub-trajectories of some numbers."""
        rows, ahead = chosen // len(self._ahead), self._ahead[chosen % len(self._ahead)]
        later = torch.minimum(rows + ahead, self._windows.ends(rows))
        first, second = self._sub_trajectories(rows), self._sub_trajectories(later)
        return SkillBatch(*first, *second, (later - rows).float())

    def _sub_trajectories(self, rows: Tensor) -> tuple[Tensor, Tensor]:
        return sub_trajectories(self._windows, rows, self._steps)


def sub_trajectories(windows: Windows, rows: Tensor, steps: int) -> tuple[Tensor, Tensor]:
    """Return features ``(n, steps, features)`` and actions ``(n, steps, A)`` that begin with rows.

    They are the ends of windows.
    """
    batch = windows.batch(rows)
    return batch.features[:, -steps:], batch.actions[:, -steps:]
