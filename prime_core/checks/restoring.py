"""The contract of an environment's states: the same seed or state, the same future."""

from dataclasses import dataclass

import numpy as np

from prime_core.arrays import Floats
from prime_core.checks.requirement import CheckError, require, require_array
from prime_core.contracts.environment import ACTION_LIMIT, Environment, Observation
from prime_core.errors import PrimeError


@dataclass(frozen=True, eq=False)
class _Step:
    """What one step gave, and the state after it."""

    observation: Observation
    reward: float
    terminated: bool
    state: Floats


def _trace(environment: Environment, actions: Floats) -> list[_Step]:
    steps = []
    for action in actions:
        observation, reward, terminated, _, _ = environment.step(action)
        copied = {key: np.array(value) for key, value in observation.items()}
        state = environment.get_state().copy()
        steps.append(_Step(copied, float(reward), terminated, state))
        if terminated:
            break
    return steps


def _require_same(left: list[_Step], right: list[_Step], text: str) -> None:
    require(len(left) == len(right), text)
    for number, (one, two) in enumerate(zip(left, right, strict=True)):
        same = (
            np.array_equal(one.state, two.state)
            and one.reward == two.reward
            and one.observation.keys() == two.observation.keys()
            and all(
                np.array_equal(value, two.observation[key])
                for key, value in one.observation.items()
            )
        )
        require(same, f"{text}; they differ after {number + 1} steps")


def check_seeds(environment: Environment, actions: Floats, seed: int) -> None:
    """Check that a seed decides all that follows."""
    text = (
        f"reset(seed={seed}) led to two different episodes with the same actions: draw all "
        "random numbers from self.np_random, and reset everything that steps depend on"
    )
    runs = []
    for _ in range(2):
        environment.reset(seed=seed)
        states = [environment.get_state().copy()]
        steps = _trace(environment, actions)
        environment.reset()
        states.append(environment.get_state().copy())
        runs.append((states, steps))
    (states, steps), (states_again, steps_again) = runs
    require(np.array_equal(states[0], states_again[0]), text)
    _require_same(steps, steps_again, text)
    require(
        np.array_equal(states[1], states_again[1]),
        f"the reset() that follows reset(seed={seed}) led to two different states: it must go on "
        "with the generator that the seed made",
    )


def check_restoring(
    environment: Environment, restored: Environment, actions: Floats, seed: int
) -> None:
    """Check that a state of one instance, restored in another or the same, goes on alike."""
    where = "the same instance" if restored is environment else "another instance"
    advice = "get_state() must hold everything that the future depends on, unrounded"
    environment.reset(seed=seed)
    _trace(environment, actions[: len(actions) // 2])
    state = environment.get_state()
    require_array(state, (state.size,), np.float64, "get_state()")
    state, scene = state.copy(), environment.scene().observation()
    expected = _trace(environment, actions)
    restored.reset(seed=seed + 1)
    given = state.copy()
    restored.set_state(given)
    require(np.array_equal(given, state), "set_state() changed the array that it was given")
    require(
        np.array_equal(restored.get_state(), state),
        f"get_state() after set_state(state) in {where} is not that state: {advice}",
    )
    kept = all(
        np.array_equal(scene[key], value) for key, value in restored.scene().observation().items()
    )
    require(kept, f"scene() after set_state(state) in {where} is not the scene of that state")
    text = f"a state restored in {where} and stepped again led to another future: {advice}"
    _require_same(expected, _trace(restored, actions), text)
    require(np.array_equal(given, state), "step() changed the array that set_state() was given")


def check_clipping(environment: Environment, seed: int) -> None:
    """Check that actions are clipped."""
    futures = []
    environment.reset(seed=seed)
    state = environment.get_state().copy()
    for factor in (1.0, 10.0):
        action = factor * ACTION_LIMIT
        environment.set_state(state)
        futures.append(_trace(environment, action[None]))
    text = "an action ten times ACTION_LIMIT does not do what ACTION_LIMIT does: clip actions to it"
    _require_same(futures[0], futures[1], text)


def check_refusal(environment: Environment) -> None:
    """Check that a state of another environment is refused."""
    wrong = np.append(environment.get_state(), 0.0)
    try:
        environment.set_state(wrong)
    except PrimeError:
        return
    except Exception as problem:
        raise CheckError(
            f"set_state() raises {type(problem).__name__} for a state that is one number too "
            "long: it must raise a PrimeError that says what is wrong"
        ) from problem
    raise CheckError(
        "set_state() takes a state that is one number too long: it must raise a PrimeError"
    )
