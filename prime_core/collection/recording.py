"""One episode of the collection: as it is recorded, and as it is kept."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from prime_core.arrays import Array
from prime_core.contracts.environment import ACTION_LIMIT, Environment
from prime_core.contracts.observations import ENVIRONMENT_STATE_KEY, STATE_KEY
from prime_core.contracts.scene import Scene
from prime_core.execution.motions import Execution


@dataclass(frozen=True, eq=False)
class CollectedEpisode:
    """One episode of the collection.

    Attributes:
        state: ``(N, state width)`` float32.
        environment_state: ``(N, environment state width)`` float32.
        actions: The action of the last frame is zero, ``(N, 5)`` float32.
        rollouts: Start frame, end frame and primitive of each that succeeded, ``(n, 3)``.
        parameters: Of each rollout, padded with zeros, ``(n, width)``.
        others: Start and end frame of pairs of `other`, ``(k, 2)``.
        late_ends: For each rollout a later frame that tells its parameters too, or its end,
            ``(n,)``.
    """

    state: NDArray[np.float32]
    environment_state: NDArray[np.float32]
    actions: NDArray[np.float32]
    rollouts: NDArray[np.int64]
    parameters: NDArray[np.float64]
    others: NDArray[np.int64]
    late_ends: NDArray[np.int64]


class EpisodeRecording:
    """The frames and rollouts of an episode as they come.

    Args:
        environment: Whose scene is the first frame.

    Attributes:
        scenes: The frames so far.
        rollouts: Start frame, end frame and primitive of each that succeeded.
    """

    def __init__(self, environment: Environment) -> None:
        self.scenes: list[Scene] = [environment.scene()]
        self.rollouts: list[tuple[int, int, int]] = []
        self._actions: list[Array] = []
        self._parameters: list[Array] = []

    def extend(self, execution: Execution) -> None:
        """Add what happened."""
        self.scenes.extend(execution.scenes[1:])
        self._actions.extend(execution.actions)

    def add_rollout(self, execution: Execution, primitive: int, parameters: Array) -> None:
        """Add a primitive that succeeded.

        Args:
            execution: What happened.
            primitive: Its number.
            parameters: What it was called with, ``(P,)``.
        """
        start = len(self.scenes) - 1
        self.extend(execution)
        self.rollouts.append((start, len(self.scenes) - 1, primitive))
        self._parameters.append(parameters)

    @property
    def last_action(self) -> Array | None:
        """The motor action before, ``(5,)``; None at the start."""
        return self._actions[-1] if self._actions else None

    def finish(
        self, width: int, others: NDArray[np.int64], late_ends: NDArray[np.int64]
    ) -> CollectedEpisode:
        """Return the episode.

        Args:
            width: Of the longest parameter vector.
            others: Start and end frame of pairs of `other`, ``(k, 2)``.
            late_ends: Of each rollout, ``(n,)``.
        """
        observations = [scene.observation() for scene in self.scenes]
        parameters = np.zeros((len(self._parameters), width))
        for row, values in zip(parameters, self._parameters, strict=True):
            row[: len(values)] = values
        actions = np.zeros((len(self.scenes), len(ACTION_LIMIT)), dtype=np.float32)
        if self._actions:
            actions[:-1] = self._actions
        return CollectedEpisode(
            state=np.array([item[STATE_KEY] for item in observations]),
            environment_state=np.array([item[ENVIRONMENT_STATE_KEY] for item in observations]),
            actions=actions,
            rollouts=np.array(self.rollouts, dtype=np.int64).reshape(-1, 3),
            parameters=parameters,
            others=others,
            late_ends=late_ends,
        )
