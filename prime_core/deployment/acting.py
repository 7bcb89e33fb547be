"""A trained policy as something that acts: for trials of a run, and for what was exported."""

from collections.abc import Sequence
from pathlib import Path

from prime_core.contracts.perception import Perception
from prime_core.contracts.policy import (
    MotorPolicy,
    MotorPolicyConfig,
    PolicyConfig,
    PrimitivePolicyConfig,
)
from prime_core.contracts.primitive import Primitive
from prime_core.contracts.training import ModelContext
from prime_core.errors import ConfigurationError
from prime_core.execution.runner import PrimitiveRunner
from prime_core.execution.settings import RunnerConfig
from prime_core.learning.perceived import PerceivedMotorPolicy, PerceivedPolicy


def acting_policy(
    config: PolicyConfig,
    checkpoint: Path,
    context: ModelContext,
    perception: Perception | None,
    primitives: Sequence[Primitive],
    runner: RunnerConfig,
) -> MotorPolicy:
    """Load a checkpoint of a policy of either kind.

    Args:
        config: The policy's settings.
        checkpoint: One that its training left.
        context: Where it is used.
        perception: What tells it object poses; None where it is given them, or needs none.
        primitives: In the order of the context's space; a policy over motor actions needs none.
        runner: How calls of primitives are run, if the policy makes any.

    Raises:
        PrimeError: If it is not a checkpoint of these settings.
    """
    if isinstance(config, PrimitivePolicyConfig):
        policy = config.load(checkpoint, context)
        if perception is not None:
            policy = PerceivedPolicy(perception, policy)
        return PrimitiveRunner(policy, primitives, context.description, runner)
    if not isinstance(config, MotorPolicyConfig):
        raise ConfigurationError(
            f"{type(config).__name__} is a policy neither over primitives nor over motor actions"
        )
    motor = config.load(checkpoint, context)
    return motor if perception is None else PerceivedMotorPolicy(perception, motor)
