"""Models of images: they learn where things are, and nothing but images tells them so."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from prime_core.checks import CheckError, check_idm, check_policy
from prime_core.checks.samples import CONTEXT, FRAMES, sample_calls, sample_observations
from prime_core.contracts.observations import Modality, Observations
from prime_core.contracts.training import CallData, TrainingContext
from prime_core.errors import DatasetError, WeightsError
from prime_policies.encoders.config import SmallCnnConfig
from prime_policies.perception.config import ImageIdmConfig, ImagePolicyConfig
from prime_policies.perception.perception import Perception
from prime_policies.perception.settings import PerceptionSettings

BRIEF = {"hidden_sizes": (16, 16), "steps_per_epoch": 3, "batch_size": 16}
QUICK = PerceptionSettings(hidden=16, epochs=1, steps_per_epoch=2, batch_size=4)
LEARNING = PerceptionSettings(hidden=64, epochs=2, steps_per_epoch=80, batch_size=32, crop=80)


def context(folder: Path, seed: int = 0) -> TrainingContext:
    return TrainingContext(**{**vars(CONTEXT), "device": "cpu"}, folder=folder, seed=seed)


def shown(seed: int, count: int = FRAMES) -> CallData:
    data = sample_calls(seed)
    return replace(data, observations=sample_observations(np.random.default_rng(seed), count))


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("perception")


@pytest.fixture(scope="module")
def perception(folder: Path) -> Perception:
    return Perception.fit(LEARNING, shown(0, 600), context(folder))


def test_mlp_gmm_on_images_keeps_the_contract() -> None:
    check_idm(ImageIdmConfig(classifier_epochs=2, parameter_epochs=2, perception=QUICK, **BRIEF))


@pytest.mark.parametrize("pretrain", [True, False])
def test_prime_on_images_keeps_the_contract(pretrain: bool) -> None:
    check_policy(
        ImagePolicyConfig(
            pretrain=pretrain,
            pretraining_epochs=2,
            finetuning_epochs=2,
            finetuning_steps_per_epoch=3,
            perception=QUICK,
            **BRIEF,
        )
    )


def test_a_model_that_sees_images_must_have_said_so() -> None:
    class Blind(ImageIdmConfig):
        @property
        def modalities(self) -> tuple[Modality, ...]:
            return ("proprioception", "objects")

    brief = Blind(classifier_epochs=1, parameter_epochs=1, perception=QUICK, **BRIEF)
    with pytest.raises(CheckError, match="both or neither must name images"):
        check_idm(brief)


def test_it_learns_where_things_are(perception: Perception) -> None:
    unseen = sample_observations(np.random.default_rng(9), 100)
    found = perception.see(unseen.only(["proprioception", "images"]))
    errors = np.abs(found.object_positions - unseen.object_positions)[..., :2]
    spread = np.abs(unseen.object_positions - unseen.object_positions.mean(axis=0))[..., :2]
    assert np.median(errors) < 0.25 * np.median(spread)


def test_poses_that_the_simulator_knows_do_not_reach_it(perception: Perception) -> None:
    seen = sample_observations(np.random.default_rng(9), 5)
    assert seen.environment_state is not None
    wrong = replace(seen, environment_state=seen.environment_state[::-1] + 1)
    expected = perception.see(seen.only(["proprioception", "images"])).environment_state
    np.testing.assert_array_equal(perception.see(wrong).environment_state, expected)
    dark = {name: np.zeros_like(images) for name, images in seen.images.items()}
    blind = perception.see(replace(seen, images=dark)).environment_state
    assert not np.allclose(blind, expected, atol=1e-3)


def test_what_it_tells_is_like_what_a_simulator_tells(perception: Perception) -> None:
    seen = sample_observations(np.random.default_rng(9), 5)
    found = perception.see(seen)
    assert found.environment_state is not None and seen.environment_state is not None
    assert found.environment_state.shape == seen.environment_state.shape
    assert found.environment_state.dtype == np.float32
    np.testing.assert_allclose(np.linalg.norm(found.object_quaternions, axis=-1), 1, atol=1e-6)


def test_it_is_loaded_as_it_was(perception: Perception, folder: Path) -> None:
    seen = sample_observations(np.random.default_rng(9), 5)
    loaded = Perception.load(LEARNING, folder, CONTEXT)
    expected = perception.see(seen).environment_state
    np.testing.assert_array_equal(loaded.see(seen).environment_state, expected)
    # One after another as at work: no instant depends on those beside it.
    alone = Observations.join([loaded.see(seen[row : row + 1]) for row in range(len(seen))])
    np.testing.assert_allclose(alone.environment_state, expected, atol=1e-5)


def test_another_perception_is_refused(folder: Path, perception: Perception) -> None:
    other = LEARNING.model_copy(update={"encoder": SmallCnnConfig(keypoints=8)})
    with pytest.raises(WeightsError, match=r"settings\.encoder\.keypoints is 32 there, 8 here"):
        Perception.load(other, folder, CONTEXT)


def test_without_images_or_poses_there_is_nothing_to_learn(tmp_path: Path) -> None:
    data = shown(0)
    blind = replace(data, observations=data.observations.only(["proprioception", "objects"]))
    with pytest.raises(DatasetError, match="has no images"):
        Perception.fit(QUICK, blind, context(tmp_path))
    untold = replace(data, observations=data.observations.only(["proprioception", "images"]))
    with pytest.raises(DatasetError, match="has no object poses"):
        Perception.fit(QUICK, untold, context(tmp_path))
    with pytest.raises(DatasetError, match="was given no cameras"):
        Perception(QUICK, replace(CONTEXT, cameras=None), 0)
