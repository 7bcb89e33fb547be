"""LeRobot's policies, made from our settings for a scene."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from lerobot.configs import FeatureType, PolicyFeature
from lerobot.configs.policies import PreTrainedConfig
from lerobot.policies.act.configuration_act import ACTConfig
from lerobot.policies.act.modeling_act import ACTPolicy
from lerobot.policies.diffusion.configuration_diffusion import DiffusionConfig
from lerobot.policies.diffusion.modeling_diffusion import DiffusionPolicy
from lerobot.policies.pretrained import PreTrainedPolicy

from prime_core.configuration import Config
from prime_core.contracts.description import SceneDescription
from prime_core.contracts.observations import ENVIRONMENT_STATE_KEY, STATE_KEY
from prime_core.errors import ConfigurationError
from prime_core.learning.scene_features import FeatureEncoder
from prime_policies.lerobot.network import LeRobotNetwork
from prime_policies.lerobot.settings import (
    ActArchitecture,
    ActSettings,
    DiffusionArchitecture,
    DiffusionSettings,
)
from prime_policies.lerobot.statistics import ACTION_KEY, Statistics
from prime_policies.motor.fitting import Design

TYPES = {
    STATE_KEY: FeatureType.STATE,
    ENVIRONMENT_STATE_KEY: FeatureType.ENV,
    ACTION_KEY: FeatureType.ACTION,
}


def act(settings: ActSettings, scenes: SceneDescription) -> Design[LeRobotNetwork]:
    """Return what is trained as ``lerobot/act``.

    Raises:
        ConfigurationError: If the scenes have no objects.
    """

    def policy(features: dict[str, Any]) -> PreTrainedPolicy:
        return ACTPolicy(_normalised(ACTConfig(**features, **_of(settings, ActArchitecture))))

    build = _build("lerobot/act", scenes, policy)
    return Design("lerobot/act", 1, settings, build, settings.chunk_size)


def diffusion(settings: DiffusionSettings, scenes: SceneDescription) -> Design[LeRobotNetwork]:
    """Return what is trained as ``lerobot/diffusion``.

    Raises:
        ConfigurationError: If the scenes have no objects.
    """

    def policy(features: dict[str, Any]) -> PreTrainedPolicy:
        architecture = _of(settings, DiffusionArchitecture)
        return DiffusionPolicy(_normalised(DiffusionConfig(**features, **architecture)))

    build = _build("lerobot/diffusion", scenes, policy, settings.average)
    before = settings.n_obs_steps - 1
    return Design("lerobot/diffusion", 1, settings, build, settings.horizon, before)


def _of(settings: Config, architecture: type[Config]) -> dict[str, Any]:
    return settings.model_dump(include={*architecture.model_fields})


def _normalised(config: PreTrainedConfig) -> PreTrainedConfig:
    # LeRobot leaves an environment state as it is, in metres, unless it is told otherwise.
    mapping = config.normalization_mapping
    config.normalization_mapping = {**mapping, "ENV": mapping["STATE"]}
    return config


def _build(
    kind: str,
    scenes: SceneDescription,
    policy: Callable[[dict[str, Any]], PreTrainedPolicy],
    averaged: bool = False,
) -> Callable[[int, int], LeRobotNetwork]:
    if not scenes.objects:
        raise ConfigurationError(
            f"{kind} needs a scene with objects: LeRobot's policies ask for an environment state"
        )
    own = FeatureEncoder(replace(scenes, objects=())).width

    def build(features: int, actions: int) -> LeRobotNetwork:
        statistics = Statistics(features, actions, own)
        known = {
            key: PolicyFeature(TYPES[key], (size,)) for key, size in statistics.sizes().items()
        }
        outputs = {ACTION_KEY: known.pop(ACTION_KEY)}
        given = {"input_features": known, "output_features": outputs, "device": "cpu"}
        return LeRobotNetwork(policy(given), statistics, averaged)

    return build
