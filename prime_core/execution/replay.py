"""Executes parsed primitive sequences from the demonstrations' first states."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from prime_core.contracts.calls import OTHER
from prime_core.contracts.demonstration import ParsedDemonstration
from prime_core.contracts.description import SceneDescription
from prime_core.contracts.environment import Action, Environment
from prime_core.contracts.observations import Observations
from prime_core.contracts.primitive import Primitive
from prime_core.contracts.scene import Scene
from prime_core.errors import PrimeError
from prime_core.execution.motions import hold_action
from prime_core.execution.runner import Run, SceneRunner
from prime_core.execution.trial import completed_calls, run_policy

REST_STEPS = 20
"""Motor actions at most that the gripper holds still for after the last primitive: a second, in
which an object that was let go of may still fall or rock."""


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


class ActionsRun:
    """Gives recorded motor actions ``(N, 5)`` one after another."""

    def __init__(self, actions: Sequence[Action]) -> None:
        self._actions = iter(actions)

    def next_action(self, scene: Scene) -> Action | None:
        """Return the next motor action, or None where there is none left."""
        return next(self._actions, None)


class SequenceRunner(SceneRunner):
    """Runs the segments of a parsed demonstration one after another, then holds still.

    Args:
        description: Of the scenes.
        primitives: What the segments name.
        parsed: What to execute.
        replay_other: Whether segments that no primitive explains replay their recorded motor
            actions; else they are skipped.
    """

    def __init__(
        self,
        description: SceneDescription,
        primitives: Sequence[Primitive],
        parsed: ParsedDemonstration,
        *,
        replay_other: bool,
    ) -> None:
        super().__init__(description)
        self._primitives = {item.name: item for item in primitives}
        self._actions = parsed.demonstration.actions.astype(np.float64)
        self._chosen = [
            segment
            for segment in parsed.segments
            if replay_other or segment.call.primitive != OTHER
        ]
        self._segments = iter(self._chosen)
        self._rests = False

    def reset(self, generator: np.random.Generator) -> None:
        """Begin with the first segment again; see `MotorPolicy`."""
        super().reset(generator)
        self._segments = iter(self._chosen)
        self._rests = False

    def next_run(self, scene: Scene, seen: Observations) -> Run | None:
        """Return the run of the next segment; in the end one that holds still, once."""
        segment = next(self._segments, None)
        if segment is None:
            if self._rests:
                return None
            self._rests = True
            return ActionsRun([hold_action(scene, self._last)] * REST_STEPS)
        if segment.call.primitive == OTHER:
            return ActionsRun(list(self._actions[segment.start : segment.end]))
        return self.start(segment.call, self._primitives[segment.call.primitive], scene)


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
        replay_other: See `SequenceRunner`.

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
    runner = SequenceRunner(environment.description, primitives, parsed, replay_other=replay_other)
    limits = [item.maximum_steps for item in primitives] + [parsed.demonstration.steps]
    most = sum(max(limits) for _ in parsed.segments) + REST_STEPS
    solved, scenes = run_policy(environment, runner, environment.scene().observation(), most)
    completed = completed_calls(runner.records, scenes, {item.name: item for item in primitives})
    return Replay(solved, len(scenes) - 1, completed)
