"""The contract of an environment."""

from typing import Any

import gymnasium
import numpy as np

from prime_core.arrays import Floats
from prime_core.checks.requirement import require, require_array, require_bool
from prime_core.checks.restoring import (
    check_clipping,
    check_refusal,
    check_restoring,
    check_seeds,
)
from prime_core.checks.scene import check_description, check_scene
from prime_core.contracts.environment import ACTION_LIMIT, Environment


def check_environment(
    environment: Environment, other: Environment | None = None, seed: int = 0, steps: int = 20
) -> None:
    """Check that an environment keeps its contract; see `prime_core.contracts.environment`.

    Args:
        environment: What to check; it is reset and stepped.
        other: A second instance of the same settings, to restore states in; None leaves that
            part out.
        seed: Of resets and actions.
        steps: Random motor actions of each trial.

    Raises:
        CheckError: If it breaks the contract.
    """
    require(
        isinstance(environment, Environment),
        f"{type(environment).__name__} must be a subclass of prime_core.Environment",
    )
    check_description(environment.description)
    _check_spaces(environment)
    actions = np.random.default_rng(seed).uniform(-ACTION_LIMIT, ACTION_LIMIT, (steps, 5))
    _check_steps(environment, actions, seed)
    check_seeds(environment, actions, seed)
    check_restoring(environment, environment, actions, seed)
    if other is not None:
        check_restoring(environment, other, actions, seed)
    check_clipping(environment, seed)
    check_refusal(environment)


def _check_spaces(environment: Environment) -> None:
    space: Any = environment.action_space
    fits = isinstance(space, gymnasium.spaces.Box) and space.shape == (5,)
    if fits:
        fits = np.allclose(space.low, -ACTION_LIMIT) and np.allclose(space.high, ACTION_LIMIT)
    require(
        fits,
        f"action_space is {space}: it must be gymnasium.spaces.Box(-ACTION_LIMIT, ACTION_LIMIT), "
        "shape (5,), see prime_core.contracts.environment",
    )
    require(
        isinstance(environment.observation_space, gymnasium.spaces.Dict),
        f"observation_space is {environment.observation_space}: it must be a "
        "gymnasium.spaces.Dict with LeRobot's keys",
    )


def _check_observation(environment: Environment, observation: Any, source: str) -> None:
    scene = environment.scene()
    check_scene(scene, environment.description)
    require(isinstance(observation, dict), f"{source} must give an observation dictionary")
    for key, expected in scene.observation().items():
        require(key in observation, f"{source} gives no {key!r}; it gives {sorted(observation)}")
        require_array(observation[key], expected.shape, np.float32, f"{key!r} of {source}")
        require(
            np.array_equal(observation[key], expected),
            f"{key!r} of {source} differs from scene().observation(): both must tell of the "
            "same instant, so return scene().observation() and add images to it",
        )
    require(
        environment.observation_space.contains(observation),
        f"the observation of {source} is not in observation_space: keys, shapes, dtypes and "
        "bounds must agree",
    )


def _check_steps(environment: Environment, actions: Floats, seed: int) -> None:
    """Check what reset and step return, and that earlier answers stay as they were."""
    result: Any = environment.reset(seed=seed)
    require(
        isinstance(result, tuple) and len(result) == 2 and isinstance(result[1], dict),
        "reset() must return an observation and an info dictionary",
    )
    _check_observation(environment, result[0], "reset()")
    for action in actions:
        scene, state = environment.scene(), environment.get_state()
        before, state_before = scene.observation(), state.copy()
        given = action.copy()
        result = environment.step(given)
        require(np.array_equal(given, action), "step() changed the action that it was given")
        kept = all(np.array_equal(before[key], value) for key, value in scene.observation().items())
        require(kept, "step() changed an earlier scene: scene() must copy its arrays")
        require(
            np.array_equal(state, state_before),
            "step() changed an earlier state: get_state() must return a copy",
        )
        _check_outcome(environment, result)
        if result[2]:
            break


def _check_outcome(environment: Environment, result: Any) -> None:
    require(
        isinstance(result, tuple) and len(result) == 5,
        "step() must return observation, reward, terminated, truncated, info",
    )
    observation, reward, terminated, truncated, info = result
    _check_observation(environment, observation, "step()")
    success = environment.is_success()
    require_bool(success, "is_success()")
    require_bool(terminated, "terminated")
    require_bool(truncated, "truncated")
    require(
        float(reward) == float(success),
        f"the reward is {reward} where is_success() is {success}: it must be 1 while the task "
        "is solved, else 0",
    )
    require(
        terminated == success,
        f"terminated is {terminated} where is_success() is {success}: an episode must terminate "
        "when the task is solved, and then only",
    )
    require(
        "is_success" in info and bool(info["is_success"]) == success,
        f'info["is_success"] is {info.get("is_success")!r} where is_success() is {success}: they '
        "must be the same",
    )
