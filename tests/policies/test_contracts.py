"""The contracts of the core, on everything that this pack registers."""

import subprocess
import sys

import pytest

from prime_core.checks import check_idm, check_policy
from prime_policies.idm.config import MlpGmmIdmConfig
from prime_policies.lerobot.config import ActConfig, DiffusionConfig
from prime_policies.motor.config import BcRnnConfig
from prime_policies.primitive_policy.config import PrimePolicyConfig
from prime_policies.sailor.config import SailorConfig

BRIEF = {"hidden_sizes": (16, 16), "steps_per_epoch": 3, "batch_size": 16}


def test_mlp_gmm_keeps_the_contract() -> None:
    check_idm(MlpGmmIdmConfig(classifier_epochs=2, parameter_epochs=2, **BRIEF))


def test_prime_keeps_the_contract() -> None:
    check_policy(
        PrimePolicyConfig(
            pretraining_epochs=2, finetuning_epochs=2, finetuning_steps_per_epoch=3, **BRIEF
        )
    )


def test_prime_without_pretraining_keeps_the_contract() -> None:
    check_policy(
        PrimePolicyConfig(
            pretrain=False, finetuning_epochs=2, finetuning_steps_per_epoch=3, **BRIEF
        )
    )


@pytest.mark.parametrize("pretrain", [False, True])
def test_bc_rnn_keeps_the_contract(pretrain: bool) -> None:
    check_policy(
        BcRnnConfig(
            pretrain=pretrain,
            hidden=16,
            epochs=3,
            pretraining_epochs=2,
            checkpoints=2,
            steps_per_epoch=3,
            batch_size=16,
        )
    )


SHORT = {
    "epochs": 3,
    "pretraining_epochs": 2,
    "checkpoints": 2,
    "steps_per_epoch": 3,
    "batch_size": 16,
}
NARROW = {"dim_model": 16, "n_heads": 2, "dim_feedforward": 16, "n_encoder_layers": 1}
ENSEMBLE = {"n_action_steps": 1, "temporal_ensemble_coeff": 0.01}


@pytest.mark.parametrize(
    "more", [{}, {"pretrain": True, **ENSEMBLE}, {"use_vae": False}], ids=["", "ensemble", "plain"]
)
def test_act_of_lerobot_keeps_the_contract(more: dict[str, object]) -> None:
    chunks = {"chunk_size": 8, "n_action_steps": 4, "n_vae_encoder_layers": 1}
    check_policy(ActConfig(**SHORT, **NARROW, **chunks | more))


@pytest.mark.parametrize(
    "more",
    [{}, {"pretrain": True, "average": False}, {"noise_scheduler_type": "DDPM", "n_obs_steps": 1}],
    ids=["", "pretrained", "ddpm"],
)
def test_diffusion_of_lerobot_keeps_the_contract(more: dict[str, object]) -> None:
    plans = {"horizon": 8, "n_action_steps": 4, "down_dims": (8, 16), "n_groups": 4}
    noise = {"num_train_timesteps": 20, "num_inference_steps": 5}
    check_policy(DiffusionConfig(**SHORT, **plans, **noise | more))


def test_sailor_keeps_the_contract() -> None:
    small = {"hidden": 16, "hidden_sizes": (16,), "distance_hidden_sizes": (8,), "latent": 4}
    check_policy(
        SailorConfig(
            skills={**small, "steps_per_epoch": 3, "batch_size": 16},
            hidden=16,
            epochs=3,
            pretraining_epochs=2,
            checkpoints=2,
            steps_per_epoch=3,
            batch_size=16,
        )
    )


def test_settings_are_made_without_torch() -> None:
    code = (
        "import sys, prime_policies\n"
        "prime_policies.register_idms(lambda name, config: config())\n"
        "prime_policies.register_policies(lambda name, config: config())\n"
        "prime_policies.register_perceptions(lambda name, config: config())\n"
        "prime_policies.register_encoders(lambda name, config: config())\n"
        "print({'torch', 'lerobot', 'diffusers'} & {*sys.modules})"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "set()"
