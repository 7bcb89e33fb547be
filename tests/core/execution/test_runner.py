"""Trials of a policy, with primitives and an environment that are done at once."""

from collections.abc import Callable, Sequence

import numpy as np
import pytest
from numpy.typing import NDArray

from prime_core.arrays import Array
from prime_core.contracts.calls import Parameter, ParameterSpace, PrimitiveCall
from prime_core.contracts.environment import ACTION_LIMIT
from prime_core.contracts.policy import Policy
from prime_core.contracts.primitive import Motion, Primitive
from prime_core.contracts.scene import Scene
from prime_core.execution.trial import run_trial

from ..point_mass import SOLVED_HEIGHT, PointMass

CEILING = SOLVED_HEIGHT + 0.1


class Rise(Primitive):
    """Goes to a height in steps of an action's length."""

    name = "rise"
    parameter_space = ParameterSpace((Parameter("z", "m", 0.0, 2.0),))
    maximum_steps = 50

    def can_start(self, scene: Scene) -> bool:
        return scene.gripper_position[2] < CEILING

    def propose(self, scene: Scene, generator: np.random.Generator) -> Array:
        return self.parameter_space.sample(generator)

    def reachable(self, scene: Scene, parameters: Array) -> bool:
        return bool(parameters[0] < CEILING)

    def motion(self, scene: Scene, parameters: Array) -> Motion:
        while scene.gripper_position[2] < parameters[0]:
            scene = yield np.array([0.0, 0.0, ACTION_LIMIT[2], 0.0, 0.0])

    def succeeded(self, scenes: Sequence[Scene], parameters: Array) -> bool:
        return bool(scenes[-1].gripper_position[2] >= parameters[0])


type Choice = Callable[[Scene, NDArray[np.bool_], Callable[[PrimitiveCall], bool]], PrimitiveCall]


class Chooses(Policy):
    """Calls what a function says."""

    def __init__(self, choice: Choice) -> None:
        self.choice = choice

    def act(
        self,
        scene: Scene,
        startable: NDArray[np.bool_],
        feasible: Callable[[PrimitiveCall], bool],
        generator: np.random.Generator,
    ) -> PrimitiveCall:
        return self.choice(scene, startable, feasible)


def asks(heights: Sequence[float], name: str = "rise") -> Policy:
    """Return a policy that calls the first of some heights that is feasible, or the last one."""
    calls = [PrimitiveCall(name, np.array([height])) for height in heights]
    return Chooses(lambda scene, startable, feasible: next(filter(feasible, calls), calls[-1]))


def test_a_policy_is_told_what_is_feasible() -> None:
    policy = asks([CEILING + 0.1, SOLVED_HEIGHT + 0.05])
    trial = run_trial(PointMass(), [Rise()], policy, np.random.default_rng(0), 100)
    assert trial.success
    assert [float(call.parameters[0]) for call in trial.calls] == [SOLVED_HEIGHT + 0.05]


def test_what_is_not_feasible_may_be_called_all_the_same() -> None:
    policy = asks([CEILING + 0.1])
    trial = run_trial(PointMass(), [Rise()], policy, np.random.default_rng(0), 100)
    assert trial.success
    assert trial.completed == (False,)  # It was stopped once the task was solved.


class Stay(Rise):
    """Does nothing."""

    name = "stay"

    def motion(self, scene: Scene, parameters: Array) -> Motion:
        return
        yield


def prefer_the_last(
    scene: Scene, startable: NDArray[np.bool_], feasible: Callable[[PrimitiveCall], bool]
) -> PrimitiveCall:
    name = ("rise", "stay")[int(np.flatnonzero(startable)[-1])]
    return PrimitiveCall(name, scene.gripper_position[2:] + 0.08)


def test_what_changed_nothing_is_not_offered_again_until_something_has_changed() -> None:
    policy = Chooses(prefer_the_last)
    trial = run_trial(PointMass(), [Rise(), Stay()], policy, np.random.default_rng(0), 100)
    assert trial.success
    assert [call.primitive for call in trial.calls] == ["stay", "rise", "stay", "rise"]


def test_what_changed_nothing_is_offered_where_there_is_nothing_else() -> None:
    trial = run_trial(PointMass(), [Stay()], asks([0.5], "stay"), np.random.default_rng(0), 5)
    assert [call.primitive for call in trial.calls] == ["stay"] * 5


class Totter(Rise):
    """Goes up and down again."""

    name = "totter"

    def motion(self, scene: Scene, parameters: Array) -> Motion:
        for way in (1.0, -1.0):
            yield np.array([0.0, 0.0, way * ACTION_LIMIT[2], 0.0, 0.0])


def test_what_failed_twice_with_things_as_they_are_is_not_feasible_any_more() -> None:
    policy = asks([0.5, 0.505, 0.55, 0.7], "totter")
    trial = run_trial(PointMass(), [Totter()], policy, np.random.default_rng(0), 12)
    heights = [float(call.parameters[0]) for call in trial.calls]
    # 0.505 is like 0.5; once all are worn out, the policy calls the last one all the same.
    assert heights == [0.5, 0.5, 0.55, 0.55, 0.7, 0.7]


@pytest.mark.parametrize("limit", [1, 3])
def test_a_primitive_that_ends_at_once_costs_a_step(limit: int) -> None:
    trial = run_trial(PointMass(), [Rise()], asks([0.5]), np.random.default_rng(0), limit)
    assert not trial.success
    assert (trial.steps, len(trial.calls)) == (limit, limit)
