"""Reach: bring the gripper to a pose, with what it holds."""

from collections.abc import Sequence
from dataclasses import replace

from prime_core.contracts.description import Affordance, SceneDescription
from prime_core.contracts.primitive import Motion
from prime_core.contracts.scene import Scene
from prime_primitives_scripted.mover import CLOSE, OPEN, Mover
from prime_primitives_scripted.scripted import Array, Deviations, ScriptedConfig, ScriptedPrimitive

CLOSED_BELOW = 0.04
"""Opening below which an empty gripper counts as closed, half of the greatest [m]."""


class ReachConfig(ScriptedConfig):
    """Settings of the primitive reach."""

    position_std: Deviations = (0.005, 0.005, 0.01)
    """Standard deviations of the parameter prior in x, y, z [m]."""

    def build(self, description: SceneDescription) -> "Reach":
        """Make the primitive; see `PrimitiveConfig`."""
        return Reach(self, description)


class Reach(ScriptedPrimitive):
    """Lifts, travels above the goal and descends; the gripper stays as it is.

    Args:
        config: Its settings.
        description: Of the scenes that it will work in.
    """

    name = "reach"

    def suits(self, holding: bool) -> bool:
        """It makes sense anywhere."""
        return True

    def affordances(self, scene: Scene) -> Sequence[Affordance]:
        """Return the centres for reaching, else those for grasping and placing.

        With something held, those that go with it are left out, for they move along, and
        places are reached at the height of travel too.
        """
        description = scene.description
        places = description.affordances_for("place")
        found = description.affordances_for("reach")
        found = found or (*description.affordances_for("grasp"), *places)
        if scene.held is None:
            return found
        lifted = [_raised(item, description.lift_height) for item in places]
        return [*(item for item in found if item.reference != scene.held), *lifted]

    def motion(self, scene: Scene, parameters: Array) -> Motion:
        """Return the motion that starts in a scene; see `Primitive`."""
        closed = scene.holding or scene.gripper_opening < CLOSED_BELOW
        goal = self._goal(scene, parameters)
        mover = Mover(self._servo, CLOSE if closed else OPEN)
        yield from self._approach(scene, goal, mover)

    def succeeded(self, scenes: Sequence[Scene], parameters: Array) -> bool:
        """Whether the gripper is there and holds what it held, or still nothing."""
        return scenes[-1].held == scenes[0].held and self._is_there(scenes[-1], parameters)


def _raised(affordance: Affordance, height: float) -> Affordance:
    """Return an affordance of the world at a height [m]; others stay."""
    if affordance.reference is not None:
        return affordance
    low, high = affordance.low, affordance.high
    return replace(affordance, low=(*low[:2], height), high=(*high[:2], height))
