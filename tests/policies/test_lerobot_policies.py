"""LeRobot's ACT and diffusion policies, on episodes of a toy world."""

import sys
from pathlib import Path

import numpy as np
import pytest
import torch
from pydantic import ValidationError
from safetensors.torch import load_file

from prime_core.contracts.demonstration import Demonstration
from prime_core.errors import PrimeError
from prime_policies.lerobot.config import ActConfig, DiffusionConfig, LeRobotConfig
from prime_policies.training.weights import write_tensors

from .episodes import CONTEXT, KilledError, act, contents, episodes, train

TINY_ACT = {
    "chunk_size": 8,
    "n_action_steps": 4,
    "dim_model": 16,
    "n_heads": 2,
    "dim_feedforward": 16,
    "n_encoder_layers": 1,
    "n_vae_encoder_layers": 1,
}
TINY_DIFFUSION = {
    "horizon": 8,
    "n_action_steps": 4,
    "down_dims": (8, 16),
    "n_groups": 4,
    "diffusion_step_embed_dim": 16,
    "num_train_timesteps": 20,
    "num_inference_steps": 5,
}
BRIEF = {"batch_size": 8, "epochs": 2, "checkpoints": 2, "steps_per_epoch": 3}
PRETRAINED = {**BRIEF, "pretrain": True, "pretraining_epochs": 1}
KINDS = {
    "act": ActConfig(**BRIEF, **TINY_ACT),
    "diffusion": DiffusionConfig(**BRIEF, **TINY_DIFFUSION),
}
EACH = pytest.mark.parametrize("config", KINDS.values(), ids=KINDS)
REPLANNED = 4  # steps, in both


@pytest.fixture(scope="module")
def shown() -> list[Demonstration]:
    return episodes(seed=1)


@pytest.fixture(scope="module")
def rollouts() -> list[Demonstration]:
    return episodes(seed=5, count=4, reach=True)


LEARN = {"learning_rate": 3e-3, "batch_size": 32, "epochs": 2, "checkpoints": 1}
PLAN = {"horizon": 4, "n_action_steps": 2, "down_dims": (32,), "prediction_type": "sample"}


@pytest.mark.parametrize(
    "config",
    [
        ActConfig(**LEARN, **TINY_ACT, steps_per_epoch=100),
        DiffusionConfig(**LEARN, **TINY_DIFFUSION | PLAN, steps_per_epoch=120),
    ],
    ids=KINDS,
)
def test_it_does_what_was_shown(
    tmp_path: Path, shown: list[Demonstration], config: LeRobotConfig
) -> None:
    policy = config.load(train(config, tmp_path, shown)[-1], CONTEXT)
    steps = np.concatenate([one.actions[:-1] for one in shown])
    right, unsure, usual = [], [], []
    for one in episodes(seed=9, count=10):
        actions, wanted = act(policy, one), one.actions[:-1]
        right.append(np.mean(np.sign(actions[:, 4]) == wanted[:, 4]))
        unsure.append(np.abs(actions[:, :3] - wanted[:, :3]).mean())
        usual.append(np.abs(steps[:, :3].mean(axis=0) - wanted[:, :3]).mean())
        assert (actions >= steps.min(axis=0)).all() and (actions <= steps.max(axis=0)).all()
        assert (actions[:, 3] == 0).all()  # a number that never varies
    assert np.mean(right) > 0.85
    assert np.mean(unsure) < 0.6 * np.mean(usual)


@EACH
@pytest.mark.parametrize("epoch", [1, 2])
def test_a_killed_training_goes_on_to_the_same_bits(
    tmp_path: Path,
    shown: list[Demonstration],
    rollouts: list[Demonstration],
    config: LeRobotConfig,
    epoch: int,
) -> None:
    """There is one epoch on the rollouts, and there are two on the demonstrations."""
    config = config.model_copy(update=PRETRAINED)
    whole = contents(train(config, tmp_path / "whole", shown, rollouts))
    with pytest.raises(KilledError):
        train(config, tmp_path / "killed", shown, rollouts, kill_at=epoch)
    torch.manual_seed(epoch)  # what others draw must not matter
    assert contents(train(config, tmp_path / "killed", shown, rollouts)) == whole


@EACH
def test_the_seed_and_the_rollouts_decide(
    tmp_path: Path,
    shown: list[Demonstration],
    rollouts: list[Demonstration],
    config: LeRobotConfig,
) -> None:
    first = contents(train(config, tmp_path / "first", shown))
    assert contents(train(config, tmp_path / "ignored", shown, rollouts)) == first
    assert contents(train(config, tmp_path / "other", shown, seed=1)) != first
    pretrained = config.model_copy(update=PRETRAINED)
    assert contents(train(pretrained, tmp_path / "pretrained", shown, rollouts)) != first


@EACH
def test_draws_of_others_neither_matter_nor_are_disturbed(
    tmp_path: Path, shown: list[Demonstration], config: LeRobotConfig
) -> None:
    before = torch.get_rng_state()
    (_, checkpoint) = train(config, tmp_path, shown)
    assert torch.equal(torch.get_rng_state(), before)
    policy = config.load(checkpoint, CONTEXT)
    torch.manual_seed(3)
    before = torch.get_rng_state()
    actions = act(policy, shown[0])
    assert torch.equal(torch.get_rng_state(), before)
    torch.manual_seed(4)
    assert np.array_equal(act(policy, shown[0]), actions)


@EACH
def test_several_actions_are_planned_at_once(
    tmp_path: Path, shown: list[Demonstration], config: LeRobotConfig
) -> None:
    """What is seen between two plans changes nothing before the next one."""
    policy = config.load(train(config, tmp_path, shown)[-1], CONTEXT)
    one, other = (shown[number].observations for number in (0, 1))

    def acts(seen_after: int) -> np.ndarray:
        policy.reset(np.random.default_rng(0))
        steps = range(REPLANNED + 1)
        return np.array([policy.act((one if s < seen_after else other)[s : s + 1]) for s in steps])

    same, changed = acts(REPLANNED + 1), acts(1)
    assert np.array_equal(changed[:REPLANNED], same[:REPLANNED])
    assert not np.array_equal(changed[REPLANNED], same[REPLANNED])
    assert np.array_equal(acts(REPLANNED + 1), same)  # a plan that was cut off is forgotten


def test_an_ensemble_of_plans_looks_in_each_step(
    tmp_path: Path, shown: list[Demonstration]
) -> None:
    """An action is a mean of what is planned now and what was planned before."""
    update = {"n_action_steps": 1}
    alone = KINDS["act"].model_copy(update=update)
    ensemble = alone.model_copy(update={"temporal_ensemble_coeff": 0.01})
    each = [
        act(config.load(train(config, tmp_path / name, shown)[-1], CONTEXT), shown[0])
        for name, config in (("alone", alone), ("ensemble", ensemble))
    ]
    assert np.array_equal(each[0][0], each[1][0])
    away = np.abs(each[0] - each[1]).max(axis=1)
    assert (away[1:] > 1e-6).all()


def test_noise_is_drawn_by_the_generator_of_the_episode(
    tmp_path: Path, shown: list[Demonstration]
) -> None:
    config = KINDS["diffusion"]
    policy = config.load(train(config, tmp_path, shown)[-1], CONTEXT)
    first, again, other = (act(policy, shown[0], seed) for seed in (0, 0, 1))
    assert np.array_equal(first, again)
    assert not np.array_equal(first, other)


def test_what_acts_is_an_average_of_weights_unless_it_is_off(
    tmp_path: Path, shown: list[Demonstration]
) -> None:
    config = KINDS["diffusion"]
    path = train(config, tmp_path / "on", shown)[-1]
    weights = load_file(path / "policy.safetensors")
    name = "diffusion.unet.final_conv.1.weight"
    assert not torch.equal(weights[f"average.{name}"], weights[f"policy.{name}"])
    off = config.model_copy(update={"average": False})
    trained = load_file(train(off, tmp_path / "off", shown)[-1] / "policy.safetensors")
    assert torch.equal(trained[f"policy.{name}"], weights[f"policy.{name}"])
    assert not [key for key in trained if key.startswith("average.")]
    policies = [config.load(path, CONTEXT)]
    write_tensors(path / "policy.safetensors", weights | trained, {})
    policies.append(config.load(path, CONTEXT))
    assert np.array_equal(*(act(policy, shown[0]) for policy in policies))
    blank = {key: torch.zeros_like(value) for key, value in weights.items() if "average" in key}
    write_tensors(path / "policy.safetensors", weights | blank, {})
    assert not np.array_equal(
        *(act(item, shown[0]) for item in (policies[0], config.load(path, CONTEXT)))
    )


def test_a_folder_that_is_no_checkpoint_is_refused(
    tmp_path: Path, shown: list[Demonstration]
) -> None:
    with pytest.raises(PrimeError, match=r"holds no trained 'lerobot/act': model\.yaml is missing"):
        KINDS["act"].load(tmp_path, CONTEXT)
    path = train(KINDS["act"], tmp_path, shown)[-1]
    with pytest.raises(PrimeError, match=r"settings\.dim_model is 16 there, 32 here"):
        KINDS["act"].model_copy(update={"dim_model": 32}).load(path, CONTEXT)


@pytest.mark.parametrize(
    ("config", "settings", "text"),
    [
        (ActConfig, {"chunk_size": 5}, "n_action_steps is 50, chunk_size 5: no more actions"),
        (ActConfig, {"temporal_ensemble_coeff": 0.01}, "n_action_steps is 50: it must be 1 with"),
        (ActConfig, {"dim_model": 100}, "dim_model is 100: it must be even, and a multiple of"),
        (DiffusionConfig, {"horizon": 12}, "horizon is 12: with 3 down_dims it must be a multiple"),
        (DiffusionConfig, {"n_action_steps": 16}, "n_action_steps is 16: horizon and n_obs_steps"),
        (DiffusionConfig, {"down_dims": [60]}, r"down_dims are \[60\]: they must be multiples of"),
        (DiffusionConfig, {"num_train_timesteps": 5}, "num_inference_steps is 10: it must be at"),
    ],
)
def test_settings_that_do_not_fit_together_are_told(
    config: type[LeRobotConfig], settings: dict[str, object], text: str
) -> None:
    with pytest.raises(ValidationError, match=text):
        config(**settings)


@pytest.mark.parametrize(
    ("missing", "told"),
    [("lerobot", [ActConfig, DiffusionConfig]), ("diffusers", [DiffusionConfig])],
)
def test_a_package_that_is_not_installed_is_told(
    monkeypatch: pytest.MonkeyPatch, missing: str, told: list[type[LeRobotConfig]]
) -> None:
    monkeypatch.setitem(sys.modules, missing, None)
    for config in (ActConfig, DiffusionConfig):
        if config not in told:
            config()
            continue
        with pytest.raises(
            ValidationError, match=rf"{missing} cannot be found .*-policies\[lerobot"
        ):
            config()
