"""Making a demonstration out of an environment's states, frame by frame."""

import numpy as np
from numpy.typing import NDArray

from prime_core.contracts.demonstration import Demonstration
from prime_core.contracts.environment import EnvironmentConfig
from prime_core.contracts.observations import ENVIRONMENT_STATE_KEY, STATE_KEY, Observations
from prime_core.errors import PrimeError
from prime_envs_robosuite.config import RobosuiteConfig
from prime_envs_robosuite.environment import RobosuiteEnvironment

ACTION_WIDTH = 5


def build_for_recording(environment: EnvironmentConfig, source: str) -> RobosuiteEnvironment:
    """Build a robosuite environment without cameras and without a horizon.

    Both cost or cut what a recording does not need: images can be rendered from the recorded
    states, and a demonstration ends when its task is done.

    Args:
        environment: Settings of the environment.
        source: Name of the demonstrator, for the error.

    Raises:
        PrimeError: If the environment is not one of this pack.
    """
    if not isinstance(environment, RobosuiteConfig):
        raise PrimeError(
            f"demonstrator {source!r} shows tasks in robosuite environments, such as "
            f"'robosuite/pick-place'; it cannot in {type(environment).__name__}"
        )
    plain = environment.model_copy(update={"cameras": (), "horizon": None})
    built = plain.build()
    assert isinstance(built, RobosuiteEnvironment)
    return built


class Recorder:
    """Collects the frames of one demonstration.

    Args:
        environment: What is recorded.
    """

    def __init__(self, environment: RobosuiteEnvironment) -> None:
        self._environment = environment
        self._states: list[NDArray[np.float32]] = []
        self._object_states: list[NDArray[np.float32]] = []
        self._simulator_states: list[NDArray[np.float64]] = []
        self._actions: list[NDArray[np.float32]] = []

    def __len__(self) -> int:
        """Return the number of frames so far."""
        return len(self._states)

    def add(self, action: NDArray[np.floating]) -> None:
        """Record the present state and the action that is about to be taken.

        Args:
            action: As in `prime_core.contracts.environment`, ``(5,)``.
        """
        observation = self._environment.scene().observation()
        self._states.append(observation[STATE_KEY])
        self._object_states.append(observation[ENVIRONMENT_STATE_KEY])
        self._simulator_states.append(self._environment.get_state())
        self._actions.append(np.asarray(action, dtype=np.float32))

    def finish(self, gripper: float, task: str) -> Demonstration:
        """Record the last state with a hold action and return the demonstration.

        Args:
            gripper: The gripper's command in the hold action, -1 (open) or 1 (close).
            task: What was done, in words.
        """
        hold = np.zeros(ACTION_WIDTH)
        hold[-1] = gripper
        self.add(hold)
        return Demonstration(
            observations=Observations(np.stack(self._states), np.stack(self._object_states)),
            actions=np.stack(self._actions),
            task=task,
            simulator_states=np.stack(self._simulator_states),
        )
