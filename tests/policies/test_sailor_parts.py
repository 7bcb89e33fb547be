"""Parts of the policy ``sailor`` alone: examples, nearest latents, distributions, settings."""

import numpy as np
import pytest
import torch
from pydantic import ValidationError

from prime_core.contracts.demonstration import Demonstration
from prime_core.learning.scene_features import FeatureEncoder
from prime_policies.motor.windows import Windows
from prime_policies.sailor.latent_examples import LatentExamples
from prime_policies.sailor.retrieval import Retrieval, nearest
from prime_policies.sailor.settings import SkillSettings
from prime_policies.sailor.skill_examples import SkillExamples
from prime_policies.sailor.skill_model import Gaussian

from .episodes import episodes
from .toy_world import DESCRIPTION

WINDOW, BEFORE = 14, 9
"""Steps of a window that ends with 5 steps of a skill and begins with 10 that were seen."""


def windows(shown: list[Demonstration]) -> Windows:
    return Windows(shown, FeatureEncoder(DESCRIPTION), WINDOW, "the demonstrations", BEFORE)


def test_windows_repeat_the_first_step_before_an_episode() -> None:
    shown = episodes(seed=3, count=2)
    own, first = windows(shown), shown[0].steps  # the second episode's first step
    (seen,) = own.batch(torch.tensor([first + 2])).features
    assert torch.equal(seen[:8], own.features[first].expand(8, -1))
    assert torch.equal(seen[7:14], own.features[first : first + 7])


def test_the_nearest_are_found_in_order() -> None:
    generator = torch.Generator().manual_seed(0)
    targets, candidates = (
        torch.rand(300, 3, generator=generator),
        torch.rand(40, 3, generator=generator),
    )
    found = nearest(targets, candidates, 5)
    expected = (targets[:, None] - candidates).norm(dim=-1).argsort(dim=1)[:, :5]
    assert torch.equal(found, expected)
    assert nearest(targets, candidates, 99).shape == (300, 40)


def test_examples_of_skills_lie_in_one_episode() -> None:
    shown = episodes(seed=3, count=3, width=6)
    own = windows(shown)
    settings = SkillSettings(steps=5, near=2, far=7)
    examples = SkillExamples(own, settings)
    drawn = examples.draws(np.random.default_rng(0), 20_000)
    batch = examples.batch(drawn)
    assert batch.features.shape[:2] == batch.later_actions.shape[:2] == (20_000, 5)
    starts = np.cumsum([0, *(one.steps for one in shown)])
    # The sixth number of an action tells how far the episode is.
    episode_steps = torch.tensor([one.steps for one in shown])
    rows = drawn // 28
    which = torch.from_numpy(np.searchsorted(starts, rows.numpy(), side="right") - 1)
    far = 3 * batch.distances / episode_steps[which]
    torch.testing.assert_close(batch.later_actions[:, 0, 5] - batch.actions[:, 0, 5], far)
    inside = batch.distances == 7
    assert 0 < inside.sum() < (batch.distances == 1).sum()
    assert batch.distances.min() == 0 and batch.distances.max() == 7


def test_half_of_each_batch_was_retrieved() -> None:
    own, prior = windows(episodes(seed=1, count=8)), windows(episodes(seed=4, count=5))
    found = Retrieval(
        shown=torch.arange(float(len(own)))[:, None],
        rows=torch.tensor([3, 8]),
        latents=torch.tensor([[-3.0], [-8.0]]),
        nearest=torch.tensor([[0], [1], [1], [1]]),
    )
    generator = np.random.default_rng(0)
    examples = LatentExamples(own, prior, found, history=10, share=0.5)
    for drawn in examples.draws(generator, 400).reshape(10, 40):
        batch = examples.batch(drawn)
        assert batch.shown.sum() == 20
        assert batch.features.shape == (40, 10, own.features.shape[1])
        for seen, is_shown, (latent,) in zip(*batch, strict=True):
            source = own if is_shown else prior
            assert torch.equal(seen[-1], source.features[abs(int(latent))])
    assert set(batch.latents[batch.shown == 0, 0].tolist()) == {-3.0, -8.0}
    alone = LatentExamples(own, prior, found, history=10, share=0.0)
    assert alone.batch(alone.draws(generator, 50)).shown.all()


def test_divergence_is_that_of_torch() -> None:
    generator = torch.Generator().manual_seed(0)
    one, other = (Gaussian(*torch.randn(2, 6, 3, generator=generator)) for _ in range(2))
    ours = [
        torch.distributions.Normal(item.mean, (item.log_variance / 2).exp())
        for item in (one, other)
    ]
    expected = torch.distributions.kl_divergence(*ours).sum(dim=-1)
    torch.testing.assert_close(one.divergence(other), expected)


def test_settings_that_cannot_be_are_told() -> None:
    with pytest.raises(ValidationError, match="near must be far at most; found near 9, far 3"):
        SkillSettings(near=9, far=3)
