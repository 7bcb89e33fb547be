"""The one loop that runs primitives, and motor actions, in an environment."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from prime_core.arrays import Array
from prime_core.contracts.environment import ACTION_LIMIT, Action, Environment
from prime_core.contracts.primitive import Primitive
from prime_core.contracts.scene import Scene

OnStep = Callable[[Scene], None]
"""Called with the scene after each motor action."""


@dataclass(frozen=True, eq=False)
class Execution:
    """What happened.

    Attributes:
        scenes: The scene at the start and after each motor action, ``N + 1`` of them.
        actions: The motor actions, ``(N, 5)``.
        finished: Whether the motion came to its own end.
        solved: Whether the task was solved after one of the steps, the last one if the
            execution was to stop there.
    """

    scenes: list[Scene]
    actions: NDArray[np.float64]
    finished: bool
    solved: bool

    @property
    def steps(self) -> int:
        """Motor actions done."""
        return len(self.actions)


def hold_action(scene: Scene, last: Action | None = None) -> Action:
    """Return the motor action that changes nothing.

    Args:
        scene: The scene as it is.
        last: The action before, whose gripper command is kept; without one, the gripper
            closes if it holds something, else it opens.

    Returns:
        ``(5,)``.
    """
    gripper = last[4] if last is not None else (1.0 if scene.held else -1.0)
    return np.array([0.0, 0.0, 0.0, 0.0, gripper])


def run_primitive(
    environment: Environment,
    primitive: Primitive,
    parameters: Array,
    *,
    step_limit: int | None = None,
    stop_when_solved: bool = False,
    on_step: OnStep | None = None,
) -> Execution:
    """Run a primitive until its motion ends.

    Args:
        environment: Where; it is left in the state after the last step.
        primitive: What to run.
        parameters: ``(P,)``, in the units of its parameter space.
        step_limit: Motor actions at most, besides the primitive's own limit.
        stop_when_solved: Whether to stop as soon as the task is solved.
        on_step: Called after each step.

    Returns:
        What happened.
    """
    limit = (
        primitive.maximum_steps if step_limit is None else min(step_limit, primitive.maximum_steps)
    )
    scene = environment.scene()
    scenes: list[Scene] = [scene]
    actions: list[Action] = []
    motion = primitive.motion(scene, parameters)
    finished = solved = False
    try:
        action = next(motion)
        while len(actions) < limit:
            scene, solved_now = _step(environment, action, on_step)
            scenes.append(scene)
            actions.append(action)
            solved = solved or solved_now
            if solved and stop_when_solved:
                break
            action = motion.send(scene)
    except StopIteration:
        finished = True
    finally:
        motion.close()
    return Execution(scenes, _stack(actions), finished, solved)


def run_actions(
    environment: Environment,
    actions: NDArray[np.floating],
    *,
    stop_when_solved: bool = False,
    on_step: OnStep | None = None,
) -> Execution:
    """Do motor actions ``(N, 5)`` one after another; see `run_primitive`."""
    scenes, done = [environment.scene()], []
    solved = False
    for row in actions:
        action = np.asarray(row, dtype=np.float64)
        scene, solved_now = _step(environment, action, on_step)
        scenes.append(scene)
        done.append(action)
        solved = solved or solved_now
        if solved and stop_when_solved:
            break
    return Execution(scenes, _stack(done), len(done) == len(actions), solved)


def settle(
    environment: Environment, last: Action | None = None, *, step_limit: int = 40
) -> Execution:
    """Hold still until no object moves: a primitive that starts earlier judges a falling object.

    Args:
        environment: Where.
        last: The action before, whose gripper command is kept.
        step_limit: Motor actions at most.

    Returns:
        What happened; ``finished`` says whether the objects came to rest.
    """
    scenes, actions = [environment.scene()], []
    for _ in range(step_limit):
        action = hold_action(scenes[-1], last)
        scene, _ = _step(environment, action, None)
        scenes.append(scene)
        actions.append(action)
        moved = np.abs(scene.object_positions - scenes[-2].object_positions).max(initial=0.0)
        moved = max(
            moved, float(np.abs(scene.gripper_position - scenes[-2].gripper_position).max())
        )
        if moved < 5e-4:  # metres a step, 1 cm/s
            return Execution(scenes, _stack(actions), True, False)
    return Execution(scenes, _stack(actions), False, False)


def _step(environment: Environment, action: Action, on_step: OnStep | None) -> tuple[Scene, bool]:
    clipped = np.minimum(np.maximum(action, -ACTION_LIMIT), ACTION_LIMIT)
    _, _, solved, _, _ = environment.step(clipped)
    scene = environment.scene()
    if on_step is not None:
        on_step(scene)
    return scene, bool(solved)


def _stack(actions: list[Action]) -> NDArray[np.float64]:
    return np.array(actions, dtype=np.float64).reshape(-1, len(ACTION_LIMIT))
