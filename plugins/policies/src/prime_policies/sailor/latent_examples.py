"""What the policy of ``sailor`` learns from: latents of demonstrations, and of what was found."""

from typing import NamedTuple

import numpy as np
import torch
from torch import Tensor

from prime_policies.motor.windows import Windows
from prime_policies.sailor.retrieval import Retrieval


class LatentBatch(NamedTuple):
    """Which skill came next.

    Attributes:
        features: What was seen last, the instant that the skill begins with at the end,
            ``(n, history, features)``.
        shown: 1 where it was in a demonstration, 0 where in a rollout, ``(n,)``.
        latents: Of the skill, ``(n, latent)``.
    """

    features: Tensor
    shown: Tensor
    latents: Tensor


class LatentExamples:
    """All sub-trajectories of the demonstrations, then all that were found for one of them.

    What was found for many is there as often.

    Args:
        demonstrations: Windows that begin with what was seen before.
        rollouts: Likewise.
        retrieval: What was found.
        history: Instants that are seen.
        share: Of what is drawn that was found in the rollouts.
    """

    def __init__(
        self,
        demonstrations: Windows,
        rollouts: Windows,
        retrieval: Retrieval,
        history: int,
        share: float,
    ) -> None:
        self._demonstrations, self._rollouts, self._retrieval = demonstrations, rollouts, retrieval
        self._found = retrieval.nearest.flatten()
        self._history, self._share = history, share

    def draws(self, generator: np.random.Generator, count: int) -> Tensor:
        """Draw examples with replacement, ``(count,)``; the share lies even among them."""
        numbers = generator.integers(len(self._demonstrations), size=count)
        found = np.diff(np.floor(np.arange(count + 1) * self._share)) > 0
        others = generator.integers(len(self._found), size=int(found.sum()))
        numbers[found] = len(self._demonstrations) + others
        return torch.from_numpy(numbers)

    def batch(self, chosen: Tensor) -> LatentBatch:
        """Return the examples of some numbers, those of the demonstrations first."""
        count = len(self._demonstrations)
        shown, found = chosen[chosen < count], self._found[chosen[chosen >= count] - count]
        seen = (
            self._demonstrations.batch(shown).features,
            self._rollouts.batch(self._retrieval.rows[found]).features,
        )
        return LatentBatch(
            torch.cat(seen)[:, : self._history],
            torch.cat((torch.ones(len(shown)), torch.zeros(len(found)))),
            torch.cat((self._retrieval.shown[shown], self._retrieval.latents[found])),
        )
