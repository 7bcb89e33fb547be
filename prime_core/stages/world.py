"""Builds what stages act in from plain settings."""

from collections.abc import Sequence
from dataclasses import dataclass

from prime_core.choices import validate_choice
from prime_core.configuration import ConfigDump
from prime_core.environment import Environment, EnvironmentConfig
from prime_core.errors import ConfigurationError
from prime_core.idm import PrimitiveSpace
from prime_core.primitive import Primitive, PrimitiveConfig
from prime_core.scene import SceneDescription


@dataclass(frozen=True, eq=False)
class World:
    """An environment and the primitives that can be run in it."""

    environment: Environment
    primitives: tuple[Primitive, ...]

    @property
    def description(self) -> SceneDescription:
        """Of the environment's scenes."""
        return self.environment.description

    @property
    def space(self) -> PrimitiveSpace:
        """The primitives' names and parameters."""
        return primitive_space(self.primitives)


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


def primitive_space(primitives: Sequence[Primitive]) -> PrimitiveSpace:
    """Return the names and parameters of primitives.

    Raises:
        ConfigurationError: If two have the same name.
    """
    names = tuple(item.name for item in primitives)
    for name in names:
        if names.count(name) > 1:
            raise ConfigurationError(f"primitives: two of them are named {name!r}: leave one out")
    return PrimitiveSpace(names, tuple(item.parameter_space for item in primitives))
