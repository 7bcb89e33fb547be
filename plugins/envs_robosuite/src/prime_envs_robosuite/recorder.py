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
# In a row with the task solved, after which a demonstration ends (0.25 s). What passes a goal by
# does not count, and fingers that let go are all but open by then; the retreat has not begun.
SOLVED_FRAMES = 5


def build_for_recording(environment: EnvironmentConfig, source: str) -> RobosuiteEnvironment:
    """Build a robosuite environment without cameras and without a horizon.

    Both cost or cut what a recording does not need: images can be rendered from the recorded
    states, and a demonstration ends when its task is solved.

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
        self._solved: list[bool] = []

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
        self._solved.append(self._environment.is_success())
        self._actions.append(np.asarray(action, dtype=np.float32))

    def finish(self, gripper: float, ends_when_solved: bool) -> Demonstration:
        """Record the last state and return the demonstration, whose last action is a hold.

        Args:
            gripper: The gripper's command in the hold action, -1 (open) or 1 (close).
            ends_when_solved: Whether frames after the task was solved are left out.
        """
        hold = np.zeros(ACTION_WIDTH)
        hold[-1] = gripper
        self.add(hold)
        count = self._count_until_solved() if ends_when_solved else len(self)
        actions = np.stack(self._actions[:count])
        actions[-1, :-1] = 0.0
        return Demonstration(
            observations=Observations(
                np.stack(self._states[:count]), np.stack(self._object_states[:count])
            ),
            actions=actions,
            task=self._environment.task.words,
            simulator_states=np.stack(self._simulator_states[:count]),
        )

    def _count_until_solved(self) -> int:
        """Return how many frames there are until the task stays solved; all if it never does."""
        in_a_row = 0
        for index, solved in enumerate(self._solved):
            in_a_row = in_a_row + 1 if solved else 0
            if in_a_row == SOLVED_FRAMES:
                return index + 1
        return len(self)
