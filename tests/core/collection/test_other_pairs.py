"""Pairs of frames that no primitive explains."""

import numpy as np

from prime_core.collection.other_pairs import draw_other_pairs
from prime_core.collection.settings import CollectionConfig


def test_other_pairs_keep_their_lengths_and_leave_out_what_a_rollout_explains() -> None:
    config = CollectionConfig(other_pairs=5000, other_steps=(5, 35))
    rollouts = [(10, 40, 0)]
    pairs = draw_other_pairs(60, rollouts, config, np.random.default_rng(0))
    lengths = pairs[:, 1] - pairs[:, 0]
    assert [lengths.min(), lengths.max()] == [5, 35]
    assert pairs.min() >= 0
    assert pairs.max() <= 59
    explained = (pairs[:, 0] >= 10) & (pairs[:, 0] < 40) & (pairs[:, 1] == 40)
    assert not explained.any()
    assert (pairs[:, 1] == 40).any()  # those that start before the rollout stay


def test_an_episode_shorter_than_the_shortest_pair_has_none() -> None:
    pairs = draw_other_pairs(5, [], CollectionConfig(), np.random.default_rng(0))
    assert pairs.shape == (0, 2)
