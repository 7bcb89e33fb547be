"""Training pairs from collected episodes, and labelled frames for policies."""

import numpy as np
import pytest

from prime_core.collection.other_pairs import draw_other_pairs
from prime_core.collection.recording import CollectedEpisode
from prime_core.collection.rollouts import RolloutTable
from prime_core.collection.settings import CollectionConfig
from prime_core.contracts.calls import Parameter, ParameterSpace, PrimitiveSpace
from prime_core.learning.training_pairs import (
    PairConfig,
    balanced_weights,
    hard_negatives,
    training_pairs,
)

SPACE = PrimitiveSpace(("reach", "grasp"), (ParameterSpace((Parameter("x", "m", -1.0, 1.0),)),) * 2)


def episode(number: int, held: bool = False, frames: int = 60) -> CollectedEpisode:
    """Return an episode with an object at x = number and two rollouts."""
    objects = np.zeros((frames, 8), dtype=np.float32)
    objects[:, 0], objects[:, 7] = number, held
    return CollectedEpisode(
        state=np.full((frames, 15), number, dtype=np.float32),
        environment_state=objects,
        actions=np.zeros((frames, 5), dtype=np.float32),
        rollouts=np.array([[0, 20, 0], [30, 55, 1]]),
        parameters=np.array([[0.1], [0.2]]) + number,
        others=np.array([[1, 9]]),
        late_ends=np.array([20, 55]),
    )


def test_episodes_lie_end_to_end_and_indices_point_into_their_own() -> None:
    table = RolloutTable([episode(0), episode(1, frames=70)])
    assert table.last == 129
    assert table.rollouts.tolist() == [[0, 20, 0], [30, 55, 1], [60, 80, 0], [90, 115, 1]]
    assert table.others.tolist() == [[1, 9], [61, 69]]
    assert (table.observations.state[table.rows(table.rollouts[:, 0]), 0] == [0, 0, 1, 1]).all()
    assert table.episode(table.others).tolist() == [[0, 0], [1, 1]]


def test_only_frames_that_are_learnt_from_are_kept() -> None:
    counted = episode(0)
    counted.state[:, 0] = np.arange(60)
    table = RolloutTable([counted])
    assert table.observations.state[:, 0].tolist() == [0, 1, 9, 20, 30, 55]
    around = RolloutTable([counted], around=3)
    kept = [*range(4), 9, *range(17, 24), *range(27, 34), *range(52, 59)]
    assert around.observations.state[:, 0].tolist() == [1.0 * number for number in kept]
    assert around.observations.state[around.rows(np.array([9, 52])), 0].tolist() == [9, 52]
    with pytest.raises(ValueError, match="a frame was not kept"):
        table.rows(np.array([20, 21]))


def test_each_class_has_the_same_weight_in_all() -> None:
    labels = np.array([0, 0, 0, 1, 2, 2])
    weights = balanced_weights(labels)
    np.testing.assert_allclose(np.bincount(labels, weights), 1.0)


def test_hard_negatives_join_two_episodes_with_the_object_elsewhere() -> None:
    table = RolloutTable([episode(number) for number in range(20)])
    pairs = hard_negatives(table, PairConfig(hard_negatives=5.0), np.random.default_rng(0))
    assert len(pairs) > 50
    starts = {row[0]: row[2] for row in table.rollouts.tolist()}
    ends = {row[1]: row[2] for row in table.rollouts.tolist()}
    for start, end in pairs.tolist():
        assert starts[start] == ends[end]
        assert table.episode(start) != table.episode(end)


def test_no_hard_negative_starts_with_something_held() -> None:
    table = RolloutTable([episode(number, held=True) for number in range(20)])
    pairs = hard_negatives(table, PairConfig(hard_negatives=5.0), np.random.default_rng(0))
    assert len(pairs) == 0


def test_jitter_moves_ends_a_little_and_never_into_another_episode() -> None:
    episodes = [episode(number) for number in range(5)]
    for number, item in enumerate(episodes):  # each frame tells its episode and its place
        item.state[:, 0], item.state[:, 1] = number, np.arange(60)
    config = PairConfig(jittered_copies=4, jitter_steps=10)
    table = RolloutTable(episodes, config.around)
    data = training_pairs(table, SPACE, config, np.random.default_rng(0))
    exact = len(table.rollouts)
    assert len(data.parameters) == 5 * exact
    states = data.observations.state[data.parameters.rows]
    assert (states[:, 0, 0] == states[:, 1, 0]).all()
    assert (states[:exact, :, 1] == table.rollouts[:, :2] % 60).all()
    shift = states[exact:, :, 1] - np.tile(states[:exact, :, 1], (4, 1))
    assert np.abs(shift).max() == 10
    assert (states[:, 1, 1] > states[:, 0, 1]).all()


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
