"""Runs a policy in an environment, trial by trial."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from prime_core.contracts.calls import PrimitiveCall
from prime_core.contracts.environment import Environment, Observation
from prime_core.contracts.observations import Observations
from prime_core.contracts.policy import MotorPolicy
from prime_core.contracts.primitive import Primitive
from prime_core.contracts.scene import Scene
from prime_core.execution.live_images import with_live_images
from prime_core.execution.motions import OnStep, step
from prime_core.execution.runner import CallRecord, SceneRunner


@dataclass(frozen=True, eq=False)
class Trial:
    """One trial.

    Attributes:
        success: Whether the task was solved.
        steps: Motor actions done.
        calls: The primitive calls made; a policy of motor actions makes none.
        completed: For each call, whether the primitive did what it is for.
    """

    success: bool
    steps: int
    calls: tuple[PrimitiveCall, ...] = ()
    completed: tuple[bool, ...] = ()


def run_trial(
    environment: Environment,
    primitives: Sequence[Primitive],
    policy: MotorPolicy,
    generator: np.random.Generator,
    maximum_steps: int,
    on_step: OnStep | None = None,
) -> Trial:
    """Reset the environment and let the policy act until the task is solved.

    Args:
        environment: Where.
        primitives: What calls name; judges whether calls did what they are for.
        policy: Acts. A runner's calls are recorded.
        generator: Of all random draws, the first state's included.
        maximum_steps: Motor actions at most.
        on_step: Called after each step.

    Returns:
        What happened.
    """
    observation, _ = environment.reset(seed=int(generator.integers(2**31)))
    policy.reset(generator)
    solved, scenes = run_policy(environment, policy, observation, maximum_steps, on_step)
    records = policy.records if isinstance(policy, SceneRunner) else []
    return Trial(
        success=solved,
        steps=len(scenes) - 1,
        calls=tuple(record.call for record in records),
        completed=completed_calls(records, scenes, {item.name: item for item in primitives}),
    )


def run_policy(
    environment: Environment,
    policy: MotorPolicy,
    observation: Observation,
    maximum_steps: int,
    on_step: OnStep | None = None,
) -> tuple[bool, list[Scene]]:
    """Let a policy act until the task is solved, it gives up, or its steps are used up.

    Args:
        environment: Where; in the state that it starts from.
        policy: Acts; it was reset.
        observation: What the environment shows now.
        maximum_steps: Motor actions at most.
        on_step: Called after each step.

    Returns:
        Whether the task was solved, and the scenes at the start and after each step.
    """
    scenes, solved = [environment.scene()], False
    while len(scenes) <= maximum_steps and not solved:
        seen = Observations.single(observation)
        if policy.cameras is not None:
            seen = with_live_images(seen, environment, policy.cameras)
        action = policy.act(seen.only(policy.sees))
        if action is None:
            break
        observation, solved = step(environment, action)
        scenes.append(environment.scene())
        if on_step is not None:
            on_step(scenes[-1])
    return solved, scenes


def completed_calls(
    records: Sequence[CallRecord], scenes: Sequence[Scene], primitives: Mapping[str, Primitive]
) -> tuple[bool, ...]:
    """Return for each call whether the primitive did what it is for.

    Args:
        records: The calls.
        scenes: With all objects, at the start of the episode and after each step.
        primitives: By their names.
    """
    return tuple(
        bool(
            primitives[record.call.primitive].succeeded(
                scenes[record.start : record.end + 1], record.call.parameters
            )
        )
        for record in records
    )
