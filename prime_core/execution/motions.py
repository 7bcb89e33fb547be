"""The loops that run primitives, and motor actions, in an environment."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from prime_core.arrays import Array
from prime_core.contracts.environment import ACTION_LIMIT, Action, Environment, Observation
from prime_core.contracts.primitive import Primitive
from prime_core.contracts.scene import Scene

OnStep = Callable[[Scene], None]
"""Called with the scene after each motor action."""


class MotionRun:
    """One motion of a primitive: scene in, motor action out.

    Args:
        primitive: What is run.
        scene: Where it starts.
        parameters: ``(P,)``, in the units of its parameter space.

    Attributes:
        motion: The primitive's generator.
        steps: Motor actions given so far.
        finished: Whether the motion came to its own end.
    """

    def __init__(self, primitive: Primitive, scene: Scene, parameters: Array) -> None:
        self.motion = primitive.motion(scene, parameters)
        self.steps = 0
        self.finished = False
        self._limit = primitive.maximum_steps

    def next_action(self, scene: Scene) -> Action | None:
        """Return the next motor action, ``(5,)``, or None where the motion is over.

        Args:
            scene: The scene now; at the first call the one where it starts.
        """
        if self.finished or self.steps >= self._limit:
            self.motion.close()
            return None
        try:
            action = self.motion.send(scene) if self.steps else next(self.motion)
        except StopIteration:
            self.finished = True
            return None
        self.steps += 1
        return action

    def close(self) -> None:
        """End the motion where it is."""
        self.motion.close()


@dataclass(frozen=True, eq=False)
class Execution:
    """What happened.

    Attributes:
        scenes: The scene at the start and after each motor action, ``N + 1`` of them.
        actions: The motor actions, ``(N, 5)``.
        finished: Whether the motion came to its own end.
    """

    scenes: list[Scene]
    actions: NDArray[np.float64]
    finished: bool

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
    gripper = last[4] if last is not None else (1.0 if scene.holding else -1.0)
    return np.array([0.0, 0.0, 0.0, 0.0, gripper])


def run_primitive(environment: Environment, primitive: Primitive, parameters: Array) -> Execution:
    """Run a primitive until its motion ends.

    Args:
        environment: Where; it is left in the state after the last step.
        primitive: What to run.
        parameters: ``(P,)``, in the units of its parameter space.

    Returns:
        What happened.
    """
    scenes: list[Scene] = [environment.scene()]
    actions: list[Action] = []
    run = MotionRun(primitive, scenes[0], parameters)
    try:
        while (action := run.next_action(scenes[-1])) is not None:
            step(environment, action)
            scenes.append(environment.scene())
            actions.append(action)
    finally:
        run.close()
    return Execution(scenes, _stack(actions), run.finished)


def run_actions(environment: Environment, actions: NDArray[np.floating]) -> Execution:
    """Do motor actions ``(N, 5)`` one after another; see `run_primitive`."""
    scenes, done = [environment.scene()], []
    for row in actions:
        action = np.asarray(row, dtype=np.float64)
        step(environment, action)
        scenes.append(environment.scene())
        done.append(action)
    return Execution(scenes, _stack(done), True)


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
        step(environment, action)
        scene = environment.scene()
        scenes.append(scene)
        actions.append(action)
        moved = np.abs(scene.object_positions - scenes[-2].object_positions).max(initial=0.0)
        moved = max(
            moved, float(np.abs(scene.gripper_position - scenes[-2].gripper_position).max())
        )
        if moved < 5e-4:  # metres a step, 1 cm/s
            return Execution(scenes, _stack(actions), True)
    return Execution(scenes, _stack(actions), False)


def step(environment: Environment, action: Action) -> tuple[Observation, bool]:
    """Do one motor action ``(5,)``, clipped to its limits.

    Returns:
        What the environment shows, and whether the task is solved.
    """
    clipped = np.minimum(np.maximum(action, -ACTION_LIMIT), ACTION_LIMIT)
    observation, _, solved, _, _ = environment.step(clipped)
    return observation, bool(solved)


def _stack(actions: list[Action]) -> NDArray[np.float64]:
    return np.array(actions, dtype=np.float64).reshape(-1, len(ACTION_LIMIT))
