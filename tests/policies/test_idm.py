"""The inverse dynamics model, on rollouts of a toy world."""

import itertools
from pathlib import Path

import numpy as np
import pytest

from prime_core.contracts.idm import InverseDynamicsModel
from prime_core.contracts.training import CallData, Labels, Progress, TrainingContext, no_progress
from prime_core.errors import PrimeError
from prime_policies.idm.config import MlpGmmIdmConfig

from .toy_world import CONTEXT, OTHER, SPACE, pair_data, places_with_retreats, pushes, rollouts

CONFIG = MlpGmmIdmConfig(
    hidden_sizes=(64, 64), classifier_epochs=2, parameter_epochs=2, steps_per_epoch=150
)
BRIEF = MlpGmmIdmConfig(
    hidden_sizes=(8,), classifier_epochs=2, parameter_epochs=2, steps_per_epoch=5, batch_size=16
)


class KilledError(Exception):
    """Stands for a kill."""


def context(folder: Path, seed: int = 0, progress: Progress = no_progress) -> TrainingContext:
    return TrainingContext(**vars(CONTEXT), folder=folder, seed=seed, progress=progress)


def _some(labels: Labels, rows: np.ndarray) -> Labels:
    return Labels(labels.rows[rows], labels.classes[rows], labels.weights[rows])


@pytest.fixture(scope="module")
def unseen() -> CallData:
    return pair_data(rollouts(seed=99, episodes=60))


@pytest.fixture(scope="module")
def trained(tmp_path_factory: pytest.TempPathFactory) -> tuple[InverseDynamicsModel, Path]:
    folder = tmp_path_factory.mktemp("idm")
    data = pair_data(rollouts(seed=1, episodes=80))
    return CONFIG.fit(data, context(folder)), folder


@pytest.fixture(scope="module")
def few() -> CallData:
    return pair_data(rollouts(seed=2, episodes=4))


def fit(data: CallData, folder: Path, seed: int = 0, kill_at: int = 99) -> InverseDynamicsModel:
    def progress(done: int, total: int) -> None:
        assert total == 4
        if done == kill_at:
            raise KilledError

    return BRIEF.fit(data, context(folder, seed, progress))


def answers(idm: InverseDynamicsModel, data: CallData) -> list[np.ndarray]:
    features = idm.encode(data.observations)
    scores = idm.score(features, data.types.rows)
    return [scores, *idm.parameters(features, data.parameters.rows, data.parameters.classes)]


def same(left: list[np.ndarray], right: list[np.ndarray]) -> bool:
    return all(np.array_equal(*both) for both in zip(left, right, strict=True))


def test_primitives_are_told_apart(
    trained: tuple[InverseDynamicsModel, Path], unseen: CallData
) -> None:
    idm, _ = trained
    scores = idm.score(idm.encode(unseen.observations), unseen.types.rows)
    right = scores.argmax(axis=1) == unseen.types.classes
    for label in range(OTHER):
        assert right[unseen.types.classes == label].mean() > 0.75, SPACE.names[label]


def test_scores_are_log_probabilities(
    trained: tuple[InverseDynamicsModel, Path], unseen: CallData
) -> None:
    idm, _ = trained
    scores = idm.score(idm.encode(unseen.observations), unseen.types.rows)
    np.testing.assert_allclose(np.exp(scores).sum(axis=1), 1.0, atol=1e-5)


def test_parameters_are_better_than_where_the_gripper_ends(
    trained: tuple[InverseDynamicsModel, Path], unseen: CallData
) -> None:
    idm, _ = trained
    pairs, labels = unseen.parameters.rows, unseen.parameters.classes
    found, _ = idm.parameters(idm.encode(unseen.observations), pairs, labels)
    ends = unseen.observations.state[pairs[:, 1], :3]
    for label, space in enumerate(SPACE.parameter_spaces):
        rows = labels == label
        error = np.abs(space.difference(found[rows], unseen.values[rows]))
        distance = np.linalg.norm(error[:, :3], axis=1)
        trivial = np.linalg.norm(ends[rows] - unseen.values[rows, :3], axis=1)
        assert np.median(distance) < 0.5 * np.median(trivial)
        # The toy world's noise is 1 mm in each direction: a median of 1.5 mm is all there is.
        assert np.median(distance) < 2.2e-3
        assert np.degrees(np.median(error[:, 3])) < 1.0


def test_few_rollouts_are_enough_for_parameters(tmp_path: Path, unseen: CallData) -> None:
    idm = CONFIG.fit(pair_data(rollouts(seed=3, episodes=12)), context(tmp_path))
    pairs, labels = unseen.parameters.rows, unseen.parameters.classes
    found, _ = idm.parameters(idm.encode(unseen.observations), pairs, labels)
    ends = unseen.observations.state[pairs[:, 1], :3]
    distance = np.linalg.norm(found[:, :3] - unseen.values[:, :3], axis=1)
    trivial = np.linalg.norm(ends - unseen.values[:, :3], axis=1)
    for label in range(OTHER):
        assert np.median(distance[labels == label]) <= np.median(trivial[labels == label])


def test_a_density_falls_away_from_what_is_likely(
    trained: tuple[InverseDynamicsModel, Path], unseen: CallData
) -> None:
    idm, _ = trained
    features = idm.encode(unseen.observations)
    rows = unseen.parameters.classes == 0
    _, likely = idm.parameters(features, unseen.parameters.rows[rows], np.zeros(rows.sum(), int))
    # Four numbers known to about a hundredth of their range.
    assert 8 < np.median(likely) < 30


def test_a_subset_scores_as_among_all(
    trained: tuple[InverseDynamicsModel, Path], unseen: CallData
) -> None:
    idm, _ = trained
    features = idm.encode(unseen.observations)
    pairs = np.array(list(itertools.combinations(range(80), 2)))
    whole = idm.score(features, pairs)
    np.testing.assert_allclose(idm.score(features, pairs[100:110]), whole[100:110], atol=1e-5)
    few = idm.encode(unseen.observations[:80])
    np.testing.assert_allclose(idm.score(few, pairs), whole, atol=1e-5)


def test_what_is_loaded_answers_to_the_same_bits(
    trained: tuple[InverseDynamicsModel, Path], unseen: CallData
) -> None:
    idm, folder = trained
    assert sorted(item.name for item in folder.iterdir()) == [
        "classifier.safetensors",
        "model.yaml",
        "parameters.safetensors",
    ]
    assert same(answers(CONFIG.load(folder, CONTEXT), unseen), answers(idm, unseen))


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory, few: CallData) -> list[np.ndarray]:
    """Return the answers of a brief training that was never killed."""
    return answers(fit(few, tmp_path_factory.mktemp("whole")), few)


@pytest.mark.parametrize("epoch", [1, 2, 3, 4])
def test_a_killed_training_goes_on_to_the_same_bits(
    tmp_path: Path, few: CallData, whole: list[np.ndarray], epoch: int
) -> None:
    with pytest.raises(KilledError):
        fit(few, tmp_path / "killed", kill_at=epoch)
    with pytest.raises(PrimeError, match=r"model\.yaml is missing"):
        BRIEF.load(tmp_path / "killed", CONTEXT)
    assert same(answers(fit(few, tmp_path / "killed"), few), whole)


def test_the_seed_decides(tmp_path: Path, few: CallData, whole: list[np.ndarray]) -> None:
    assert same(answers(fit(few, tmp_path / "again"), few), whole)
    assert not same(answers(fit(few, tmp_path / "other", seed=1), few), whole)


def test_a_finished_training_of_other_data_is_not_overwritten(
    tmp_path: Path, few: CallData
) -> None:
    fit(few, tmp_path)
    with pytest.raises(PrimeError, match="other settings, seed or data"):
        fit(pair_data(rollouts(seed=5, episodes=4)), tmp_path)


def test_an_empty_folder_is_refused(tmp_path: Path) -> None:
    with pytest.raises(PrimeError, match="holds no trained 'mlp-gmm'"):
        BRIEF.load(tmp_path, CONTEXT)


def test_no_rollouts_are_refused(tmp_path: Path, few: CallData) -> None:
    nothing = np.empty((0, 2), dtype=np.int64)
    none = Labels(nothing, nothing[:, 0], np.empty(0))
    empty = CallData(few.observations, none, none, np.empty((0, 4)))
    with pytest.raises(PrimeError, match="no rollout or segment was kept"):
        fit(empty, tmp_path)


def test_a_primitive_without_rollouts_does_no_harm(tmp_path: Path, few: CallData) -> None:
    rows, types = few.parameters.classes != 2, few.types.classes != 2
    data = CallData(
        few.observations, _some(few.types, types), _some(few.parameters, rows), few.values[rows]
    )
    found = answers(fit(data, tmp_path), few)
    assert all(np.isfinite(item).all() for item in found)


def test_where_a_push_started_is_found(tmp_path: Path) -> None:
    """From which way its object moved: the positions alone do not say by a line."""
    idm = CONFIG.fit(pair_data(pushes(seed=1, count=300)), context(tmp_path))
    data = pair_data(pushes(seed=2, count=100))
    found, _ = idm.parameters(
        idm.encode(data.observations), data.parameters.rows, data.parameters.classes
    )
    errors = np.linalg.norm(found[:, :2] - data.values[:, :2], axis=1)
    assert np.median(errors) < 5e-3


def test_a_training_that_diverges_is_not_kept_as_done(tmp_path: Path, few: CallData) -> None:
    wild = BRIEF.model_copy(update={"learning_rate": 1e30})
    with pytest.raises(PrimeError, match=r"'classifier' diverged in epoch 1: .*learning_rate"):
        wild.fit(few, context(tmp_path))
    assert not list(tmp_path.glob("*.safetensors"))
    with pytest.raises(PrimeError, match=r"model\.yaml is missing"):
        wild.load(tmp_path, CONTEXT)


def test_the_place_is_found_from_the_object_when_the_hand_has_left(tmp_path: Path) -> None:
    """A segment of a demonstration often takes in the hand's way back."""
    world = places_with_retreats(seed=1, count=300)
    idm = CONFIG.fit(pair_data(world), context(tmp_path))
    data = pair_data(places_with_retreats(seed=2, count=100))
    features = idm.encode(data.observations)
    rows = data.parameters.rows
    found, _ = idm.parameters(features, rows, data.parameters.classes)
    errors = np.linalg.norm(found[:, :2] - data.values[:, :2], axis=1)
    away = np.linalg.norm(
        data.observations.gripper_position[rows[:, 1], :2] - data.values[:, :2], axis=1
    )
    assert np.median(away[away > 0.02]) > 0.04
    assert np.median(errors[away > 0.02]) < 6e-3
    assert np.median(errors[away <= 0.02]) < 3e-3
