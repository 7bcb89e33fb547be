"""Fields of settings whose class is chosen by ``type``, such as ``type: robosuite/lift``."""

from typing import Annotated, Any

from pydantic import BeforeValidator, SerializeAsAny, WrapSerializer

from prime_core.configuration import Config, ConfigDump
from prime_core.contracts.demonstration import DemonstratorConfig
from prime_core.contracts.environment import EnvironmentConfig
from prime_core.contracts.idm import IdmConfig
from prime_core.contracts.images import EncoderConfig
from prime_core.contracts.parser import ParserConfig
from prime_core.contracts.perception import PerceptionConfig
from prime_core.contracts.policy import PolicyConfig
from prime_core.contracts.primitive import PrimitiveConfig
from prime_core.errors import ConfigurationError, PluginError, PrimeError, UnknownTypeError
from prime_core.registry.contained import described
from prime_core.registry.kinds import KINDS
from prime_core.registry.loading import load_plugins


def validate_choice(kind: str, value: Any) -> Config:
    """Make settings of a kind from plain data with a ``type``.

    Args:
        kind: Such as ``"environment"``.
        value: A mapping with the key ``type``, or settings, which are returned.

    Raises:
        ValueError: If ``type`` is missing or unknown.
        pydantic.ValidationError: If another key is wrong.
        PluginError: If the settings' own code fails.
    """
    registry = load_plugins().registry
    if isinstance(value, registry.base(kind)):
        return value
    names = [entry.name for entry in registry.registrations(kind)]
    if not isinstance(value, dict) or not isinstance(value.get("type"), str):
        example = f"such as 'type: {names[0]}'" if names else "'type: NAME'"
        raise ValueError(f"found {value!r}: it must be a mapping with a type, {example}")
    try:
        config_class = registry.config_class(kind, value["type"])
    except UnknownTypeError as problem:
        raise ValueError(str(problem)) from problem
    try:
        return config_class.model_validate({key: value[key] for key in value if key != "type"})
    except (ValueError, PrimeError):
        raise
    except Exception as problem:
        raise PluginError(
            f"{kind} {value['type']!r}: its settings cannot be read: {described(problem)}"
        ) from problem


def read_settings[AnyConfig: Config](base: type[AnyConfig], dump: ConfigDump) -> AnyConfig:
    """Return registered settings of a kind from plain data.

    Args:
        base: Class that the kind's settings derive from, such as ``EnvironmentConfig``.
        dump: What `dump_choice` returned.
    """
    (kind,) = (name for name, item in KINDS.items() if issubclass(base, item.base))
    config = validate_choice(kind, dump)
    if not isinstance(config, base):
        raise ConfigurationError(f"{dump['type']} is no {base.__name__}: name another type")
    return config


def dump_choice(config: Config) -> ConfigDump:
    """Return settings as plain data with their ``type``, defaults written out."""
    return load_plugins().registry.dump(config)


def _choice(kind: str) -> tuple[BeforeValidator, WrapSerializer]:
    def validate(value: Any) -> Config:
        return validate_choice(kind, value)

    def serialize(config: Config, handler: Any) -> ConfigDump:
        return dump_choice(config)

    return BeforeValidator(validate), WrapSerializer(serialize)


EnvironmentChoice = Annotated[SerializeAsAny[EnvironmentConfig], *_choice("environment")]


PrimitiveChoice = Annotated[SerializeAsAny[PrimitiveConfig], *_choice("primitive")]


DemonstratorChoice = Annotated[SerializeAsAny[DemonstratorConfig], *_choice("demonstrator")]


IdmChoice = Annotated[SerializeAsAny[IdmConfig], *_choice("idm")]


ParserChoice = Annotated[SerializeAsAny[ParserConfig], *_choice("parser")]


PolicyChoice = Annotated[SerializeAsAny[PolicyConfig], *_choice("policy")]


PerceptionChoice = Annotated[SerializeAsAny[PerceptionConfig], *_choice("perception")]


EncoderChoice = Annotated[SerializeAsAny[EncoderConfig], *_choice("encoder")]
