"""Builds environments and primitives from plain settings."""

from collections.abc import Sequence

from prime_core.configuration import ConfigDump
from prime_core.contracts.environment import EnvironmentConfig
from prime_core.contracts.primitive import Primitive, PrimitiveConfig
from prime_core.execution.world import World, primitive_space
from prime_core.registry.fields import validate_choice


def environment_config(dump: ConfigDump) -> EnvironmentConfig:
    """Return settings of an environment from plain data."""
    config = validate_choice("environment", dump)
    assert isinstance(config, EnvironmentConfig)
    return config


def build_world(environment: ConfigDump, primitives: Sequence[ConfigDump]) -> World:
    """Build an environment and primitives from plain data.

    Raises:
        ConfigurationError: If two primitives have the same name.
    """
    built = environment_config(environment).build()
    members: list[Primitive] = []
    for dump in primitives:
        config = validate_choice("primitive", dump)
        assert isinstance(config, PrimitiveConfig)
        members.append(config.build(built.description))
    primitive_space(members)
    return World(built, tuple(members))
