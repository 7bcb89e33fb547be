"""Runs a policy over primitives in an environment, trial by trial."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from prime_core.contracts.calls import PrimitiveCall
from prime_core.contracts.environment import Environment
from prime_core.contracts.policy import Policy
from prime_core.contracts.primitive import Primitive
from prime_core.contracts.scene import Scene
from prime_core.execution.motions import OnStep, run_primitive
from prime_core.execution.repetition import CallHistory
from prime_core.rotations import wrap_angle

STILL = 0.01  # [m] that things and the gripper may be elsewhere and nothing has changed


STILL_TURN = 0.1  # [rad] that the gripper may have turned


@dataclass(frozen=True, eq=False)
class Trial:
    """One trial.

    Attributes:
        success: Whether the task was solved.
        steps: Motor actions done; a primitive that ends at once counts as one.
        calls: The primitive calls made.
        completed: For each call, whether the primitive did what it is for.
    """

    success: bool
    steps: int
    calls: tuple[PrimitiveCall, ...]
    completed: tuple[bool, ...]


def run_trial(
    environment: Environment,
    primitives: Sequence[Primitive],
    policy: Policy,
    generator: np.random.Generator,
    maximum_steps: int,
    on_step: OnStep | None = None,
) -> Trial:
    """Reset the environment and let the policy act until the task is solved.

    A primitive whose call changed nothing is not offered again until something has changed: the
    same scene would lead to much the same call, for ever. A call is feasible if the arm can do it
    and it was not made twice before with all things as they are (`CallHistory`).

    Args:
        environment: Where.
        primitives: What the policy chooses from, in the order of its primitive space.
        policy: Chooses.
        generator: Of all random draws, the first state's included.
        maximum_steps: Motor actions at most.
        on_step: Called after each step.

    Returns:
        What happened.
    """
    environment.reset(seed=int(generator.integers(2**31)))
    by_name = {item.name: item for item in primitives}
    calls: list[PrimitiveCall] = []
    completed: list[bool] = []
    steps, solved = 0, False
    idle: set[str] = set()
    history = CallHistory(by_name)
    while steps < maximum_steps and not solved:
        scene = environment.scene()
        startable = np.array([item.can_start(scene) for item in primitives])
        if not startable.any():
            break
        busy = startable & [item.name not in idle for item in primitives]
        startable = busy if busy.any() else startable
        feasible = partial(_is_feasible, by_name, history, scene)
        call = policy.act(scene, startable, feasible, generator)
        primitive = by_name[call.primitive]
        execution = run_primitive(
            environment,
            primitive,
            call.parameters,
            step_limit=maximum_steps - steps,
            stop_when_solved=True,
            on_step=on_step,
        )
        calls.append(call)
        history.add(scene, call)
        completed.append(primitive.succeeded(execution.scenes, call.parameters))
        solved = execution.solved
        if _has_changed(scene, execution.scenes[-1]):
            idle.clear()
        else:
            idle.add(call.primitive)
        # A primitive that ends at once still costs a step, or a policy could go on for ever.
        steps += max(execution.steps, 1)
    return Trial(solved, steps, tuple(calls), tuple(completed))


def _is_feasible(
    primitives: Mapping[str, Primitive], history: CallHistory, scene: Scene, call: PrimitiveCall
) -> bool:
    return not history.is_worn_out(scene, call) and primitives[call.primitive].reachable(
        scene, call.parameters
    )


def _has_changed(before: Scene, after: Scene) -> bool:
    """Whether something was taken or let go of, or the gripper or an object is elsewhere."""
    if before.held != after.held:
        return True
    moves = np.vstack(
        (
            after.object_positions - before.object_positions,
            after.gripper_position - before.gripper_position,
        )
    )
    turn = wrap_angle(after.gripper_yaw - before.gripper_yaw)
    return bool(np.linalg.norm(moves, axis=1).max() > STILL or abs(turn) > STILL_TURN)
