"""Training pairs from collected episodes."""

from dataclasses import replace

import numpy as np
import pytest

from prime_core.collection.recording import CollectedEpisode
from prime_core.collection.rollouts import EpisodeImages, FrameConfig, RolloutTable
from prime_core.contracts.calls import Parameter, ParameterSpace, PrimitiveSpace
from prime_core.contracts.images import ChosenImages
from prime_core.learning.training_pairs import (
    PairConfig,
    balanced_weights,
    hard_negatives,
    training_pairs,
)

from ..episodes import episode

SPACE = PrimitiveSpace(("reach", "grasp"), (ParameterSpace((Parameter("x", "m", -1.0, 1.0),)),) * 2)


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


def test_hard_negatives_read_no_image() -> None:
    class Unread:
        shape = (60, 4, 4, 3)

        def __getitem__(self, rows: object) -> None:
            raise AssertionError("an image was read")

    images = [EpisodeImages(np.arange(60), {"front": ChosenImages.joined([Unread()])})] * 20
    episodes = [episode(number) for number in range(20)]
    table = RolloutTable(episodes, images=images)
    config = PairConfig(hard_negatives=5.0)
    found = hard_negatives(table, config, np.random.default_rng(0))
    expected = hard_negatives(RolloutTable(episodes), config, np.random.default_rng(0))
    assert np.array_equal(found, expected)


def test_no_hard_negative_is_what_a_place_of_what_is_held_could_lead_to() -> None:
    table = RolloutTable([episode(number, held=True) for number in range(20)])
    pairs = hard_negatives(table, PairConfig(hard_negatives=5.0), np.random.default_rng(0))
    assert len(pairs) == 0


def test_with_something_held_hard_negatives_have_something_else_elsewhere() -> None:
    episodes = []
    for number in range(20):
        item = episode(number, held=True)
        # A second object, which lies still, and elsewhere in every other episode.
        second = np.tile([0.1 * (number % 2), 0, 0, 1, 0, 0, 0, 0], (60, 1))
        objects = np.concatenate((item.environment_state, second), axis=1)
        episodes.append(replace(item, environment_state=objects.astype(np.float32)))
    table = RolloutTable(episodes)
    pairs = hard_negatives(table, PairConfig(hard_negatives=5.0), np.random.default_rng(0))
    assert len(pairs) > 50
    before, after = (table.episode(frames) for frames in pairs.T)
    assert ((before - after) % 2 == 1).all()


def test_jitter_moves_ends_a_little_and_never_into_another_episode() -> None:
    episodes = [episode(number) for number in range(5)]
    for number, item in enumerate(episodes):  # each frame tells its episode and its place
        item.state[:, 0], item.state[:, 1] = number, np.arange(60)
    config = PairConfig(jittered_copies=4, jitter_steps=10)
    table = RolloutTable(episodes, FrameConfig(around=config.around))
    data = training_pairs(table, SPACE, config, np.random.default_rng(0))
    exact = len(table.rollouts)
    assert len(data.parameters) == 5 * exact
    states = data.observations.state[data.parameters.rows]
    assert (states[:, 0, 0] == states[:, 1, 0]).all()
    assert (states[:exact, :, 1] == table.rollouts[:, :2] % 60).all()
    shift = states[exact:, :, 1] - np.tile(states[:exact, :, 1], (4, 1))
    assert np.abs(shift).max() == 10
    assert (states[:, 1, 1] > states[:, 0, 1]).all()


def with_late_ends(left_by: float) -> list[CollectedEpisode]:
    """Return episodes whose first rollout has a late end, where the gripper has moved on."""
    episodes = []
    for number in range(4):
        item = replace(episode(number), late_ends=np.array([28, 55]))
        item.state[:, :3] = 0.0
        item.state[28, 0] = left_by
        item.state[:, 8] = np.arange(60)  # a joint tells which frame it is
        episodes.append(item)
    return episodes


@pytest.mark.parametrize(
    ("left_by", "late_ends", "ends"),
    [(0.05, True, [20, 55, 28]), (0.02, True, [20, 55]), (0.05, False, [20, 55])],
)
def test_parameters_are_also_learnt_from_late_ends_once_the_hand_has_left(
    left_by: float, late_ends: bool, ends: list[int]
) -> None:
    table = RolloutTable(with_late_ends(left_by))
    config = PairConfig(late_ends=late_ends)
    data = training_pairs(table, SPACE, config, np.random.default_rng(0))
    frames = data.observations.state[data.parameters.rows, 8].astype(int)
    late = frames[:, 1] == 28
    assert sorted(set(frames[:, 1].tolist())) == sorted(ends)
    # A late end has the parameters and the start of its rollout, and the types know none.
    assert frames[late].tolist() == [[0, 28]] * (4 if 28 in ends else 0)
    assert data.values[late, 0].tolist() == [0.1, 1.1, 2.1, 3.1][: late.sum()]
    assert (data.parameters.classes[late] == 0).all()
    assert not (data.observations.state[data.types.rows, 8][:, 1] == 28).any()
    weights = data.parameters.weights
    np.testing.assert_allclose(np.bincount(data.parameters.classes, weights), 1.0)
