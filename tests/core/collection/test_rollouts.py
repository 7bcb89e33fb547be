"""The rollouts of many episodes as one table."""

import numpy as np
import pytest

from prime_core.collection.rollouts import EpisodeImages, FrameConfig, RolloutTable, learnt_frames
from prime_core.contracts.images import ChosenImages

from ..episodes import episode


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
    around = RolloutTable([counted], FrameConfig(around=3))
    kept = [*range(4), 9, *range(17, 24), *range(27, 34), *range(52, 59)]
    assert around.observations.state[:, 0].tolist() == [1.0 * number for number in kept]
    assert around.observations.state[around.rows(np.array([9, 52])), 0].tolist() == [9, 52]
    with pytest.raises(ValueError, match="a frame was not kept"):
        table.rows(np.array([20, 21]))


def test_frames_within_rollouts_are_evenly_apart_and_others_may_be_left_out() -> None:
    found = learnt_frames(episode(0), FrameConfig(within=4, others=False))
    assert found.tolist() == [0, 4, 8, 12, 16, 20, 30, 35, 40, 45, 50, 55]
    assert learnt_frames(episode(0), FrameConfig()).tolist() == [0, 1, 9, 20, 30, 55]


def test_a_table_has_the_images_of_the_frames_that_it_keeps() -> None:
    config = FrameConfig(within=1, others=False)
    images = []
    for number in range(2):
        frames = np.arange(60)
        pictures = np.tile((100 * number + frames).astype(np.uint8)[:, None, None, None], (2, 2, 3))
        images.append(EpisodeImages(frames, {"front": ChosenImages.joined([pictures])}))
    table = RolloutTable([episode(0), episode(1)], config, images)
    shown = np.asarray(table.observations.images["front"])[:, 0, 0, 0]
    assert shown.tolist() == [0, 10, 20, 30, 42, 55, 100, 110, 120, 130, 142, 155]
    short = EpisodeImages(np.array([0, 20]), images[0].images)
    with pytest.raises(ValueError, match="a frame has no image"):
        RolloutTable([episode(0)], config, [short])
