"""The contract of an environment."""

from abc import abstractmethod
from collections.abc import Sequence
from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray

from prime_core.configuration import Config
from prime_core.contracts.description import SceneDescription
from prime_core.contracts.observations import Observations
from prime_core.contracts.scene import Scene
from prime_core.errors import PrimeError

CONTROL_FREQUENCY = 20
"""Motor actions a second [Hz]."""


ACTION_NAMES = ("dx", "dy", "dz", "dyaw", "gripper")


ACTION_LIMIT = np.array([0.05, 0.05, 0.05, 0.5, 1.0])
"""Greatest magnitudes of a motor action: metres, metres, metres, radians, and 1."""

ACTION_LIMIT.setflags(write=False)


Observation = dict[str, NDArray[Any]]


Action = NDArray[np.float64]


class Environment(gymnasium.Env[Observation, Action]):
    """A manipulation task: a `gymnasium.Env` that also gives scenes and exact states.

    Actions are ``(5,)``, at 20 Hz: dx, dy, dz [m] and dyaw [rad] of the gripper in the world
    frame, for this step; then the gripper's command, from -1 (open) to 1 (close). Greater
    values are clipped. Roll and pitch are servoed to point the gripper down.

    Observations are dictionaries with LeRobot's keys; see `prime_core.arrays` for the two state
    vectors. Images are ``observation.images.NAME``, ``(H, W, 3)`` uint8.

    The reward is 1 while the task is solved, else 0; ``info["is_success"]`` says the same. An
    episode terminates when the task is solved.
    """

    description: SceneDescription
    default_camera: str | None = None
    """The camera that shows the whole scene; None where there is none."""

    @abstractmethod
    def scene(self) -> Scene:
        """Return the scene as it is now."""

    @abstractmethod
    def is_success(self) -> bool:
        """Whether the task is solved now, as a person would call it."""

    @abstractmethod
    def get_state(self) -> NDArray[np.float64]:
        """Return all that the future depends on, ``(n,)``.

        Restored in this or another instance and stepped again with the same actions, the
        state leads to the same states, bit for bit.
        """

    @abstractmethod
    def set_state(self, state: NDArray[np.float64]) -> None:
        """Restore a state.

        Args:
            state: What `get_state` returned, ``(n,)``.

        Raises:
            PrimeError: If the state is not of this environment.
        """

    def render_camera(self, name: str, height: int, width: int) -> NDArray[np.uint8]:
        """Return a picture, ``(height, width, 3)``.

        Raises:
            PrimeError: If there is no such camera or no library to render with.
        """
        raise PrimeError(f"environment {type(self).__name__} has no camera {name!r}")

    def pictures(
        self, seen: Observations, cameras: Sequence[str], height: int, width: int
    ) -> dict[str, NDArray[np.uint8]]:
        """Return pictures of stored instants, whatever the environment's own state is.

        They show joints, opening and object poses as observations hold them, so that
        collecting needs no pictures. The environment's state is left alone.

        Args:
            seen: ``N`` instants of this environment.
            cameras: Their names.
            height: [pixels].
            width: [pixels].

        Returns:
            By camera, ``(N, height, width, 3)``, first row at the top.

        Raises:
            PrimeError: If object poses are not known, there is no such camera, or nothing to
                render with.
        """
        raise PrimeError(f"environment {type(self).__name__} makes no pictures of stored instants")


class EnvironmentConfig(Config):
    """Settings of an environment; what packs register."""

    @abstractmethod
    def build(self) -> Environment:
        """Make the environment."""
