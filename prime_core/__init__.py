"""prime: robot imitation learning with behaviour primitives.

The contracts that plugins implement are here; everything is imported when it is first used, so
that importing `prime_core` costs nothing.
"""

import importlib
from typing import Any

_MODULES = {
    "Config": "configuration",
    "Demonstration": "demonstration",
    "DemonstratorConfig": "demonstration",
    "Environment": "environment",
    "EnvironmentConfig": "environment",
    "Frames": "frames",
    "IdmConfig": "idm",
    "InverseDynamicsModel": "idm",
    "Parameter": "primitive_calls",
    "ParameterSpace": "primitive_calls",
    "Parser": "parser",
    "ParserConfig": "parser",
    "Policy": "policy",
    "PolicyConfig": "policy",
    "PrimeError": "errors",
    "Primitive": "primitive",
    "PrimitiveCall": "primitive_calls",
    "PrimitiveConfig": "primitive",
    "Scene": "scene",
    "SceneDescription": "scene",
    "Segment": "primitive_calls",
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
