"""The contract of a primitive."""

from collections.abc import Callable, Generator
from dataclasses import dataclass, replace

import numpy as np

from prime_core.arrays import Floats
from prime_core.checks.requirement import CheckError, require, require_array, require_bool
from prime_core.contracts.calls import ParameterSpace
from prime_core.contracts.environment import ACTION_LIMIT, Environment
from prime_core.contracts.primitive import Primitive
from prime_core.contracts.scene import EMPTY_OPENING, Scene
from prime_core.errors import UnknownObjectsError
from prime_core.execution.motions import MotionRun

RESETS = 5
"""Resets tried until the primitive can start."""
PROPOSALS = 20
"""Parameter draws tried until one is reachable."""


@dataclass(frozen=True, eq=False)
class _Start:
    """Where motions are tried.

    Attributes:
        environment: Where.
        state: It starts in.
        held: What scenes say is held; None for the truth.
        blind: Whether scenes tell nothing of objects.
    """

    environment: Environment
    state: Floats
    held: str | None
    blind: bool = False

    def look(self) -> Scene:
        scene = self.environment.scene()
        if self.held is not None:
            scene = replace(scene, objects=replace(scene.known_objects, held=self.held))
        return _without_objects(scene) if self.blind else scene


@dataclass(frozen=True, eq=False)
class _Run:
    """A motion that was run."""

    scenes: list[Scene]
    actions: list[Floats]
    ended: bool


def check_primitive(
    primitive: Primitive,
    environment: Environment,
    prepare: Callable[[Environment], None] | None = None,
    seed: int = 0,
    draws: int = 3,
) -> None:
    """Check that a primitive keeps its contract; see `prime_core.contracts.primitive`.

    Where it cannot start after a reset, it is told that it holds an object, and checked so.

    Args:
        primitive: What to check.
        environment: Where it is run; its states must restore exactly.
        prepare: Called after each reset, to bring about a scene in which the primitive can
            start; None to leave the environment as it is.
        seed: Of resets and draws.
        draws: Parameter draws that are run, each of them twice.

    Raises:
        CheckError: If it breaks the contract.
    """
    require(
        isinstance(primitive, Primitive),
        f"{type(primitive).__name__} must be a subclass of prime_core.Primitive",
    )
    _check_attributes(primitive)
    start = _find_start(primitive, environment, prepare, seed)
    drawn = [_check_proposal(primitive, start, seed + number) for number in range(draws)]
    runs = [_run(primitive, start, parameters) for parameters in drawn]
    require(
        any(run.ended and run.actions for run in runs),
        f"none of {draws} motions of {primitive.name!r} acted and ended within maximum_steps = "
        f"{primitive.maximum_steps}: a motion must yield actions, and return when it is done",
    )
    for parameters, run in zip(drawn, runs, strict=True):
        again = _run(primitive, start, parameters)
        require(
            _same_actions(again, run),
            f"{primitive.name!r} acted otherwise when run again from the same scene with the same "
            "parameters: what a motion remembers belongs into its generator, not into the "
            "primitive, and it must not draw random numbers",
        )
        _check_without_objects(primitive, start, parameters, run)
        outcome = primitive.succeeded(run.scenes, parameters)
        require_bool(outcome, f"succeeded() of {primitive.name!r}")


def _check_attributes(primitive: Primitive) -> None:
    name = getattr(primitive, "name", None)
    require(isinstance(name, str) and bool(name), f"name is {name!r}: it must be a word")
    steps = getattr(primitive, "maximum_steps", None)
    require(
        isinstance(steps, int) and steps >= 1,
        f"maximum_steps of {name!r} is {steps!r}: it must be a whole number of motor actions, at "
        "least 1",
    )
    space = getattr(primitive, "parameter_space", None)
    if not isinstance(space, ParameterSpace):
        raise CheckError(f"parameter_space of {name!r} is {space!r}: it must be a ParameterSpace")
    names = [item.name for item in space.parameters]
    require(len(set(names)) == len(names), f"parameters are named {names}: names must differ")
    for item in space.parameters:
        subject = f"parameter {item.name!r} of {name!r}"
        bounds = np.isfinite([item.low, item.high]).all() and item.low < item.high
        require(
            bool(bounds),
            f"{subject} goes from {item.low} to {item.high}: bounds must be finite, low below high",
        )
        require(bool(item.unit), f"{subject} has no unit: name it, such as 'm' or 'rad'")
        require(
            item.period is None or item.period > 0,
            f"{subject} has period {item.period}: it must be above 0, or None",
        )


def _find_start(
    primitive: Primitive,
    environment: Environment,
    prepare: Callable[[Environment], None] | None,
    seed: int,
) -> _Start:
    objects = [item.name for item in environment.description.objects]
    for number in range(RESETS):
        environment.reset(seed=seed + number)
        if prepare is not None:
            prepare(environment)
        state = environment.get_state()
        for held in (None, *objects):
            start = _Start(environment, state, held)
            scene = start.look()
            before = _copy(scene)
            startable = primitive.can_start(scene)
            require_bool(startable, f"can_start() of {primitive.name!r}")
            _require_unchanged(primitive, "can_start()", scene, before)
            if startable:
                return start
    raise CheckError(
        f"{primitive.name!r} can start in none of {RESETS} scenes after a reset, nor with an "
        "object held: give check_primitive a `prepare` that brings about such a scene"
    )


def _check_proposal(primitive: Primitive, start: _Start, seed: int) -> Floats:
    """Return reachable parameters from the prior, checked."""
    start.environment.set_state(start.state)
    scene, space = start.look(), primitive.parameter_space
    before = _copy(scene)
    generators = np.random.default_rng(seed), np.random.default_rng(seed)
    subject = f"propose() of {primitive.name!r}"
    for _ in range(PROPOSALS):
        parameters, again = (primitive.propose(scene, generator) for generator in generators)
        require_array(parameters, (len(space),), np.floating, subject)
        require(
            np.array_equal(parameters, again),
            f"{subject} drew {parameters} and {again} with the same seed: all draws must come "
            "from the generator that it is given",
        )
        require(
            space.contains(parameters),
            f"{subject} drew {parameters}: it must stay within {space.low} to {space.high}",
        )
        reachable = primitive.reachable(scene, parameters)
        require_bool(reachable, f"reachable() of {primitive.name!r}")
        _require_unchanged(primitive, "propose() or reachable()", scene, before)
        if reachable:
            return parameters
    raise CheckError(
        f"reachable() of {primitive.name!r} refused {PROPOSALS} draws of propose(): the prior "
        "should draw what the arm can do"
    )


def _run(primitive: Primitive, start: _Start, parameters: Floats) -> _Run:
    start.environment.set_state(start.state)
    scenes, actions = [start.look()], list[Floats]()
    copies = [_copy(scenes[0])]
    given = parameters.copy()
    motion = MotionRun(primitive, scenes[0], given)
    require(
        isinstance(motion.motion, Generator),
        f"motion() of {primitive.name!r} returned a {type(motion.motion).__name__}: it must be a "
        "generator, so a function that yields",
    )
    while (action := motion.next_action(scenes[-1])) is not None:
        _check_action(primitive, action)
        actions.append(action.copy())
        start.environment.step(action.copy())
        scenes.append(start.look())
        copies.append(_copy(scenes[-1]))
    for scene, copy in zip(scenes, copies, strict=True):
        _require_unchanged(primitive, "motion()", scene, copy)
    kept = np.array_equal(given, parameters)
    require(kept, f"motion() of {primitive.name!r} changed its parameters: copy them first")
    return _Run(scenes, actions, motion.finished)


def _check_without_objects(
    primitive: Primitive, start: _Start, parameters: Floats, run: _Run
) -> None:
    """Check that all but the prior and the success criterion need no objects."""
    advice = "it may ask whether something is held (scene.holding), but not where objects are"
    start.environment.set_state(start.state)
    blind = replace(start, blind=True)
    scene, without = start.look(), blind.look()
    try:
        for name, same in (
            ("can_start()", primitive.can_start(without) == primitive.can_start(scene)),
            ("reachable()", primitive.reachable(without, parameters)),
            ("motion()", _same_actions(_run(primitive, blind, parameters), run)),
        ):
            require(
                bool(same),
                f"{name} of {primitive.name!r} does otherwise in scenes without objects: {advice}",
            )
    except UnknownObjectsError as problem:
        raise CheckError(
            f"{primitive.name!r} asks where objects are in can_start(), reachable() or motion(), "
            f"which must work in scenes without objects, too: {advice}"
        ) from problem


def _check_action(primitive: Primitive, action: Floats) -> None:
    subject = f"an action of {primitive.name!r}"
    require_array(action, (5,), np.floating, subject)
    require(
        bool(np.all(np.abs(action) <= ACTION_LIMIT + 1e-9)),
        f"{subject} is {action}: it must stay within ±{ACTION_LIMIT} (np.clip it)",
    )


def _same_actions(left: _Run, right: _Run) -> bool:
    return len(left.actions) == len(right.actions) and all(
        map(np.array_equal, left.actions, right.actions)
    )


def _without_objects(scene: Scene) -> Scene:
    """Return a scene that tells nothing of objects, with a gripper that tells what is held."""
    if not scene.holding:
        return replace(scene, objects=None, gripper_command=-1.0)
    opening = max(scene.gripper_opening, 2 * EMPTY_OPENING)
    return replace(scene, objects=None, gripper_command=1.0, gripper_opening=opening)


def _copy(scene: Scene) -> dict[str, Floats]:
    return {name: getattr(scene, name).copy() for name in _arrays(scene)}


def _arrays(scene: Scene) -> tuple[str, ...]:
    robot = ("gripper_position", "gripper_quaternion", "joint_positions")
    return robot if scene.objects is None else (*robot, "object_positions", "object_quaternions")


def _require_unchanged(
    primitive: Primitive, what: str, scene: Scene, before: dict[str, Floats]
) -> None:
    for key, value in before.items():
        require(
            np.array_equal(getattr(scene, key), value),
            f"{what} of {primitive.name!r} changed scene.{key}: scenes are shared, copy arrays "
            "before changing them",
        )
