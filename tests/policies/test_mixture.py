import math

import numpy as np
import pytest
import torch
from torch.distributions import Categorical, Independent, MixtureSameFamily, Normal

from prime_policies.networks.mixture import Mixture, best_means, draw, log_density, wrapped


def mixture() -> Mixture:
    generator = torch.Generator().manual_seed(0)
    return Mixture(
        logits=torch.randn(4, 3, generator=generator),
        means=torch.randn(4, 3, 2, generator=generator),
        deviations=0.1 + torch.rand(3, 2, generator=generator),
        periods=torch.zeros(2),
    )


def test_density_is_that_of_torch() -> None:
    ours, values = mixture(), torch.randn(4, 2, generator=torch.Generator().manual_seed(1))
    parts = Independent(Normal(ours.means, ours.deviations.expand(4, 3, 2)), 1)
    reference = MixtureSameFamily(Categorical(logits=ours.logits), parts)
    torch.testing.assert_close(log_density(ours, values), reference.log_prob(values))


def test_numbers_that_are_not_known_do_not_count() -> None:
    ours, values = mixture(), torch.randn(4, 2, generator=torch.Generator().manual_seed(1))
    first = ours._replace(means=ours.means[..., :1], deviations=ours.deviations[:, :1])
    expected = log_density(first._replace(periods=torch.zeros(1)), values[:, :1])
    ours.means.requires_grad_()
    found = log_density(ours, torch.stack((values[:, 0], torch.full((4,), torch.nan)), dim=1))
    torch.testing.assert_close(found, expected)
    (gradient,) = torch.autograd.grad(found.sum(), ours.means)
    assert gradient.isfinite().all()
    assert not gradient[..., 1].any()


def test_best_mean_is_that_of_the_weightiest_component() -> None:
    ours = mixture()._replace(logits=torch.tensor([[0.0, 2.0, 1.0]] * 4))
    assert torch.equal(best_means(ours), ours.means[:, 1])


def test_a_single_gaussian_has_its_density() -> None:
    one = Mixture(
        torch.zeros(1, 1),
        torch.zeros(1, 1, 1),
        torch.ones(1, 1),
        torch.zeros(1),
    )
    expected = -0.5 * math.log(2 * math.pi)
    assert float(log_density(one, torch.zeros(1, 1))[0]) == pytest.approx(expected)


def test_draws_are_those_of_the_mixture() -> None:
    ours = mixture()
    alone = ours._replace(logits=ours.logits[:1], means=ours.means[:1])
    values = draw(alone, 20_000, np.random.default_rng(0))
    weights = alone.logits.softmax(dim=1)[0, :, None]
    mean = (weights * alone.means[0]).sum(dim=0)
    variance = (weights * (alone.deviations**2 + alone.means[0] ** 2)).sum(dim=0) - mean**2
    torch.testing.assert_close(values.mean(dim=0), mean, atol=0.03, rtol=0)
    torch.testing.assert_close(values.var(dim=0), variance, atol=0.05, rtol=0.03)


def test_values_a_period_apart_are_as_dense() -> None:
    ours = mixture()._replace(periods=torch.tensor([2.0, 0.0]))
    values = torch.randn(4, 2, generator=torch.Generator().manual_seed(1))
    density = log_density(ours, values)
    for turns in (-1, 3):
        moved = values + torch.tensor([2.0 * turns, 0.0])
        torch.testing.assert_close(log_density(ours, moved), density)
    assert bool((density != log_density(ours, values + torch.tensor([0.0, 2.0]))).all())
    apart = values[:, None] - ours.means + torch.tensor([20.0, 0.0])
    assert float(wrapped(apart, torch.tensor([2.0, 0.0]))[..., 0].abs().max()) <= 1.0
