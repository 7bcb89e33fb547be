"""Executes parsed primitive sequences from the demonstrations' first states."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from prime_core.contracts.calls import OTHER
from prime_core.contracts.demonstration import ParsedDemonstration
from prime_core.contracts.environment import Environment
from prime_core.contracts.primitive import Primitive
from prime_core.errors import PrimeError
from prime_core.execution.motions import hold_action, run_actions, run_primitive

REST_STEPS = 20
"""Motor actions at most that the gripper holds still for after the last primitive: a second."""


@dataclass(frozen=True)
class Replay:
    """How the replay of one demonstration ended.

    Attributes:
        success: Whether the task was solved.
        steps: Motor actions done.
        completed: For each primitive that was run, whether it did what it is for.
    """

    success: bool
    steps: int
    completed: tuple[bool, ...]


def replay_demonstration(
    environment: Environment,
    primitives: Sequence[Primitive],
    parsed: ParsedDemonstration,
    *,
    replay_other: bool,
) -> Replay:
    """Execute a parsed demonstration until the task is solved or the sequence is done.

    Args:
        environment: Where.
        primitives: What the segments name.
        parsed: What to execute.
        replay_other: Whether segments that no primitive explains replay their recorded motor
            actions; else they are skipped.

    Returns:
        How it ended.

    Raises:
        PrimeError: If the demonstration has no simulator states to start from.
    """
    states = parsed.demonstration.simulator_states
    if states is None:
        raise PrimeError(
            "the demonstration holds no simulator states (feature 'simulator_state'): it can "
            "be parsed, but not replayed from its first state"
        )
    environment.reset(seed=0)
    environment.set_state(states[0])
    by_name = {item.name: item for item in primitives}
    steps, completed, last = 0, [], None
    for segment in parsed.segments:
        if segment.call.primitive == OTHER:
            if not replay_other:
                continue
            actions = parsed.demonstration.actions[segment.start : segment.end]
            execution = run_actions(environment, actions, stop_when_solved=True)
        else:
            primitive = by_name[segment.call.primitive]
            parameters = segment.call.parameters
            execution = run_primitive(environment, primitive, parameters, stop_when_solved=True)
            completed.append(primitive.succeeded(execution.scenes, parameters))
        steps += execution.steps
        if execution.solved:
            return Replay(True, steps, tuple(completed))
        if execution.steps:
            last = execution.actions[-1]
    # An object that was let go of may still fall or rock.
    hold = np.tile(hold_action(environment.scene(), last), (REST_STEPS, 1))
    rest = run_actions(environment, hold, stop_when_solved=True)
    return Replay(environment.is_success(), steps + rest.steps, tuple(completed))
