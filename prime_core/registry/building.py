"""Builds environments and primitives from plain settings."""

from collections.abc import Sequence

from prime_core.configuration import ConfigDump
from prime_core.contracts.environment import EnvironmentConfig
from prime_core.contracts.primitive import PrimitiveConfig
from prime_core.execution.world import World, primitive_space
from prime_core.registry.fields import read_settings


def build_world(environment: ConfigDump, primitives: Sequence[ConfigDump]) -> World:
    """Build an environment and primitives from plain data.

    Raises:
        ConfigurationError: If two primitives have the same name.
    """
    built = read_settings(EnvironmentConfig, environment).build()
    members = tuple(
        read_settings(PrimitiveConfig, dump).build(built.description) for dump in primitives
    )
    primitive_space(members)
    return World(built, members)
