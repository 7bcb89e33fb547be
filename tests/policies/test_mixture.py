import math

import numpy as np
import pytest
import torch
from torch.distributions import Categorical, Independent, MixtureSameFamily, Normal

from prime_policies.mixture import Mixture, best_means, draw, log_density, wrapped


def mixture() -> Mixture:
    generator = torch.Generator().manual_seed(0)
    return Mixture(
        logits=torch.randn(4, 3, generator=generator),
        means=torch.randn(4, 3, 2, generator=generator),
        deviations=0.1 + torch.rand(4, 3, 2, generator=generator),
        mask=torch.ones(4, 2),
        periods=torch.zeros(4, 2),
    )


def test_density_is_that_of_torch() -> None:
    ours, values = mixture(), torch.randn(4, 2, generator=torch.Generator().manual_seed(1))
    parts = Independent(Normal(ours.means, ours.deviations), 1)
    reference = MixtureSameFamily(Categorical(logits=ours.logits), parts)
    torch.testing.assert_close(log_density(ours, values), reference.log_prob(values))


def test_padding_does_not_count() -> None:
    ours = mixture()
    masked = ours._replace(mask=torch.tensor([[1.0, 0.0]]).expand(4, 2))
    values = torch.zeros(4, 2)
    moved = values + torch.tensor([0.0, 9.0])
    assert torch.equal(log_density(masked, values), log_density(masked, moved))
    alone = Mixture(
        ours.logits,
        ours.means[..., :1],
        ours.deviations[..., :1],
        torch.ones(4, 1),
        torch.zeros(4, 1),
    )
    torch.testing.assert_close(log_density(masked, values), log_density(alone, values[:, :1]))


def test_best_mean_is_that_of_the_weightiest_component() -> None:
    ours = mixture()._replace(logits=torch.tensor([[0.0, 2.0, 1.0]] * 4))
    assert torch.equal(best_means(ours), ours.means[:, 1])


def test_a_single_gaussian_has_its_density() -> None:
    one = Mixture(
        torch.zeros(1, 1),
        torch.zeros(1, 1, 1),
        torch.ones(1, 1, 1),
        torch.ones(1, 1),
        torch.zeros(1, 1),
    )
    expected = -0.5 * math.log(2 * math.pi)
    assert float(log_density(one, torch.zeros(1, 1))[0]) == pytest.approx(expected)


def test_draws_are_those_of_the_mixture_the_densest_first() -> None:
    ours = Mixture(*(item[:1] for item in mixture()))
    values = draw(ours, 20_000, np.random.default_rng(0))
    weights = ours.logits.softmax(dim=1)[0, :, None]
    mean = (weights * ours.means[0]).sum(dim=0)
    variance = (weights * (ours.deviations[0] ** 2 + ours.means[0] ** 2)).sum(dim=0) - mean**2
    torch.testing.assert_close(values.mean(dim=0), mean, atol=0.03, rtol=0)
    torch.testing.assert_close(values.var(dim=0), variance, atol=0.05, rtol=0.03)
    batch = Mixture(*(item.expand(len(values), *item.shape[1:]) for item in ours))
    assert bool((log_density(batch, values).diff() <= 0).all())


def test_values_a_period_apart_are_as_dense() -> None:
    ours = mixture()._replace(periods=torch.tensor([[2.0, 0.0]]).expand(4, 2))
    values = torch.randn(4, 2, generator=torch.Generator().manual_seed(1))
    density = log_density(ours, values)
    for turns in (-1, 3):
        moved = values + torch.tensor([2.0 * turns, 0.0])
        torch.testing.assert_close(log_density(ours, moved), density)
    assert bool((density != log_density(ours, values + torch.tensor([0.0, 2.0]))).all())
    apart = values[:, None] - ours.means + torch.tensor([20.0, 0.0])
    assert float(wrapped(apart, torch.tensor([2.0, 0.0]))[..., 0].abs().max()) <= 1.0
