"""A primitive that raises the gripper straight up, with what it holds."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from prime_core.contracts.calls import Parameter, ParameterSpace
from prime_core.contracts.description import SceneDescription
from prime_core.contracts.environment import ACTION_LIMIT
from prime_core.contracts.primitive import Motion, Primitive, PrimitiveConfig
from prime_core.contracts.scene import Scene
from prime_core.hookspecs import Register, hookimpl

Array = NDArray[np.float64]

LOWEST = 0.02
"""Least height to rise by [m]."""


@hookimpl
def register_primitives(register: Register) -> None:
    """Register the primitive."""
    register("hello/lift", LiftConfig)


class LiftConfig(PrimitiveConfig):
    """Settings of the primitive lift."""

    highest: float = Field(0.15, gt=LOWEST, le=1)
    """Greatest height to rise by [m]."""
    tolerance: float = Field(0.01, ge=0.001, le=0.1)
    """How far from the goal the gripper may end [m]."""

    def build(self, description: SceneDescription) -> "Lift":
        """Make the primitive; see `PrimitiveConfig`."""
        return Lift(self)


class Lift(Primitive):
    """Raises the gripper straight up; the gripper stays as it is.

    Its parameter is how far it rises, ``height`` [m].
    """

    name = "lift"
    maximum_steps = 40

    def __init__(self, config: LiftConfig) -> None:
        self.parameter_space = ParameterSpace((Parameter("height", "m", LOWEST, config.highest),))
        self._tolerance = config.tolerance

    def can_start(self, scene: Scene) -> bool:
        """It makes sense below the top of the workspace."""
        return _room(scene) > LOWEST

    def propose(self, scene: Scene, generator: np.random.Generator) -> Array:
        """Draw any height that there is room for, ``(1,)``."""
        highest = min(_room(scene), self.parameter_space.high[0])
        return generator.uniform(LOWEST, highest, size=1)

    def reachable(self, scene: Scene, parameters: Array) -> bool:
        """Whether it ends within the workspace."""
        return self.parameter_space.contains(parameters) and bool(parameters[0] <= _room(scene))

    def motion(self, scene: Scene, parameters: Array) -> Motion:
        """Return the motion that starts in a scene; see `Primitive`."""
        goal = scene.gripper_position + np.array([0.0, 0.0, parameters[0]])
        gripper = 1.0 if scene.holding else -1.0
        while np.linalg.norm(goal - scene.gripper_position) > self._tolerance / 2:
            move = np.clip(goal - scene.gripper_position, -ACTION_LIMIT[:3], ACTION_LIMIT[:3])
            scene = yield np.array([*move, 0.0, gripper])

    def succeeded(self, scenes: Sequence[Scene], parameters: Array) -> bool:
        """Whether the gripper rose as far as it should and holds what it held."""
        first, last = scenes[0], scenes[-1]
        rise = last.gripper_position[2] - first.gripper_position[2]
        return bool(abs(rise - parameters[0]) < self._tolerance) and last.held == first.held


def _room(scene: Scene) -> float:
    """Return how far the gripper may rise [m]."""
    return float(scene.description.workspace_high[2] - scene.gripper_position[2])
