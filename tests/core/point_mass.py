"""An environment without physics, to test the checks of environments and primitives on."""

from typing import Any

import gymnasium
import numpy as np

from prime_core.arrays import Floats
from prime_core.checks.samples import DESCRIPTION
from prime_core.contracts.description import SceneDescription
from prime_core.contracts.environment import ACTION_LIMIT, Action, Environment, Observation
from prime_core.contracts.scene import ObjectPoses, Scene
from prime_core.errors import PrimeError
from prime_core.rotations import gripper_down

SOLVED_HEIGHT = 1.05


class PointMass(Environment):
    """A gripper without weight over two things that lie still; solved when it is high up."""

    def __init__(self, description: SceneDescription = DESCRIPTION) -> None:
        self.description = description
        self.action_space = gymnasium.spaces.Box(-ACTION_LIMIT, ACTION_LIMIT, dtype=np.float64)
        self.observation_space: Any = gymnasium.spaces.Dict(
            {
                "observation.state": gymnasium.spaces.Box(-np.inf, np.inf, (15,), np.float32),
                "observation.environment_state": gymnasium.spaces.Box(
                    -np.inf, np.inf, (description.environment_state_width,), np.float32
                ),
            }
        )
        self.values: Floats = np.zeros(11)  # gripper x y z yaw opening, then two positions

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        super().reset(seed=seed)
        things = self.np_random.uniform(-0.2, 0.2, 6)
        self.values = np.array([0.0, 0.0, 0.9, 0.0, 0.08, *things])
        return self.observe(), {}

    def observe(self) -> Observation:
        return dict(self.scene().observation())

    def step(self, action: Action) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        clipped = np.clip(action, -ACTION_LIMIT, ACTION_LIMIT)
        self.values[:4] += clipped[:4]
        self.values[4] = np.clip(self.values[4] - 0.01 * clipped[4], 0.0, 0.08)
        success = self.is_success()
        return self.observe(), float(success), success, False, {"is_success": success}

    def scene(self) -> Scene:
        count = len(self.description.objects)
        return Scene(
            description=self.description,
            gripper_position=self.values[:3].copy(),
            gripper_quaternion=gripper_down(self.values[3]),
            gripper_opening=float(self.values[4]),
            joint_positions=np.zeros(7),
            objects=ObjectPoses(
                positions=self.values[5:].reshape(2, 3)[:count].copy(),
                quaternions=np.tile([1.0, 0.0, 0.0, 0.0], (count, 1)),
                held=None,
            ),
        )

    def is_success(self) -> bool:
        return bool(self.values[2] > SOLVED_HEIGHT)

    def get_state(self) -> Floats:
        return self.values.copy()

    def set_state(self, state: Floats) -> None:
        if state.shape != (11,):
            raise PrimeError(f"a state has 11 numbers, not {state.shape}")
        self.values = state.copy()
