"""Mixtures of Gaussians with independent dimensions."""

from math import log, pi
from typing import NamedTuple

import torch
from torch import Tensor


class Mixture(NamedTuple):
    """A batch of mixtures.

    Attributes:
        logits: Of the components' weights, ``(n, K)``.
        means: ``(n, K, D)``.
        deviations: Standard deviations, ``(n, K, D)``.
        mask: Which dimensions count, ``(n, D)``, 1 or 0.
    """

    logits: Tensor
    means: Tensor
    deviations: Tensor
    mask: Tensor


def log_density(mixture: Mixture, values: Tensor) -> Tensor:
    """Return the log density at values ``(n, D)``, ``(n,)``."""
    standard = (values[:, None] - mixture.means) / mixture.deviations
    terms = -0.5 * standard.square() - mixture.deviations.log() - 0.5 * log(2 * pi)
    components = (terms * mixture.mask[:, None]).sum(dim=-1)
    return torch.logsumexp(mixture.logits.log_softmax(dim=-1) + components, dim=-1)


def best_means(mixture: Mixture) -> Tensor:
    """Return the mean of each mixture's weightiest component, ``(n, D)``."""
    best = mixture.logits.argmax(dim=-1)
    return mixture.means[torch.arange(len(best)), best]
