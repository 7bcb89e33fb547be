"""What is checked of one kind of policies alone: over primitives, and over motor actions."""

from collections.abc import Sequence
from itertools import islice
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from prime_core.arrays import Floats
from prime_core.checks.requirement import require, require_array
from prime_core.checks.samples import SPACE, Answer, sample_calls, sample_observations
from prime_core.contracts.calls import PrimitiveCall
from prime_core.contracts.demonstration import Demonstration
from prime_core.contracts.environment import ACTION_LIMIT
from prime_core.contracts.observations import Observations
from prime_core.contracts.policy import (
    MotorPolicy,
    MotorPolicyConfig,
    PrimitivePolicy,
    PrimitivePolicyConfig,
)
from prime_core.contracts.training import TrainingContext

SCENES = 8
CANDIDATES = 5
"""Candidates looked at in each scene; a policy may yield any number."""

DEMONSTRATIONS = 3
FRAMES = 24
STEPS = 12


def fit_primitive_policy(config: PrimitivePolicyConfig, context: TrainingContext) -> Sequence[Path]:
    """Train a policy on made-up rollouts and demonstrations, and return its checkpoints."""
    rollouts = sample_calls(context.seed) if config.pretrain else None
    return config.fit(rollouts, sample_calls(context.seed + 1), context)


def check_calls(policy: PrimitivePolicy, seed: int) -> list[Answer]:
    """Return the first candidates, and draws, in some scenes where everything can start, checked.

    Raises:
        CheckError: If a candidate is no call of a primitive that can start.
    """
    seen = sample_observations(np.random.default_rng(seed + 2), SCENES)
    scenes = [seen[row : row + 1].only(policy.sees) for row in range(SCENES)]
    for index, name in enumerate(SPACE.names):
        alone = np.arange(len(SPACE.names)) == index
        for scene in scenes:
            for call in _candidates(policy, scene, alone, np.random.default_rng(seed)):
                require(
                    call.primitive == name,
                    f"candidates() or draw() gave {call.primitive!r} where only {name!r} can "
                    "start: they must choose among the primitives that `startable` allows",
                )
    everything = np.ones(len(SPACE.names), dtype=np.bool_)
    generator = np.random.default_rng(seed)
    calls = [call for scene in scenes for call in _candidates(policy, scene, everything, generator)]
    return [(call.primitive, call.parameters) for call in calls]


def _candidates(
    policy: PrimitivePolicy,
    seen: Observations,
    startable: NDArray[np.bool_],
    generator: np.random.Generator,
) -> list[PrimitiveCall]:
    found = list(islice(policy.candidates(seen, startable.copy(), generator), CANDIDATES))
    require(
        len(found) > 0,
        "candidates() yielded nothing: it must yield a call where a primitive can start",
    )
    for call in found:
        _check_call("candidates()", call)
    drawn = policy.draw(seen, startable.copy(), generator)
    _check_call("draw()", drawn)
    return [*found, drawn]


def _check_call(source: str, call: PrimitiveCall) -> None:
    require(
        isinstance(call, PrimitiveCall) and call.primitive in SPACE.names,
        f"{source} gave {call!r}: it must give PrimitiveCalls of {list(SPACE.names)}",
    )
    space = SPACE.parameter_spaces[SPACE.names.index(call.primitive)]
    subject = f"the parameters of {source} for {call.primitive!r}"
    require_array(call.parameters, (len(space),), np.floating, subject)
    inside = np.all(call.parameters >= space.low - 1e-6)
    inside &= np.all(call.parameters <= space.high + 1e-6)
    require(
        bool(inside),
        f"{subject} are {call.parameters}: they must be in their units, within {space.low} to "
        f"{space.high}",
    )


def fit_motor_policy(config: MotorPolicyConfig, context: TrainingContext) -> Sequence[Path]:
    """Train a policy on made-up rollouts and demonstrations, and return its checkpoints."""
    generator = np.random.default_rng(context.seed)
    demonstrations = [_demonstration(generator) for _ in range(DEMONSTRATIONS)]
    rollouts = [_demonstration(generator) for _ in range(DEMONSTRATIONS)]
    return config.fit(rollouts if config.pretrain else None, demonstrations, context)


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
