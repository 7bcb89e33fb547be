"""prime: robot imitation learning with behaviour primitives.

What plugins need is here; everything is imported when it is first used, so that importing
`prime_core` costs nothing.
"""

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from prime_core.configuration import Config as Config
    from prime_core.contracts.calls import Parameter as Parameter
    from prime_core.contracts.calls import ParameterSpace as ParameterSpace
    from prime_core.contracts.calls import PrimitiveCall as PrimitiveCall
    from prime_core.contracts.calls import PrimitiveSpace as PrimitiveSpace
    from prime_core.contracts.demonstration import Demonstration as Demonstration
    from prime_core.contracts.demonstration import DemonstratorConfig as DemonstratorConfig
    from prime_core.contracts.demonstration import (
        RecordedDemonstratorConfig as RecordedDemonstratorConfig,
    )
    from prime_core.contracts.demonstration import Segment as Segment
    from prime_core.contracts.description import Affordance as Affordance
    from prime_core.contracts.description import ObjectDescription as ObjectDescription
    from prime_core.contracts.description import RobotDescription as RobotDescription
    from prime_core.contracts.description import SceneDescription as SceneDescription
    from prime_core.contracts.environment import Environment as Environment
    from prime_core.contracts.environment import EnvironmentConfig as EnvironmentConfig
    from prime_core.contracts.exporter import ExporterConfig as ExporterConfig
    from prime_core.contracts.idm import IdmConfig as IdmConfig
    from prime_core.contracts.idm import InverseDynamicsModel as InverseDynamicsModel
    from prime_core.contracts.images import EncoderConfig as EncoderConfig
    from prime_core.contracts.observations import Observations as Observations
    from prime_core.contracts.parser import Parser as Parser
    from prime_core.contracts.parser import ParserConfig as ParserConfig
    from prime_core.contracts.perception import Perception as Perception
    from prime_core.contracts.perception import PerceptionConfig as PerceptionConfig
    from prime_core.contracts.policy import MotorPolicy as MotorPolicy
    from prime_core.contracts.policy import MotorPolicyConfig as MotorPolicyConfig
    from prime_core.contracts.policy import PrimitivePolicy as PrimitivePolicy
    from prime_core.contracts.policy import PrimitivePolicyConfig as PrimitivePolicyConfig
    from prime_core.contracts.primitive import Primitive as Primitive
    from prime_core.contracts.primitive import PrimitiveConfig as PrimitiveConfig
    from prime_core.contracts.scene import ObjectPoses as ObjectPoses
    from prime_core.contracts.scene import Scene as Scene
    from prime_core.contracts.training import CallData as CallData
    from prime_core.contracts.training import Labels as Labels
    from prime_core.contracts.training import ModelContext as ModelContext
    from prime_core.contracts.training import TrainingContext as TrainingContext
    from prime_core.deployment.exported_models import ExportedModels as ExportedModels
    from prime_core.deployment.policy_runner import PolicyRunner as PolicyRunner
    from prime_core.errors import DemonstrationError as DemonstrationError
    from prime_core.errors import PrimeError as PrimeError
    from prime_core.hookspecs import hookimpl as hookimpl

_MODULES = {
    "Affordance": "contracts.description",
    "CallData": "contracts.training",
    "Config": "configuration",
    "Demonstration": "contracts.demonstration",
    "DemonstrationError": "errors",
    "DemonstratorConfig": "contracts.demonstration",
    "EncoderConfig": "contracts.images",
    "Environment": "contracts.environment",
    "EnvironmentConfig": "contracts.environment",
    "ExportedModels": "deployment.exported_models",
    "ExporterConfig": "contracts.exporter",
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
    "Perception": "contracts.perception",
    "PerceptionConfig": "contracts.perception",
    "PolicyRunner": "deployment.policy_runner",
    "PrimeError": "errors",
    "Primitive": "contracts.primitive",
    "PrimitiveCall": "contracts.calls",
    "PrimitiveConfig": "contracts.primitive",
    "PrimitivePolicy": "contracts.policy",
    "PrimitivePolicyConfig": "contracts.policy",
    "PrimitiveSpace": "contracts.calls",
    "RecordedDemonstratorConfig": "contracts.demonstration",
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
    "DemonstrationError",
    "DemonstratorConfig",
    "EncoderConfig",
    "Environment",
    "EnvironmentConfig",
    "ExportedModels",
    "ExporterConfig",
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
    "PolicyRunner",
    "PrimeError",
    "Primitive",
    "PrimitiveCall",
    "PrimitiveConfig",
    "PrimitivePolicy",
    "PrimitivePolicyConfig",
    "PrimitiveSpace",
    "RecordedDemonstratorConfig",
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
