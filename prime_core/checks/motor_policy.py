"""What is checked of policies over motor actions alone."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from prime_core.arrays import Floats
from prime_core.checks.requirement import require, require_array
from prime_core.checks.samples import Answer, sample_observations
from prime_core.contracts.calls import PrimitiveSpace
from prime_core.contracts.demonstration import Demonstration
from prime_core.contracts.environment import ACTION_LIMIT
from prime_core.contracts.policy import MotorPolicy, MotorPolicyConfig
from prime_core.contracts.training import TrainingContext

DEMONSTRATIONS = 3
FRAMES = 24
STEPS = 12


def fit_motor_policy(config: MotorPolicyConfig, context: TrainingContext) -> Sequence[Path]:
    """Train a policy on made-up demonstrations, and return its checkpoints."""
    generator = np.random.default_rng(context.seed)
    demonstrations = [_demonstration(generator) for _ in range(DEMONSTRATIONS)]
    return config.fit(demonstrations, replace(context, space=PrimitiveSpace((), ())))


def check_actions(policy: MotorPolicy, seed: int) -> list[Answer]:
    """Return the actions of two episodes that see the same, checked.

    Raises:
        CheckError: If an action is none, or an episode depends on the one before.
    """
    first, second = (_episode(policy, seed) for _ in range(2))
    require(
        first.shape == second.shape and bool(np.allclose(first, second, atol=1e-5)),
        "a policy acts otherwise in a second episode that sees the same: reset() must forget all "
        "of the episode before",
    )
    return [("", first)]


def _episode(policy: MotorPolicy, seed: int) -> Floats:
    seen = sample_observations(np.random.default_rng(seed + 2), STEPS)
    policy.reset(np.random.default_rng(seed))
    actions = []
    for row in range(STEPS):
        action = policy.act(seen[row : row + 1].only(policy.sees))
        if action is None:
            break
        require_array(action, (len(ACTION_LIMIT),), np.floating, "act()")
        require(
            bool(np.all(np.abs(action) <= ACTION_LIMIT + 1e-6)),
            f"act() returned {action}: it must stay within ±{ACTION_LIMIT} (np.clip it)",
        )
        actions.append(action)
    require(bool(actions), "act() gave up at the first step: it must return an action")
    return np.array(actions)


def _demonstration(generator: np.random.Generator) -> Demonstration:
    actions = generator.uniform(-ACTION_LIMIT, ACTION_LIMIT, (FRAMES, len(ACTION_LIMIT)))
    return Demonstration(
        sample_observations(generator, FRAMES), actions.astype(np.float32), "a made-up task"
    )
