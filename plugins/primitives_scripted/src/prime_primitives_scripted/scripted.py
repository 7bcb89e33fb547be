"""What all scripted primitives share: parameters, bounds, the arm's limits."""

from abc import abstractmethod
from collections.abc import Sequence
from math import pi
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from prime_core.affordances import prior
from prime_core.affordances.goals import (
    distance,
    equivalent_goals,
    jaw_distance,
)
from prime_core.affordances.pose_space import pose_space
from prime_core.contracts.description import Affordance, SceneDescription
from prime_core.contracts.primitive import Primitive, PrimitiveConfig
from prime_core.contracts.scene import Scene
from prime_primitives_scripted.mover import Mover
from prime_primitives_scripted.phases import Phase, approach, at_most
from prime_primitives_scripted.servo import make_servo
from prime_primitives_scripted.step_limits import approach_limit, greatest_approach_limit

Array = NDArray[np.float64]

Length = Annotated[float, Field(ge=0.001, le=1)]
"""That decides on success [m]; the arm ends a millimetre from where it should."""

Deviation = Annotated[float, Field(ge=0, le=1)]
"""Of a position [m]."""

type Deviations = tuple[Deviation, Deviation, Deviation]
"""Standard deviations in x, y, z [m]."""


class ScriptedConfig(PrimitiveConfig):
    """Settings of a scripted primitive."""

    inverse_kinematics: bool = True
    """Whether to move within the limits of the arm; False steers by the gripper's pose alone."""
    position_std: Deviations
    """Standard deviations of the parameter prior in x, y, z [m]."""
    yaw_std: float = Field(0.05, ge=0, le=pi)
    """Standard deviation of the parameter prior in yaw [rad]."""
    position_tolerance: Length = 0.01
    """How far from its position parameters it may end [m]."""
    yaw_tolerance: float = Field(0.2, ge=0.01, le=pi)
    """How far from its yaw parameter it may end [rad]."""


class ScriptedPrimitive(Primitive):
    """A primitive whose parameters are where the gripper goes: x, y, z [m] and yaw [rad].

    Args:
        config: Its settings.
        description: Of the scenes that it will work in.
    """

    def __init__(self, config: ScriptedConfig, description: SceneDescription) -> None:
        self.parameter_space = pose_space(description)
        self.maximum_steps = greatest_approach_limit(description)
        self._config = config
        self._servo = make_servo(description, config.inverse_kinematics)

    @abstractmethod
    def suits(self, holding: bool) -> bool:
        """Whether it makes sense with something held, or with nothing."""

    def can_start(self, scene: Scene) -> bool:
        """Whether it suits what is held, and the arm is not locked; see `Primitive`."""
        return self.suits(scene.holding) and not self._servo.is_stuck(scene)

    @abstractmethod
    def affordances(self, scene: Scene) -> Sequence[Affordance]:
        """Return what the parameter prior is centred on in a scene."""

    def propose(self, scene: Scene, generator: np.random.Generator) -> Array:
        """Draw x, y, z and yaw near an affordance's centre, ``(4,)``, within the bounds."""
        std = (*self._config.position_std, self._config.yaw_std)
        return prior.draw(scene, self.affordances(scene), self.parameter_space, std, generator)

    def reachable(self, scene: Scene, parameters: Array) -> bool:
        """Whether the arm can get there within its limits and clear of furniture."""
        if not self.parameter_space.contains(parameters):
            return False
        return self._servo.plan(scene, parameters) is not None

    def _goal(self, scene: Scene, parameters: Array) -> Array:
        """Return the goal to head for, ``(4,)``; the nearest if none can be reached."""
        planned = self._servo.plan(scene, parameters)
        return equivalent_goals(parameters, scene.gripper_yaw)[0] if planned is None else planned

    def _approach(self, scene: Scene, goal: Array, mover: Mover) -> Phase:
        return at_most(approach_limit(scene, goal), scene, approach(scene, goal, mover))

    def _is_there(self, scene: Scene, parameters: Array) -> bool:
        """Whether the gripper is within the tolerances of where it was called to."""
        near = distance(scene, parameters) < self._config.position_tolerance
        return near and jaw_distance(scene, parameters[3]) < self._config.yaw_tolerance
