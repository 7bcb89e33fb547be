"""The policy, on rollouts and demonstrations of a toy world."""

from pathlib import Path

import numpy as np
import pytest
from torch import Tensor

from prime_core.contracts.calls import PrimitiveCall
from prime_core.contracts.observations import ENVIRONMENT_STATE_KEY, STATE_KEY
from prime_core.contracts.policy import Policy
from prime_core.contracts.scene import Scene
from prime_core.contracts.training import PolicyData, no_progress
from prime_core.errors import PrimeError
from prime_core.rotations import wrap_angle
from prime_policies.examples import Source
from prime_policies.prime import PrimePolicyConfig

from .toy_world import BIN, DESCRIPTION, SPACE, World, demonstrations, policy_data, rollouts

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
def explored() -> PolicyData:
    return policy_data(rollouts(seed=1, episodes=60))


@pytest.fixture(scope="module")
def shown() -> PolicyData:
    return policy_data(demonstrations(seed=2, episodes=20), augmented=True)


@pytest.fixture(scope="module")
def checkpoints(
    tmp_path_factory: pytest.TempPathFactory, explored: PolicyData, shown: PolicyData
) -> list[Path]:
    folder = tmp_path_factory.mktemp("policy")
    return list(CONFIG.fit(explored, shown, DESCRIPTION, SPACE, folder, 0, no_progress))


@pytest.fixture(scope="module")
def policy(checkpoints: list[Path]) -> Policy:
    return CONFIG.load(checkpoints[-1], DESCRIPTION, SPACE)


def scenes(world: World) -> list[Scene]:
    """Return the scene at the start of each call."""
    frames = world.frames()
    return [
        DESCRIPTION.scene(
            {
                STATE_KEY: frames.state[start],
                ENVIRONMENT_STATE_KEY: frames.environment_state[start],
            }
        )
        for start, *_ in world.calls
    ]


def act(policy: Policy, scene: Scene, startable: np.ndarray = ALL) -> PrimitiveCall:
    return policy.act(scene, startable, anything, np.random.default_rng(0))


def anything(call: PrimitiveCall) -> bool:
    return True


def fit(
    folder: Path,
    explored: PolicyData | None,
    shown: PolicyData,
    seed: int = 0,
    kill_at: int = 99,
    config: PrimePolicyConfig = BRIEF,
) -> list[Path]:
    def progress(done: int, total: int) -> None:
        if done == kill_at:
            raise KilledError

    return list(config.fit(explored, shown, DESCRIPTION, SPACE, folder, seed, progress))


def contents(checkpoints: list[Path]) -> list[bytes]:
    return [
        file.read_bytes()
        for folder in checkpoints
        for file in sorted(folder.iterdir())
        if file.suffix == ".safetensors"
    ]


def test_it_does_what_was_shown(policy: Policy) -> None:
    world = demonstrations(seed=9, episodes=40)
    for scene, (_, _, primitive, parameters) in zip(scenes(world), world.calls, strict=True):
        call = act(policy, scene)
        assert call.primitive == SPACE.names[primitive]
        assert np.abs(call.parameters[:3] - parameters[:3]).max() < 0.06


def test_it_grasps_where_the_object_is_and_places_where_it_was_shown(policy: Policy) -> None:
    world = demonstrations(seed=8, episodes=60)
    grasps, yaws, places = [], [], []
    for scene, (_, _, primitive, parameters) in zip(scenes(world), world.calls, strict=True):
        call = act(policy, scene)
        if primitive == 1:
            grasps.append(np.linalg.norm(call.parameters[:3] - parameters[:3]))
            yaws.append(abs(wrap_angle(call.parameters[3] - parameters[3], np.pi / 2)))
        else:
            places.append(np.linalg.norm(call.parameters[:3] - BIN))
    assert np.median(grasps) < 0.012
    assert np.degrees(np.median(yaws)) < 6
    assert np.median(places) < 0.025


def test_it_picks_only_what_can_start(policy: Policy) -> None:
    scene = scenes(demonstrations(seed=9, episodes=1))[0]
    for index, name in enumerate(SPACE.names):
        assert act(policy, scene, np.arange(3) == index).primitive == name
    assert act(policy, scene, np.array([True, False, True])).primitive != "grasp"


def test_where_the_most_likely_call_is_feasible_no_other_is_drawn(policy: Policy) -> None:
    scene = scenes(demonstrations(seed=9, episodes=1))[0]
    generator, other = np.random.default_rng(3), np.random.default_rng(3)
    policy.act(scene, np.array([False, True, False]), lambda call: True, generator)
    other.choice(3, p=[0.0, 1.0, 0.0])
    assert generator.random() == other.random()


def test_it_leaves_out_what_is_not_feasible(policy: Policy) -> None:
    scene = scenes(demonstrations(seed=9, episodes=1))[0]
    likeliest = act(policy, scene)

    def turned(call: PrimitiveCall) -> bool:
        return not np.array_equal(call.parameters, likeliest.parameters)

    call = policy.act(scene, ALL, turned, np.random.default_rng(0))
    assert call.primitive == likeliest.primitive
    assert np.array_equal(call.parameters[:3], likeliest.parameters[:3])

    def elsewhere(call: PrimitiveCall) -> bool:
        return not np.array_equal(call.parameters[:3], likeliest.parameters[:3])

    call = policy.act(scene, ALL, elsewhere, np.random.default_rng(0))
    assert call.primitive == likeliest.primitive
    assert 0 < np.linalg.norm(call.parameters[:3] - likeliest.parameters[:3]) < 0.1


def test_it_does_something_else_where_a_primitive_is_not_feasible_at_all(policy: Policy) -> None:
    scene = scenes(demonstrations(seed=9, episodes=1))[0]
    likeliest = act(policy, scene)

    def other_primitive(call: PrimitiveCall) -> bool:
        return call.primitive != likeliest.primitive

    call = policy.act(scene, ALL, other_primitive, np.random.default_rng(0))
    assert call.primitive != likeliest.primitive


def test_it_does_the_likeliest_where_nothing_is_feasible(policy: Policy) -> None:
    scene = scenes(demonstrations(seed=9, episodes=1))[0]
    call = policy.act(scene, ALL, lambda call: False, np.random.default_rng(0))
    assert np.array_equal(call.parameters, act(policy, scene).parameters)


def test_it_is_not_stuck_with_one_primitive_where_it_is_unsure(
    tmp_path: Path, explored: PolicyData, shown: PolicyData
) -> None:
    checkpoints = BRIEF.fit(explored, shown, DESCRIPTION, SPACE, tmp_path, 0, no_progress)
    unsure = BRIEF.load(checkpoints[-1], DESCRIPTION, SPACE)
    scene = scenes(demonstrations(seed=9, episodes=1))[0]
    picked = {
        unsure.act(scene, ALL, anything, np.random.default_rng(seed)).primitive
        for seed in range(50)
    }
    assert len(picked) > 1


def test_its_parameters_are_within_their_bounds(policy: Policy) -> None:
    for scene in scenes(rollouts(seed=7, episodes=10)):
        call = act(policy, scene)
        assert SPACE.parameter_spaces[SPACE.names.index(call.primitive)].contains(call.parameters)


def test_the_same_scene_gives_the_same_call(policy: Policy) -> None:
    scene = scenes(demonstrations(seed=9, episodes=1))[0]
    first, second = act(policy, scene), policy.act(scene, ALL, anything, np.random.default_rng(5))
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
    tmp_path_factory: pytest.TempPathFactory, explored: PolicyData, shown: PolicyData
) -> list[bytes]:
    """Return the checkpoints of a brief training that was never killed."""
    return contents(fit(tmp_path_factory.mktemp("whole"), explored, shown))


@pytest.mark.parametrize("epoch", [1, 2, 3, 5, 7, 8])
def test_a_killed_training_goes_on_to_the_same_bits(
    tmp_path: Path, explored: PolicyData, shown: PolicyData, whole: list[bytes], epoch: int
) -> None:
    with pytest.raises(KilledError):
        fit(tmp_path / "killed", explored, shown, kill_at=epoch)
    assert contents(fit(tmp_path / "killed", explored, shown)) == whole


def test_a_checkpoint_is_complete_only_with_both_networks(
    tmp_path: Path, explored: PolicyData, shown: PolicyData
) -> None:
    # Epochs: 2 + 2 of the classifier, 2 + 2 of the parameters.
    with pytest.raises(KilledError):
        fit(tmp_path, explored, shown, kill_at=7)
    BRIEF.load(tmp_path / "checkpoint_01", DESCRIPTION, SPACE)
    with pytest.raises(PrimeError, match="holds no trained 'prime'"):
        BRIEF.load(tmp_path / "checkpoint_02", DESCRIPTION, SPACE)


def test_the_seed_decides(
    tmp_path: Path, explored: PolicyData, shown: PolicyData, whole: list[bytes]
) -> None:
    assert contents(fit(tmp_path / "again", explored, shown)) == whole
    assert contents(fit(tmp_path / "other", explored, shown, seed=1)) != whole


def test_rollouts_may_be_mixed_into_fine_tuning(
    tmp_path: Path, explored: PolicyData, shown: PolicyData, whole: list[bytes]
) -> None:
    mixed = BRIEF.model_copy(update={"rollout_share": 0.25})
    assert contents(fit(tmp_path, explored, shown, config=mixed)) != whole


def test_demonstrations_keep_a_place_in_every_batch(
    tmp_path: Path, explored: PolicyData, shown: PolicyData, monkeypatch: pytest.MonkeyPatch
) -> None:
    counts: list[int] = []
    draws = Source.draws

    def counted(source: Source, generator: np.random.Generator, count: int) -> Tensor:
        counts.append(count)
        return draws(source, generator, count)

    monkeypatch.setattr(Source, "draws", counted)
    fit(tmp_path, explored, shown, config=BRIEF.model_copy(update={"rollout_share": 0.999}))
    assert min(counts) > 0


def test_it_trains_without_rollouts(tmp_path: Path, shown: PolicyData) -> None:
    world = demonstrations(seed=9, episodes=1)
    found = fit(tmp_path, None, shown)
    call = act(BRIEF.load(found[-1], DESCRIPTION, SPACE), scenes(world)[0])
    assert call.primitive in SPACE.names


def test_rollouts_are_ignored_where_pretraining_is_off(
    tmp_path: Path, explored: PolicyData, shown: PolicyData
) -> None:
    config = BRIEF.model_copy(update={"pretrain": False})
    with_rollouts = fit(tmp_path / "a", explored, shown, config=config)
    without = fit(tmp_path / "b", None, shown, config=config)
    assert contents(with_rollouts) == contents(without)


def test_a_folder_that_is_no_checkpoint_is_refused(tmp_path: Path) -> None:
    with pytest.raises(PrimeError, match=r"holds no trained 'prime': model\.yaml is missing"):
        BRIEF.load(tmp_path, DESCRIPTION, SPACE)


def test_a_checkpoint_of_other_settings_is_refused(checkpoints: list[Path]) -> None:
    with pytest.raises(PrimeError, match=r"settings\.hidden_sizes is \[64, 64\] there, \[8\] here"):
        BRIEF.load(checkpoints[0], DESCRIPTION, SPACE)
