"""Grasp: close the gripper about an object."""

from collections.abc import Sequence

from prime_core.contracts.description import Affordance, SceneDescription
from prime_core.contracts.primitive import Motion
from prime_core.contracts.scene import Scene
from prime_primitives_scripted.mover import CLOSE, OPEN, Mover
from prime_primitives_scripted.phases import hold, rest
from prime_primitives_scripted.scripted import Array, Deviations, ScriptedConfig, ScriptedPrimitive

CLOSING_STEPS = 10
"""Motor actions that the gripper takes to close."""


class GraspConfig(ScriptedConfig):
    """Settings of the primitive grasp."""

    position_std: Deviations = (0.001, 0.001, 0.001)
    """Standard deviations of the parameter prior in x, y, z [m]."""

    def build(self, description: SceneDescription) -> "Grasp":
        """Make the primitive; see `PrimitiveConfig`."""
        return Grasp(self, description)


class Grasp(ScriptedPrimitive):
    """Lifts, travels above the goal, descends with the gripper open, and closes it.

    Args:
        config: Its settings.
        description: Of the scenes that it will work in.
    """

    name = "grasp"

    def __init__(self, config: GraspConfig, description: SceneDescription) -> None:
        super().__init__(config, description)
        self.maximum_steps += CLOSING_STEPS

    def suits(self, holding: bool) -> bool:
        """Only with nothing held."""
        return not holding

    def affordances(self, scene: Scene) -> Sequence[Affordance]:
        """Return the centres for grasping."""
        return scene.description.affordances_for("grasp")

    def motion(self, scene: Scene, parameters: Array) -> Motion:
        """Return the motion that starts in a scene; see `Primitive`."""
        goal = self._goal(scene, parameters)
        mover = Mover(self._servo, OPEN)
        scene = yield from self._approach(scene, goal, mover)
        if self._is_there(scene, parameters):
            still = yield from rest(scene, goal, mover)
            # Fingers that close on their way push the object aside.
            if still is not None:
                mover.gripper = CLOSE
                yield from hold(still, goal, mover, CLOSING_STEPS)

    def succeeded(self, scenes: Sequence[Scene], parameters: Array) -> bool:
        """Whether the gripper is there and has come to hold an object that may be grasped."""
        before, after = scenes[0], scenes[-1]
        if before.held is not None or after.held is None:
            return False
        held = after.description.objects[after.object_index(after.held)]
        return held.graspable and self._is_there(after, parameters)
