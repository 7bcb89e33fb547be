"""Mixtures of Gaussians with independent dimensions."""

from math import log, pi
from typing import NamedTuple

import numpy as np
import torch
from torch import Tensor


class Mixture(NamedTuple):
    """A batch of mixtures.

    Attributes:
        logits: Of the components' weights, ``(n, K)``.
        means: ``(n, K, D)``.
        deviations: Standard deviations, ``(K, D)``; ``(n, K, D)`` where they depend on what is
            seen, which `draw` does not take.
        periods: By which values may differ and mean the same, ``(D,)``; 0 for none.
    """

    logits: Tensor
    means: Tensor
    deviations: Tensor
    periods: Tensor


def wrapped(differences: Tensor, periods: Tensor) -> Tensor:
    """Return differences the short way round, where there is a period and not 0."""
    turns = (differences / torch.where(periods > 0, periods, torch.inf)).round()
    return differences - periods * turns


def log_density(mixture: Mixture, values: Tensor) -> Tensor:
    """Return the log density at values ``(n, D)``, ``(n,)``; of those numbers that are not NaN."""
    known = ~values.isnan()[:, None]
    differences = torch.where(known, values[:, None] - mixture.means, 0.0)
    standard = wrapped(differences, mixture.periods) / mixture.deviations
    terms = -0.5 * standard.square() - mixture.deviations.log() - 0.5 * log(2 * pi)
    terms = torch.where(known, terms, 0.0)
    return torch.logsumexp(mixture.logits.log_softmax(dim=-1) + terms.sum(dim=-1), dim=-1)


def best_means(mixture: Mixture) -> Tensor:
    """Return the mean of each mixture's weightiest component, ``(n, D)``."""
    best = mixture.logits.argmax(dim=-1)
    return mixture.means[torch.arange(len(best)), best]


def draw(mixture: Mixture, count: int, generator: np.random.Generator) -> Tensor:
    """Draw values of a mixture alone in its batch, ``(count, D)``."""
    weights = mixture.logits[0].double().softmax(dim=-1).numpy()
    chosen = torch.from_numpy(generator.choice(len(weights), count, p=weights / weights.sum()))
    means, deviations = mixture.means[0, chosen], mixture.deviations[chosen]
    return means + deviations * torch.from_numpy(generator.normal(size=means.shape)).float()


def log_mass(mixture: Mixture, values: Tensor, width: float) -> Tensor:
    """Return how much of a mixture alone in its batch lies near values ``(n, D)``, ``(n,)``.

    The log density of the mixture blurred by a width: where components are narrower than what
    matters, the density itself would prefer the narrowest, however little it weighs.
    """
    blurred = mixture._replace(deviations=(mixture.deviations.square() + width**2).sqrt())
    return log_density(blurred, values)
