"""Runs an exported policy step by step: what a robot's loop calls."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Self

import numpy as np

from prime_core.contracts.environment import ACTION_LIMIT, Action
from prime_core.deployment.exported_models import ExportedModels
from prime_core.deployment.robot_observation import observation_keys, read_observation
from prime_core.deployment.trace import TraceRecord, trace_of
from prime_core.errors import PrimeError
from prime_core.execution.runner import SceneRunner

OPEN = -1.0
"""The gripper's command before a policy has given any."""


class PolicyRunner:
    """A policy at work: ``reset``, then observation in, motor action out, at ``rate``.

    It is the policy of the run's trials, with the same runner of primitives.

    Args:
        models: What was exported.

    Attributes:
        models: What was exported: the description of scenes, cameras, where it came from.
        rate: Motor actions a second [Hz]; an action is a step of that length.
        steps: Motor actions given since the last reset.
        done: Whether the policy gave the episode up. A policy does not know whether the task is
            solved: that is for the loop to tell.
    """

    def __init__(self, models: ExportedModels) -> None:
        self.models = models
        self.rate = models.manifest.rate
        self.steps = 0
        self.done = False
        self._policy = models.policy()
        self._is_reset = False
        self._gripper = OPEN

    @classmethod
    def load(cls, folder: Path | str, device: str = "auto") -> Self:
        """Load what ``prime export-policy`` wrote; see `ExportedModels`.

        Args:
            folder: The folder.
            device: Where networks compute; see `ModelContext`.

        Raises:
            PrimeError: If it is no such folder, it is damaged, or a pack is missing.
        """
        return cls(ExportedModels.open(folder, device))

    @property
    def keys(self) -> tuple[str, ...]:
        """The keys of an observation that the policy looks at."""
        return observation_keys(self._policy.sees, self._policy.cameras)

    def reset(self, random: int | np.random.Generator = 0) -> None:
        """Begin an episode.

        Args:
            random: Of all random draws of the episode: a generator, or a seed for one.
        """
        generator = np.random.default_rng(random)  # a generator is returned as it is
        self._policy.reset(generator)
        self._is_reset, self.done, self.steps, self._gripper = True, False, 0, OPEN

    def act(self, observation: Mapping[str, Any]) -> Action | None:
        """Return the next motor action.

        Args:
            observation: What the robot saw just now, by LeRobot's keys: `keys` says which, and
                `prime_core.contracts.observations` what is in them. Others are left alone.

        Returns:
            ``(5,)`` float64: dx, dy, dz [m] and dyaw [rad] of the gripper in the world frame for
            this step, and the gripper's command, from -1 (open) to 1 (close); within their limits.
            None where the policy gives up, as it does where no primitive can start: then `done` is
            true, and None is all that comes until `reset`.

        Raises:
            ObservationError: If the observation is not what the policy looks at; nothing has
                changed then, and the next observation may be right.
            PrimeError: If the episode was not begun, or the policy's action is none of a robot.
        """
        if not self._is_reset:
            raise PrimeError("the episode was not begun: call reset() before act()")
        if self.done:
            return None
        policy = self._policy
        seen = read_observation(observation, self.models.description, policy.sees, policy.cameras)
        action = policy.act(seen)
        if action is None:
            self.done = True
            return None
        if action.shape != ACTION_LIMIT.shape or not np.isfinite(action).all():
            raise PrimeError(
                f"policy {self.models.manifest.origin.policy!r} gave the action {action.tolist()}: "
                f"a robot's has {len(ACTION_LIMIT)} finite numbers"
            )
        self.steps += 1
        within: Action = np.clip(action, -ACTION_LIMIT, ACTION_LIMIT)
        self._gripper = float(within[4])
        return within

    def hold(self) -> Action:
        """Return the motor action that holds still, with the gripper's last command, ``(5,)``.

        For steps without an observation: the policy is not told of them, and goes on from the next
        one. Before the first action the gripper opens.
        """
        return np.array([0.0, 0.0, 0.0, 0.0, self._gripper])

    @property
    def trace(self) -> tuple[TraceRecord, ...]:
        """What was done since the last reset, ``str(record)`` in a line.

        Policies over motor actions make no calls: theirs tells only that they gave up.
        """
        makes_calls = isinstance(self._policy, SceneRunner)
        given_up = None
        if self.done:
            given_up = "no primitive can start here" if makes_calls else "the policy gave up"
        records = self._policy.records if isinstance(self._policy, SceneRunner) else []
        return tuple(trace_of(records, self.models.space, given_up, self.steps))
