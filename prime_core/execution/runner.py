"""Runs primitives as a motor policy: scene in, motor action out."""

from abc import abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from prime_core.contracts.calls import PrimitiveCall
from prime_core.contracts.description import SceneDescription
from prime_core.contracts.environment import Action
from prime_core.contracts.observations import Observations
from prime_core.contracts.policy import MotorPolicy, PrimitivePolicy
from prime_core.contracts.primitive import Primitive
from prime_core.contracts.scene import Scene
from prime_core.execution.motions import MotionRun, hold_action
from prime_core.execution.repetition import CallHistory, has_changed
from prime_core.execution.settings import RunnerConfig
from prime_core.execution.turned_calls import calls_at_any_yaw, calls_at_good_yaws

Ending = Literal["finished", "at once", "step limit"]
"""Why a call ended: its motion came to its own end, did so before it moved, or was as long as it
may be."""


@dataclass(frozen=True, eq=False)
class CallRecord:
    """A primitive call that was made.

    Attributes:
        call: The call.
        start: Motor actions of the episode before it.
        end: Motor actions of the episode when it ended.
        ending: Why it ended; None while it runs.
        feasible: Whether it was taken for one that can be done; else nothing that the policy
            offered was.
    """

    call: PrimitiveCall
    start: int
    end: int
    ending: Ending | None = None
    feasible: bool = True


class Run(Protocol):
    """Something that gives motor actions until it is over."""

    def next_action(self, scene: Scene) -> Action | None:
        """Return the next motor action, or None where it is over."""


class SceneRunner(MotorPolicy):
    """Gives the motor actions of one run after another, and records the calls.

    Args:
        description: Of the scenes.

    Attributes:
        records: The calls of the episode so far.
    """

    def __init__(self, description: SceneDescription) -> None:
        self.records: list[CallRecord] = []
        self._description = description
        self._run: Run | None = None
        self._steps = 0
        self._last: Action | None = None
        self._opening: float | None = None

    def reset(self, generator: np.random.Generator) -> None:
        """Forget the episode before; see `MotorPolicy`."""
        self.records = []
        self._run, self._steps, self._last, self._opening = None, 0, None, None

    def act(self, seen: Observations) -> Action | None:
        """Return the next motor action; see `MotorPolicy`.

        A run that ends at once costs a step of holding still, or a policy could go on for ever
        within one step.
        """
        command = None if self._last is None else float(self._last[4])
        scene = Scene.read(self._description, seen.only(self.sees), command, self._opening)
        self._opening = scene.gripper_opening
        action = None if self._run is None else self._run.next_action(scene)
        if action is None:
            if self._run is not None:
                self._note_ending(self._run)
                self.ended(scene)
            self._run = self.next_run(scene, seen.only(self.sees))
            if self._run is None:
                return None
            action = self._run.next_action(scene)
        if action is None:
            action = hold_action(scene, self._last)
        self._steps += 1
        if isinstance(self._run, MotionRun):
            self.records[-1] = replace(self.records[-1], end=self._steps)
        self._last = action
        return action

    @abstractmethod
    def next_run(self, scene: Scene, seen: Observations) -> Run | None:
        """Return what to do next, or None to give up."""

    def start(
        self, call: PrimitiveCall, primitive: Primitive, scene: Scene, *, feasible: bool = True
    ) -> MotionRun:
        """Record a call and return the run of its motion."""
        self.records.append(CallRecord(call, self._steps, self._steps, feasible=feasible))
        return MotionRun(primitive, scene, call.parameters)

    def _note_ending(self, run: Run) -> None:
        if isinstance(run, MotionRun):
            own: Ending = "finished" if run.steps else "at once"
            ending = own if run.finished else "step limit"
            self.records[-1] = replace(self.records[-1], ending=ending)

    def ended(self, scene: Scene) -> None:
        """Be told of the scene after a run; by default nothing is done."""


class PrimitiveRunner(SceneRunner):
    """Makes the calls of a policy over primitives.

    Scenes are made of what the policy sees, and of nothing else: no object pose reaches a policy
    of images, nor whether its calls can start, are reachable or were made before.

    Args:
        policy: Yields candidates for the next call.
        primitives: In the order of its primitive space.
        description: Of the scenes.
        config: What is added to the paper.
    """

    def __init__(
        self,
        policy: PrimitivePolicy,
        primitives: Sequence[Primitive],
        description: SceneDescription,
        config: RunnerConfig,
    ) -> None:
        super().__init__(description)
        self.sees, self.cameras = policy.sees, policy.cameras
        self._policy = policy
        self._primitives = {item.name: item for item in primitives}
        self._config = config
        self._generator: np.random.Generator | None = None
        self._history = CallHistory(self._primitives)
        self._without_effect: set[str] = set()
        self._called_from: Scene | None = None

    def reset(self, generator: np.random.Generator) -> None:
        """Forget the episode before; see `MotorPolicy`."""
        super().reset(generator)
        self._generator = generator
        self._history = CallHistory(self._primitives)
        self._without_effect = set()
        self._called_from = None

    def next_run(self, scene: Scene, seen: Observations) -> MotionRun | None:
        """Choose a call; None where no primitive can start."""
        assert self._generator is not None, "reset() comes before the first action"
        startable = self._startable(scene)
        if not startable.any():
            return None
        call, feasible = self._choose(scene, self._candidates(seen, startable, self._generator))
        self._history.add(scene, call)
        self._called_from = scene
        return self.start(call, self._primitives[call.primitive], scene, feasible=feasible)

    def ended(self, scene: Scene) -> None:
        """Remember whether the call changed something."""
        assert self._called_from is not None, "a run has begun"
        if has_changed(self._called_from, scene):
            self._without_effect.clear()
        else:
            self._without_effect.add(self.records[-1].call.primitive)

    def _startable(self, scene: Scene) -> NDArray[np.bool_]:
        able = [bool(item.can_start(scene)) for item in self._primitives.values()]
        startable = np.array(able, dtype=np.bool_)
        if not self._config.leave_out_without_effect:
            return startable
        effective = startable & np.array(
            [name not in self._without_effect for name in self._primitives], dtype=np.bool_
        )
        return effective if effective.any() else startable

    def _candidates(
        self, seen: Observations, startable: NDArray[np.bool_], generator: np.random.Generator
    ) -> Iterator[PrimitiveCall]:
        """Yield what the policy would do, the call to make first."""
        if not self._config.likeliest_first:
            yield self._policy.draw(seen, startable, generator)
        yield from self._policy.candidates(seen, startable, generator)

    def _choose(
        self, scene: Scene, candidates: Iterator[PrimitiveCall]
    ) -> tuple[PrimitiveCall, bool]:
        """Return the first candidate that is feasible, else the first of all, and whether it is."""
        first: PrimitiveCall | None = None
        met: set[str] = set()
        for candidate in candidates:
            first = first or candidate
            for call in self._variants(candidate, scene, candidate.primitive not in met):
                if self._is_feasible(scene, call):
                    return call, True
            met.add(candidate.primitive)
        assert first is not None, "a policy yields a candidate where a primitive can start"
        return first, False

    def _variants(
        self, call: PrimitiveCall, scene: Scene, likeliest: bool
    ) -> Iterator[PrimitiveCall]:
        """Yield a call, then the same turned.

        The likeliest call of a primitive is tried at any yaw, others at their objects' good ones:
        another candidate is better than a call turned away from what was meant.
        """
        yield call
        if self._config.turn_unreachable:
            space = self._primitives[call.primitive].parameter_space
            yield from calls_at_good_yaws(call, space, scene)
            if likeliest:
                yield from calls_at_any_yaw(call, space)

    def _is_feasible(self, scene: Scene, call: PrimitiveCall) -> bool:
        repeats = self._config.repeats
        if repeats is not None and self._history.count(scene, call) >= repeats:
            return False
        primitive = self._primitives[call.primitive]
        return not self._config.leave_out_unreachable or primitive.reachable(scene, call.parameters)
