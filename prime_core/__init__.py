"""prime: robot imitation learning with behaviour primitives.

What plugins need is here; everything is imported when it is first used, so that importing
`prime_core` costs nothing.
"""

import importlib
from typing import Any

_MODULES = {
    "Affordance": "contracts.description",
    "CallData": "contracts.training",
    "Config": "configuration",
    "Demonstration": "contracts.demonstration",
    "DemonstratorConfig": "contracts.demonstration",
    "Environment": "contracts.environment",
    "EnvironmentConfig": "contracts.environment",
    "IdmConfig": "contracts.idm",
    "InverseDynamicsModel": "contracts.idm",
    "Labels": "contracts.training",
    "ModelContext": "contracts.training",
    "MotorPolicy": "contracts.policy",
    "MotorPolicyConfig": "contracts.policy",
    "ObjectDescription": "contracts.description",
    "ObjectPoses": "contracts.scene",
    "Observations": "contracts.observations",
    "Parameter": "contracts.calls",
    "ParameterSpace": "contracts.calls",
    "Parser": "contracts.parser",
    "ParserConfig": "contracts.parser",
    "PrimeError": "errors",
    "Primitive": "contracts.primitive",
    "PrimitiveCall": "contracts.calls",
    "PrimitiveConfig": "contracts.primitive",
    "PrimitivePolicy": "contracts.policy",
    "PrimitivePolicyConfig": "contracts.policy",
    "PrimitiveSpace": "contracts.calls",
    "RobotDescription": "contracts.description",
    "Scene": "contracts.scene",
    "SceneDescription": "contracts.description",
    "Segment": "contracts.demonstration",
    "TrainingContext": "contracts.training",
    "hookimpl": "hookspecs",
}

__all__ = [
    "Affordance",
    "CallData",
    "Config",
    "Demonstration",
    "DemonstratorConfig",
    "Environment",
    "EnvironmentConfig",
    "IdmConfig",
    "InverseDynamicsModel",
    "Labels",
    "ModelContext",
    "MotorPolicy",
    "MotorPolicyConfig",
    "ObjectDescription",
    "ObjectPoses",
    "Observations",
    "Parameter",
    "ParameterSpace",
    "Parser",
    "ParserConfig",
    "PrimeError",
    "Primitive",
    "PrimitiveCall",
    "PrimitiveConfig",
    "PrimitivePolicy",
    "PrimitivePolicyConfig",
    "PrimitiveSpace",
    "RobotDescription",
    "Scene",
    "SceneDescription",
    "Segment",
    "TrainingContext",
    "hookimpl",
]


def __getattr__(name: str) -> Any:
    if name not in _MODULES:
        raise AttributeError(f"module 'prime_core' has no attribute {name!r}")
    return getattr(importlib.import_module(f"prime_core.{_MODULES[name]}"), name)
