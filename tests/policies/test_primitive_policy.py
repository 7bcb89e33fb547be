"""The policy, on rollouts and demonstrations of a toy world."""

from pathlib import Path

import numpy as np
import pytest

from prime_core.contracts.calls import PrimitiveCall
from prime_core.contracts.observations import Observations
from prime_core.contracts.policy import PrimitivePolicy
from prime_core.contracts.training import CallData, Progress, TrainingContext, no_progress
from prime_core.errors import PrimeError
from prime_core.rotations import wrap_angle
from prime_policies.primitive_policy.config import PrimePolicyConfig

from .toy_world import BIN, CONTEXT, SPACE, World, demonstrations, policy_data, rollouts

CONFIG = PrimePolicyConfig(
    hidden_sizes=(64, 64),
    steps_per_epoch=150,
    pretraining_epochs=2,
    finetuning_epochs=2,
    finetuning_steps_per_epoch=600,
)
BRIEF = PrimePolicyConfig(
    hidden_sizes=(8,),
    steps_per_epoch=5,
    batch_size=16,
    pretraining_epochs=2,
    finetuning_epochs=2,
    finetuning_steps_per_epoch=5,
)
ALL = np.array([True, True, True])


class KilledError(Exception):
    """Stands for a kill."""


@pytest.fixture(scope="module")
def explored() -> CallData:
    return policy_data(rollouts(seed=1, episodes=60))


@pytest.fixture(scope="module")
def shown() -> CallData:
    return policy_data(demonstrations(seed=2, episodes=20), augmented=True)


@pytest.fixture(scope="module")
def checkpoints(
    tmp_path_factory: pytest.TempPathFactory, explored: CallData, shown: CallData
) -> list[Path]:
    folder = tmp_path_factory.mktemp("policy")
    return list(CONFIG.fit(explored, shown, context(folder)))


@pytest.fixture(scope="module")
def policy(checkpoints: list[Path]) -> PrimitivePolicy:
    return CONFIG.load(checkpoints[-1], CONTEXT)


def context(folder: Path, seed: int = 0, progress: Progress = no_progress) -> TrainingContext:
    return TrainingContext(**vars(CONTEXT), folder=folder, seed=seed, progress=progress)


def starts(world: World) -> list[Observations]:
    """Return what is seen at the start of each call."""
    seen = world.observations()
    return [seen[start : start + 1] for start, *_ in world.calls]


def act(
    policy: PrimitivePolicy, seen: Observations, startable: np.ndarray = ALL, seed: int = 0
) -> PrimitiveCall:
    return next(policy.candidates(seen, startable, np.random.default_rng(seed)))


def fit(
    folder: Path,
    explored: CallData | None,
    shown: CallData,
    seed: int = 0,
    kill_at: int = 99,
    config: PrimePolicyConfig = BRIEF,
) -> list[Path]:
    def progress(done: int, total: int) -> None:
        if done == kill_at:
            raise KilledError

    return list(config.fit(explored, shown, context(folder, seed, progress)))


def contents(checkpoints: list[Path]) -> list[bytes]:
    return [
        file.read_bytes()
        for folder in checkpoints
        for file in sorted(folder.iterdir())
        if file.suffix == ".safetensors"
    ]


def test_it_does_what_was_shown(policy: PrimitivePolicy) -> None:
    world = demonstrations(seed=9, episodes=40)
    for seen, (_, _, primitive, parameters) in zip(starts(world), world.calls, strict=True):
        call = act(policy, seen)
        assert call.primitive == SPACE.names[primitive]
        assert np.abs(call.parameters[:3] - parameters[:3]).max() < 0.06


def test_it_grasps_where_the_object_is_and_places_where_it_was_shown(
    policy: PrimitivePolicy,
) -> None:
    world = demonstrations(seed=8, episodes=60)
    grasps, yaws, places = [], [], []
    for seen, (_, _, primitive, parameters) in zip(starts(world), world.calls, strict=True):
        call = act(policy, seen)
        if primitive == 1:
            grasps.append(np.linalg.norm(call.parameters[:3] - parameters[:3]))
            yaws.append(abs(wrap_angle(call.parameters[3] - parameters[3], np.pi / 2)))
        else:
            places.append(np.linalg.norm(call.parameters[:3] - BIN))
    assert np.median(grasps) < 0.012
    assert np.degrees(np.median(yaws)) < 6
    assert np.median(places) < 0.025


def test_it_picks_only_what_can_start(policy: PrimitivePolicy) -> None:
    seen = starts(demonstrations(seed=9, episodes=1))[0]
    for index, name in enumerate(SPACE.names):
        assert act(policy, seen, np.arange(3) == index).primitive == name
    assert act(policy, seen, np.array([True, False, True])).primitive != "grasp"


def test_the_first_candidate_costs_one_draw(policy: PrimitivePolicy) -> None:
    seen = starts(demonstrations(seed=9, episodes=1))[0]
    generator, other = np.random.default_rng(3), np.random.default_rng(3)
    next(policy.candidates(seen, np.array([False, True, False]), generator))
    other.choice(3, p=[0.0, 1.0, 0.0])
    assert generator.random() == other.random()


def test_further_candidates_are_near_the_first_then_of_other_primitives(
    policy: PrimitivePolicy,
) -> None:
    seen = starts(demonstrations(seed=9, episodes=1))[0]
    calls = list(policy.candidates(seen, ALL, np.random.default_rng(0)))
    first = calls[0]
    own = [call for call in calls if call.primitive == first.primitive]
    assert calls[: len(own)] == own
    away = [np.linalg.norm(call.parameters[:3] - first.parameters[:3]) for call in own[1:]]
    assert 0 < np.median(away) < 0.1
    assert {call.primitive for call in calls} == set(SPACE.names)


def test_it_is_not_stuck_with_one_primitive_where_it_is_unsure(
    tmp_path: Path, explored: CallData, shown: CallData
) -> None:
    checkpoints = BRIEF.fit(explored, shown, context(tmp_path))
    unsure = BRIEF.load(checkpoints[-1], CONTEXT)
    seen = starts(demonstrations(seed=9, episodes=1))[0]
    picked = {act(unsure, seen, seed=seed).primitive for seed in range(50)}
    assert len(picked) > 1


def test_draws_are_calls_that_can_start_and_are_not_always_the_same(
    policy: PrimitivePolicy,
) -> None:
    generator = np.random.default_rng(0)
    kinds = set()
    for seen in starts(demonstrations(seed=9, episodes=4)):
        for only in np.eye(len(SPACE.names), dtype=bool):
            call = policy.draw(seen, only, generator)
            assert call.primitive == SPACE.names[int(np.flatnonzero(only)[0])]
            assert SPACE.parameter_spaces[int(np.flatnonzero(only)[0])].contains(call.parameters)
        calls = [policy.draw(seen, ALL, generator) for _ in range(20)]
        kinds.add(len({tuple(call.parameters) for call in calls}))
    assert max(kinds) > 1


def test_its_parameters_are_within_their_bounds(policy: PrimitivePolicy) -> None:
    for seen in starts(rollouts(seed=7, episodes=10)):
        call = act(policy, seen)
        assert SPACE.parameter_spaces[SPACE.names.index(call.primitive)].contains(call.parameters)


def test_the_same_scene_gives_the_same_call(policy: PrimitivePolicy) -> None:
    seen = starts(demonstrations(seed=9, episodes=1))[0]
    first, second = act(policy, seen), act(policy, seen, seed=5)
    assert first.primitive == second.primitive
    assert np.array_equal(first.parameters, second.parameters)


def test_a_checkpoint_is_kept_after_each_epoch(checkpoints: list[Path]) -> None:
    assert [path.name for path in checkpoints] == ["checkpoint_01", "checkpoint_02"]
    for path in checkpoints:
        assert sorted(item.name for item in path.iterdir()) == [
            "classifier.safetensors",
            "model.yaml",
            "parameters.safetensors",
        ]
    assert len(set(contents(checkpoints))) == 4
    assert len(checkpoints) == CONFIG.count_checkpoints()


@pytest.fixture(scope="module")
def whole(
    tmp_path_factory: pytest.TempPathFactory, explored: CallData, shown: CallData
) -> list[bytes]:
    """Return the checkpoints of a brief training that was never killed."""
    return contents(fit(tmp_path_factory.mktemp("whole"), explored, shown))


@pytest.mark.parametrize("epoch", [1, 2, 3, 5, 7, 8])
def test_a_killed_training_goes_on_to_the_same_bits(
    tmp_path: Path, explored: CallData, shown: CallData, whole: list[bytes], epoch: int
) -> None:
    with pytest.raises(KilledError):
        fit(tmp_path / "killed", explored, shown, kill_at=epoch)
    assert contents(fit(tmp_path / "killed", explored, shown)) == whole


def test_a_checkpoint_is_complete_only_with_both_networks(
    tmp_path: Path, explored: CallData, shown: CallData
) -> None:
    # Epochs: 2 + 2 of the classifier, 2 + 2 of the parameters.
    with pytest.raises(KilledError):
        fit(tmp_path, explored, shown, kill_at=7)
    BRIEF.load(tmp_path / "checkpoint_01", CONTEXT)
    with pytest.raises(PrimeError, match="holds no trained 'prime'"):
        BRIEF.load(tmp_path / "checkpoint_02", CONTEXT)


def test_the_seed_decides(
    tmp_path: Path, explored: CallData, shown: CallData, whole: list[bytes]
) -> None:
    assert contents(fit(tmp_path / "again", explored, shown)) == whole
    assert contents(fit(tmp_path / "other", explored, shown, seed=1)) != whole


def test_it_trains_without_rollouts(tmp_path: Path, shown: CallData) -> None:
    world = demonstrations(seed=9, episodes=1)
    found = fit(tmp_path, None, shown)
    call = act(BRIEF.load(found[-1], CONTEXT), starts(world)[0])
    assert call.primitive in SPACE.names


def test_rollouts_are_ignored_where_pretraining_is_off(
    tmp_path: Path, explored: CallData, shown: CallData
) -> None:
    config = BRIEF.model_copy(update={"pretrain": False})
    with_rollouts = fit(tmp_path / "a", explored, shown, config=config)
    without = fit(tmp_path / "b", None, shown, config=config)
    assert contents(with_rollouts) == contents(without)


def test_a_folder_that_is_no_checkpoint_is_refused(tmp_path: Path) -> None:
    with pytest.raises(PrimeError, match=r"holds no trained 'prime': model\.yaml is missing"):
        BRIEF.load(tmp_path, CONTEXT)


def test_a_checkpoint_of_other_settings_is_refused(checkpoints: list[Path]) -> None:
    with pytest.raises(PrimeError, match=r"settings\.hidden_sizes is \[64, 64\] there, \[8\] here"):
        BRIEF.load(checkpoints[0], CONTEXT)


def test_a_training_that_diverges_is_not_kept_as_done(tmp_path: Path, shown: CallData) -> None:
    wild = BRIEF.model_copy(update={"learning_rate": 1e30})
    with pytest.raises(PrimeError, match="diverged in epoch 1"):
        fit(tmp_path, None, shown, config=wild)
    assert not list(tmp_path.rglob("*.safetensors"))


def test_it_is_right_where_the_scene_was_never_seen(tmp_path: Path, shown: CallData) -> None:
    """Frames of reference move with their objects: so do the grasps learnt in them."""
    config = CONFIG.model_copy(update={"pretrain": False})
    policy = config.load(fit(tmp_path, None, shown, config=config)[-1], CONTEXT)
    world = World(np.random.default_rng(5))
    errors = []
    for _ in range(30):
        world.reset()
        world.carton = world.carton + np.array([0.0, 0.3, 0.0])  # no demonstration began there
        world.retreat()
        target = world.grasp_target()
        seen = world.observations()[-1:]
        call = act(policy, seen, np.array([False, True, False]))
        errors.append(np.linalg.norm(call.parameters[:3] - target[:3]))
    assert np.median(errors) < 0.02
