"""The settings that a stage builds from, and the classes that make it."""

from collections.abc import Iterator, Mapping
from typing import Any

import exca
from pydantic import BaseModel

from prime_core.configuration import Config
from prime_core.contracts.demonstration import DemonstratorConfig
from prime_core.contracts.environment import EnvironmentConfig
from prime_core.contracts.idm import IdmConfig
from prime_core.contracts.parser import ParserConfig
from prime_core.contracts.policy import PolicyConfig
from prime_core.contracts.primitive import PrimitiveConfig
from prime_core.registry.fields import read_settings

_CHOICES: dict[str, type[Config]] = {
    "demonstrator": DemonstratorConfig,
    "environment": EnvironmentConfig,
    "environments": EnvironmentConfig,
    "idm": IdmConfig,
    "parser": ParserConfig,
    "policy": PolicyConfig,
    "primitives": PrimitiveConfig,
}
"""Fields of stages that hold settings with a ``type``, or several such."""


def settings_in(fields: Mapping[str, Any]) -> list[Config]:
    """Return the settings that a stage's fields hold as plain data, those of its stages left out.

    Args:
        fields: Values of the fields by their names.
    """
    found = []
    for name, base in _CHOICES.items():
        value = fields.get(name, ())
        if not isinstance(value, BaseModel):  # a stage of the same name
            dumps = [value] if isinstance(value, dict) else value
            found += [read_settings(base, dump) for dump in dumps]
    return found


def makers(stage: BaseModel) -> Iterator[type]:
    """Yield the classes of a stage, of those it depends on, and of all their settings."""
    fields = {name: getattr(stage, name) for name in type(stage).model_fields}
    yield type(stage)
    for settings in settings_in(fields):
        yield from _classes(settings)
    for value in fields.values():
        # exca's settings say where a stage runs, not what it is.
        if isinstance(value, BaseModel) and not isinstance(value, exca.MapInfra):
            yield from makers(value)


def _classes(settings: Config) -> Iterator[type]:
    """Yield the classes of settings and of those inside them, such as another pack's encoder."""
    yield type(settings)
    for _, value in settings:
        if isinstance(value, Config):
            yield from _classes(value)
