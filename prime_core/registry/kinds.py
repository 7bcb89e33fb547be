"""What can be registered: the class that its settings derive from, and the hook."""

from dataclasses import dataclass

from prime_core.configuration import Config
from prime_core.contracts.demonstration import DemonstratorConfig
from prime_core.contracts.environment import EnvironmentConfig
from prime_core.contracts.exporter import ExporterConfig
from prime_core.contracts.idm import IdmConfig
from prime_core.contracts.images import EncoderConfig
from prime_core.contracts.parser import ParserConfig
from prime_core.contracts.perception import PerceptionConfig
from prime_core.contracts.policy import PolicyConfig
from prime_core.contracts.primitive import PrimitiveConfig


@dataclass(frozen=True)
class Kind:
    """A kind of thing that plugins register."""

    base: type[Config]
    hook: str


KINDS = {
    "environment": Kind(EnvironmentConfig, "register_environments"),
    "primitive": Kind(PrimitiveConfig, "register_primitives"),
    "demonstrator": Kind(DemonstratorConfig, "register_demonstrators"),
    "idm": Kind(IdmConfig, "register_idms"),
    "parser": Kind(ParserConfig, "register_parsers"),
    "policy": Kind(PolicyConfig, "register_policies"),
    "perception": Kind(PerceptionConfig, "register_perceptions"),
    "encoder": Kind(EncoderConfig, "register_encoders"),
    "exporter": Kind(ExporterConfig, "register_exporters"),
}
