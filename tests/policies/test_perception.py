"""The perception: it learns where things are, and nothing but images tells it so."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

from prime_core.checks import check_perception
from prime_core.checks.samples import CONTEXT, FRAMES, sample_observations
from prime_core.collection.random_poses import with_random_poses
from prime_core.contracts.observations import Observations
from prime_core.contracts.training import TrainingContext
from prime_core.errors import DatasetError, WeightsError
from prime_core.learning.scene_features import FeatureEncoder
from prime_policies.encoders.config import SmallCnnConfig
from prime_policies.perception.config import PoseNetworkConfig
from prime_policies.perception.perception import PosePerception

QUICK = PoseNetworkConfig(hidden=16, epochs=1, steps_per_epoch=2, batch_size=4)
LEARNING = PoseNetworkConfig(hidden=64, epochs=2, steps_per_epoch=80, batch_size=32, crop=80)


def context(folder: Path, seed: int = 0) -> TrainingContext:
    return TrainingContext(**{**vars(CONTEXT), "device": "cpu"}, folder=folder, seed=seed)


def shown(seed: int, count: int = FRAMES) -> Observations:
    return sample_observations(np.random.default_rng(seed), count)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("perception")


@pytest.fixture(scope="module")
def perception(folder: Path) -> PosePerception:
    return PosePerception.fit(LEARNING, shown(0, 600), context(folder))


def test_the_pose_network_keeps_the_contract() -> None:
    check_perception(QUICK)


def test_it_learns_where_things_are(perception: PosePerception) -> None:
    unseen = sample_observations(np.random.default_rng(9), 100)
    found = perception.see(unseen.only(["proprioception", "images"]))
    errors = np.abs(found.object_positions - unseen.object_positions)[..., :2]
    spread = np.abs(unseen.object_positions - unseen.object_positions.mean(axis=0))[..., :2]
    assert np.median(errors) < 0.25 * np.median(spread)


def test_poses_that_the_simulator_knows_do_not_reach_it(perception: PosePerception) -> None:
    seen = sample_observations(np.random.default_rng(9), 5)
    assert seen.environment_state is not None
    wrong = replace(seen, environment_state=seen.environment_state[::-1] + 1)
    expected = perception.see(seen.only(["proprioception", "images"])).environment_state
    np.testing.assert_array_equal(perception.see(wrong).environment_state, expected)
    dark = {name: np.zeros_like(images) for name, images in seen.images.items()}
    blind = perception.see(replace(seen, images=dark)).environment_state
    assert not np.allclose(blind, expected, atol=1e-3)


def test_what_it_tells_is_like_what_a_simulator_tells(perception: PosePerception) -> None:
    seen = sample_observations(np.random.default_rng(9), 5)
    found = perception.see(seen)
    assert found.environment_state is not None and seen.environment_state is not None
    assert found.environment_state.shape == seen.environment_state.shape
    assert found.environment_state.dtype == np.float32
    np.testing.assert_allclose(np.linalg.norm(found.object_quaternions, axis=-1), 1, atol=1e-6)


def test_it_is_loaded_as_it_was(perception: PosePerception, folder: Path) -> None:
    seen = sample_observations(np.random.default_rng(9), 5)
    loaded = PosePerception.load(LEARNING, folder, CONTEXT)
    expected = perception.see(seen).environment_state
    np.testing.assert_array_equal(loaded.see(seen).environment_state, expected)
    # One after another as at work: no instant depends on those beside it.
    alone = Observations.join([loaded.see(seen[row : row + 1]) for row in range(len(seen))])
    np.testing.assert_allclose(alone.environment_state, expected, atol=1e-5)


def test_another_perception_is_refused(folder: Path, perception: PosePerception) -> None:
    other = LEARNING.model_copy(update={"encoder": SmallCnnConfig(keypoints=8)})
    with pytest.raises(WeightsError, match=r"settings\.encoder\.keypoints is 32 there, 8 here"):
        PosePerception.load(other, folder, CONTEXT)


def test_without_images_or_poses_there_is_nothing_to_learn(tmp_path: Path) -> None:
    seen = shown(0)
    with pytest.raises(DatasetError, match="has no images"):
        PosePerception.fit(QUICK, seen.only(["proprioception", "objects"]), context(tmp_path))
    with pytest.raises(DatasetError, match="has no object poses"):
        PosePerception.fit(QUICK, seen.only(["proprioception", "images"]), context(tmp_path))
    with pytest.raises(DatasetError, match="was given no cameras"):
        PosePerception(QUICK, replace(CONTEXT, cameras=None), 0)


def test_any_pose_can_be_told() -> None:
    """What is made of the targets of poses looks as they do."""
    network = PosePerception(QUICK, CONTEXT, 0).network
    seen = with_random_poses(shown(0, 500), np.random.default_rng(1))
    targets = torch.from_numpy(network.targets(seen))
    network.measure(torch.zeros(2, 6), targets)
    told = targets.clone()
    told[..., :3] = (targets[..., :3] - network.mean) / network.scale
    told[..., 8] -= 0.5  # a logit
    found = Observations(seen.state, network.environment_state(told))
    np.testing.assert_allclose(found.object_positions, seen.object_positions, atol=1e-5)
    np.testing.assert_array_equal(found.held, seen.held)
    features = FeatureEncoder(CONTEXT.description)
    np.testing.assert_allclose(features.encode(found), features.encode(seen), atol=2e-3)
