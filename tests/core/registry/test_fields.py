"""Settings whose class is chosen by ``type``: made from plain data, and of the right kind."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from pydantic import ValidationError

from prime_core.contracts.parser import Parser, ParserConfig
from prime_core.contracts.policy import MotorPolicyConfig, PolicyConfig, PrimitivePolicyConfig
from prime_core.errors import ConfigurationError
from prime_core.hookspecs import hookimpl
from prime_core.registry.fields import dump_choice, read_settings
from prime_core.registry.loading import Plugins


class ScissorsConfig(ParserConfig):
    sharpness: float = 1.0

    def build(self) -> Parser:
        raise AssertionError("not built in these tests")


class WalkConfig(MotorPolicyConfig):
    pace: float = 2.0

    def count_checkpoints(self) -> int:
        return 1

    def fit(self, *arguments: Any) -> list[Path]:
        return []

    def load(self, *arguments: Any) -> Any:
        return None


class ThinkConfig(PrimitivePolicyConfig):
    depth: int = 3

    count_checkpoints, fit, load = WalkConfig.count_checkpoints, WalkConfig.fit, WalkConfig.load


@hookimpl
def _parsers(register: Any) -> None:
    register("scissors", ScissorsConfig)


@hookimpl
def _policies(register: Any) -> None:
    register("walk", WalkConfig)
    register("think", ThinkConfig)


@pytest.fixture(autouse=True)
def pack(monkeypatch: pytest.MonkeyPatch) -> None:
    module = SimpleNamespace(register_parsers=_parsers, register_policies=_policies)
    plugins = Plugins()
    plugins.add("one", lambda: module, "prime-one", "1")
    monkeypatch.setattr("prime_core.registry.fields.load_plugins", lambda: plugins)


def test_settings_are_read_from_what_is_dumped() -> None:
    for base, config in (
        (ParserConfig, ScissorsConfig(sharpness=3.0, minimum_steps=7)),
        (PolicyConfig, WalkConfig(pace=1.0)),
        (MotorPolicyConfig, WalkConfig(pace=1.0)),
        (PrimitivePolicyConfig, ThinkConfig(pretrain=False)),
    ):
        dump = dump_choice(config)
        read = read_settings(base, dump)
        assert type(read) is type(config)
        assert read == config


def test_defaults_are_filled_in() -> None:
    assert read_settings(ParserConfig, {"type": "scissors"}).model_dump()["sharpness"] == 1.0


def test_a_policy_of_the_other_kind_is_refused() -> None:
    with pytest.raises(ConfigurationError, match="think is no MotorPolicyConfig: name another"):
        read_settings(MotorPolicyConfig, {"type": "think"})
    with pytest.raises(ConfigurationError, match="walk is no PrimitivePolicyConfig"):
        read_settings(PrimitivePolicyConfig, {"type": "walk"})


def test_settings_of_another_kind_are_not_found() -> None:
    with pytest.raises(ValueError, match="no parser is registered as 'walk'"):
        read_settings(ParserConfig, {"type": "walk"})


def test_a_mistake_in_the_settings_is_told() -> None:
    with pytest.raises(ValidationError, match="unknown key 'peace': did you mean 'pace'"):
        read_settings(PolicyConfig, {"type": "walk", "peace": 1})
    with pytest.raises(ValueError, match="must be a mapping with a type, such as 'type: think'"):
        read_settings(PolicyConfig, {"pace": 1})
