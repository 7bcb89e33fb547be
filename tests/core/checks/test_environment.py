"""Every way to break the contract of an environment is found, and named."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import gymnasium
import numpy as np
import pytest

from prime_core.arrays import Floats
from prime_core.checks import CheckError, check_environment
from prime_core.checks.samples import DESCRIPTION
from prime_core.contracts.description import Affordance, SceneDescription
from prime_core.contracts.environment import Action, Environment, Observation
from prime_core.contracts.scene import Scene

from ..point_mass import PointMass


def test_an_environment_that_keeps_the_contract_passes() -> None:
    check_environment(PointMass(), other=PointMass())


def described(**changes: Any) -> PointMass:
    return PointMass(SceneDescription(**(vars(DESCRIPTION) | changes)))


class WrongActionSpace(PointMass):
    def __init__(self) -> None:
        super().__init__()
        self.action_space = gymnasium.spaces.Box(-1.0, 1.0, (5,), np.float64)


class WrongObservationSpace(PointMass):
    def __init__(self) -> None:
        super().__init__()
        self.observation_space = gymnasium.spaces.Dict(
            {"state": gymnasium.spaces.Box(-1.0, 1.0, (15,), np.float32)}
        )


class LeavesOutObjects(PointMass):
    def observe(self) -> Observation:
        return {"observation.state": super().observe()["observation.state"]}


class ObservesDoubles(PointMass):
    def observe(self) -> Observation:
        return {key: value.astype(np.float64) for key, value in super().observe().items()}


class ObservesNoise(PointMass):
    def observe(self) -> Observation:
        return {key: value + np.float32(0.01) for key, value in super().observe().items()}


class IgnoresSeed(PointMass):
    def reset(self, **arguments: Any) -> tuple[Observation, dict[str, Any]]:
        _, info = super().reset(**arguments)
        self.values[5] = np.random.default_rng().random()
        return self.observe(), info


class SeedsAfresh(PointMass):
    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        self.np_random = np.random.default_rng(seed)
        _, info = super().reset(seed=seed)
        if seed is None:
            self.values[5] = np.random.default_rng().random()
        return self.observe(), info


class ForgetsVelocity(PointMass):
    velocity: Floats = np.zeros(3)

    def step(self, action: Action) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        self.velocity = 0.5 * self.velocity + 0.1 * action[:3]
        return super().step(np.hstack((self.velocity, action[3:])))

    def reset(self, **arguments: Any) -> tuple[Observation, dict[str, Any]]:
        self.velocity = np.zeros(3)
        return super().reset(**arguments)


class RoundsState(PointMass):
    def get_state(self) -> Floats:
        return self.values.astype(np.float32).astype(np.float64)


class SharesState(PointMass):
    def get_state(self) -> Floats:
        return self.values


class SharesScene(PointMass):
    def scene(self) -> Scene:
        return replace(super().scene(), gripper_position=self.values[:3])


class TakesAnyState(PointMass):
    def set_state(self, state: Floats) -> None:
        self.values = state[:11].copy()


class RaisesValueError(PointMass):
    def set_state(self, state: Floats) -> None:
        if state.shape != (11,):
            raise ValueError("wrong")
        super().set_state(state)


class ChangesStep(PointMass):
    """Steps well, then changes what `change` says."""

    def __init__(self, change: Callable[[list[Any]], None]) -> None:
        super().__init__()
        self.change = change

    def step(self, action: Action) -> Any:
        answer: list[Any] = list(super().step(action))
        self.change(answer)
        return tuple(answer)


class NeverClips(PointMass):
    def step(self, action: Action) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        self.values[:3] += action[:3]
        return super().step(np.zeros(5))


class ChangesAction(PointMass):
    def step(self, action: Action) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        answer = super().step(action)
        action *= 0.5
        return answer


class LongQuaternion(PointMass):
    def scene(self) -> Scene:
        return replace(super().scene(), gripper_quaternion=np.array([1.0, 1.0, 0.0, 0.0]))


class HoldsNothingKnown(PointMass):
    def scene(self) -> Scene:
        scene = super().scene()
        return replace(scene, objects=replace(scene.known_objects, held="spoon"))


class NotANumber(PointMass):
    def scene(self) -> Scene:
        return replace(super().scene(), joint_positions=np.full(7, np.nan))


def set_item(index: int, value: Any) -> Callable[[list[Any]], None]:
    def change(answer: list[Any]) -> None:
        answer[index] = value

    return change


def affords(**changes: Any) -> PointMass:
    values = {"action": "grasp", "reference": "cube", "low": (0.0,) * 3, "high": (0.1,) * 3}
    return described(affordances=(Affordance(**(values | changes)),))


BROKEN_ENVIRONMENTS = [
    (
        lambda: described(workspace_low=(0.4, 0.0, 0.0)),
        r"workspace goes from .* above that of high",
    ),
    (lambda: described(objects=DESCRIPTION.objects[:1] * 2), r"'cube', 'cube'.* names must differ"),
    (lambda: affords(reference="spoon"), r"refers to an object that is not there.*'cube', 'plate'"),
    (lambda: affords(low=(0.2, 0.0, 0.0)), r"affordance 'grasp' of 'cube' goes from .* above"),
    (lambda: affords(yaws=()), r"has no yaws: use None"),
    (lambda: affords(action=""), r"has no action: name one"),
    (WrongActionSpace, r"action_space is Box.*must be gymnasium\.spaces\.Box\(-ACTION_LIMIT"),
    (WrongObservationSpace, r"not in observation_space: keys, shapes, dtypes"),
    (LeavesOutObjects, r"no 'observation\.environment_state'; it gives \['observation\.state'\]"),
    (ObservesDoubles, r"float64: it must be a numpy array \(15,\) of float32"),
    (ObservesNoise, r"differs from scene\(\)\.observation\(\)"),
    (IgnoresSeed, r"reset\(seed=0\) led to two different episodes.*self\.np_random"),
    (SeedsAfresh, r"reset\(\) that follows reset\(seed=0\).*go on with the generator"),
    (ForgetsVelocity, r"restored in the same instance and stepped again.*differ after 1 steps"),
    (RoundsState, r"stepped again led to another future.*unrounded"),
    (SharesState, r"get_state\(\) must return a copy"),
    (SharesScene, r"scene\(\) must copy its arrays"),
    (TakesAnyState, r"takes a state that is one number too long: it must raise a PrimeError"),
    (RaisesValueError, r"raises ValueError for a state that is one number too long"),
    (NeverClips, r"ten times ACTION_LIMIT.*clip actions"),
    (ChangesAction, r"step\(\) changed the action"),
    (LongQuaternion, r"scene\(\)\.gripper_quaternion has length 1\.4.*must have length 1"),
    (HoldsNothingKnown, r"held is 'spoon': it must be None or one of \['cube', 'plate'\]"),
    (NotANumber, r"scene\(\)\.joint_positions holds \[nan.*must be finite"),
    (lambda: ChangesStep(set_item(1, -1.0)), r"reward is -1\.0 where is_success\(\) is False"),
    (lambda: ChangesStep(set_item(2, True)), r"terminated is True where is_success\(\) is False"),
    (lambda: ChangesStep(set_item(2, np.False_)), r"terminated is .*put bool\(\.\.\.\) around it"),
    (lambda: ChangesStep(set_item(4, {})), r'info\["is_success"\] is None where'),
    (
        lambda: ChangesStep(list.pop),
        r"must return observation, reward, terminated, truncated, info",
    ),
]


@pytest.mark.parametrize(("make", "text"), BROKEN_ENVIRONMENTS)
def test_a_broken_environment_is_told_what_would_be_right(
    make: Callable[[], Environment], text: str
) -> None:
    with pytest.raises(CheckError, match=text):
        check_environment(make())


def test_a_state_that_fits_one_instance_only_is_found() -> None:
    class Private(PointMass):
        def __init__(self) -> None:
            super().__init__()
            self.drift = np.random.default_rng().random()

        def step(self, action: Action) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
            self.values[0] += self.drift
            return super().step(action)

    check_environment(environment := Private())
    with pytest.raises(CheckError, match=r"restored in another instance and stepped again"):
        check_environment(environment, other=Private())


def test_what_is_no_environment_is_told_so() -> None:
    nothing: Any = object()
    with pytest.raises(CheckError, match=r"object must be a subclass of .*\.Environment"):
        check_environment(nothing)
