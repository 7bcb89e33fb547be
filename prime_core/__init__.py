"""prime: robot imitation learning with behaviour primitives.

The contracts that plugins implement are here; everything is imported when it is first used, so
that importing `prime_core` costs nothing.
"""

import importlib
from typing import Any

_MODULES = {
    "Config": "configuration",
    "Demonstration": "contracts.demonstration",
    "DemonstratorConfig": "contracts.demonstration",
    "Environment": "contracts.environment",
    "EnvironmentConfig": "contracts.environment",
    "Frames": "contracts.observations",
    "IdmConfig": "contracts.idm",
    "InverseDynamicsModel": "contracts.idm",
    "Parameter": "contracts.calls",
    "ParameterSpace": "contracts.calls",
    "Parser": "contracts.parser",
    "ParserConfig": "contracts.parser",
    "Policy": "contracts.policy",
    "PolicyConfig": "contracts.policy",
    "PrimeError": "errors",
    "Primitive": "contracts.primitive",
    "PrimitiveCall": "contracts.calls",
    "PrimitiveConfig": "contracts.primitive",
    "Scene": "contracts.scene",
    "SceneDescription": "contracts.description",
    "Segment": "contracts.demonstration",
    "hookimpl": "hookspecs",
}

__all__ = [
    "Config",
    "Demonstration",
    "DemonstratorConfig",
    "Environment",
    "EnvironmentConfig",
    "Frames",
    "IdmConfig",
    "InverseDynamicsModel",
    "Parameter",
    "ParameterSpace",
    "Parser",
    "ParserConfig",
    "Policy",
    "PolicyConfig",
    "PrimeError",
    "Primitive",
    "PrimitiveCall",
    "PrimitiveConfig",
    "Scene",
    "SceneDescription",
    "Segment",
    "hookimpl",
]


def __getattr__(name: str) -> Any:
    if name not in _MODULES:
        raise AttributeError(f"module 'prime_core' has no attribute {name!r}")
    return getattr(importlib.import_module(f"prime_core.{_MODULES[name]}"), name)
