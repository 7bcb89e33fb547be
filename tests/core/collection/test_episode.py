"""Episodes of random primitives and motor actions."""

import numpy as np
import pytest

from prime_core.collection.episode import Collector
from prime_core.collection.recording import CollectedEpisode
from prime_core.collection.settings import CollectionConfig
from prime_core.contracts.scene import Scene
from prime_core.execution.world import World

from ..execution.toys import Rise
from ..point_mass import PointMass


class Halves(Rise):
    """Can do half of the heights that are drawn, and fails above another."""

    def reachable(self, scene: Scene, parameters: object) -> bool:
        return bool(np.asarray(parameters)[0] < 1.0)

    def propose(self, scene: Scene, generator: np.random.Generator) -> np.ndarray:
        return generator.uniform(0.9, 1.1, 1)


def collect(
    seed: int = 0, primitive: Rise | None = None, **settings: object
) -> tuple[CollectedEpisode, np.ndarray]:
    world = World(PointMass(), (primitive or Halves(),))
    values = {"draws_per_episode": 12, "atomic_steps": (2, 6), "other_steps": (2, 8), **settings}
    config = CollectionConfig.model_validate(values)
    episode, draws = Collector(world, config).collect(np.random.default_rng(seed))
    return episode, draws.counts


def test_an_episode_depends_on_its_seed_alone() -> None:
    first, again, other = collect(3)[0], collect(3)[0], collect(4)[0]
    for name in vars(first):
        assert np.array_equal(getattr(first, name), getattr(again, name)), name
    assert not np.array_equal(first.actions, other.actions)


def test_what_is_recorded_is_what_happened() -> None:
    episode, _ = collect(0)
    assert len(episode.rollouts) > 0
    heights = episode.state[:, 2]
    for (start, end, number), parameters in zip(episode.rollouts, episode.parameters, strict=True):
        assert number == 0
        assert heights[end] >= parameters[0] - 1e-6
        assert 0 <= start <= end < len(heights)
    assert len(episode.actions) == len(heights) == len(episode.environment_state)
    assert not episode.actions[-1].any()
    # The actions lead from each frame to the next.
    np.testing.assert_allclose(heights[:-1] + episode.actions[:-1, 2], heights[1:], atol=1e-5)


def test_draws_are_counted_by_where_they_come_from() -> None:
    counts = np.sum([collect(seed, atomic_share=0.0)[1] for seed in range(40)], axis=0)
    assert counts.shape == (1, 2, 3)
    uniform, prior = counts[0]
    assert 0.85 < prior[0] / (prior[0] + uniform[0]) < 0.95
    for drawn, tried, succeeded in (uniform, prior):
        assert drawn > tried >= succeeded > 0


def test_an_episode_ends_where_all_attempts_from_a_state_fail() -> None:
    class Never(Halves):
        def reachable(self, scene: Scene, parameters: object) -> bool:
            return False

    episode, counts = collect(0, Never(), atomic_share=0.0, attempts=3)
    assert counts[..., 0].sum() == 3
    assert len(episode.rollouts) == 0


def test_motor_actions_after_which_nothing_can_start_are_undone() -> None:
    class Low(Halves):
        def can_start(self, scene: Scene) -> bool:
            return bool(scene.gripper_position[2] < 0.92)

    episode, _ = collect(1, Low(), atomic_share=1.0, draws_per_episode=40)
    free, _ = collect(1, Halves(), atomic_share=1.0, draws_per_episode=40)
    assert 1 < len(episode.state) < len(free.state)
    assert episode.state[-1, 2] < 0.92 < free.state[:, 2].max()


@pytest.mark.parametrize("share", [0.0, 1.0])
def test_the_share_of_motor_actions_is_what_the_settings_say(share: float) -> None:
    found = [collect(seed, atomic_share=share)[0] for seed in range(5)]
    assert any(len(item.rollouts) for item in found) == (share == 0.0)
