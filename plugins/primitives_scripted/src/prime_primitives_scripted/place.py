"""Place: put down what the gripper holds."""

from collections.abc import Sequence

import numpy as np

from prime_core.affordances.goals import jaw_distance, plane_distance
from prime_core.affordances.outcomes import is_put_down
from prime_core.contracts.description import Affordance, SceneDescription
from prime_core.contracts.primitive import Motion
from prime_core.contracts.scene import Scene
from prime_primitives_scripted.mover import CLOSE, OPEN, Mover
from prime_primitives_scripted.phases import hold
from prime_primitives_scripted.scripted import (
    Array,
    Deviations,
    Length,
    ScriptedConfig,
    ScriptedPrimitive,
)

OPENING_STEPS = 14  # for the gripper to open, which takes 10, and for what it lets go of to rest
LETTING_GO = 4  # motor actions of opening after which the object is free
OPENED = 0.004  # [m] that the gripper opens by at the least when it lets go


class PlaceConfig(ScriptedConfig):
    """Settings of the primitive place."""

    position_std: Deviations = (0.01, 0.01, 0.03)
    """Standard deviations of the parameter prior in x, y, z [m]; the paper's in z is 0.1 m, from
    where things tumble away."""
    greatest_fall: Length = 0.08
    """How far what is let go of may fall [m]."""
    greatest_slide: Length = 0.03
    """How far it may come to lie from below where it was let go of [m]."""

    def build(self, description: SceneDescription) -> "Place":
        """Make the primitive; see `PrimitiveConfig`."""
        return Place(self, description)


class Place(ScriptedPrimitive):
    """Lifts, travels above the goal, descends with what is held, and opens the gripper.

    It lets go where the way down is blocked too, for then the object stands on something.

    Args:
        config: Its settings.
        description: Of the scenes that it will work in.
    """

    name = "place"

    def __init__(self, config: PlaceConfig, description: SceneDescription) -> None:
        super().__init__(config, description)
        self._place = config
        self.maximum_steps += OPENING_STEPS

    def suits(self, holding: bool) -> bool:
        """Only with something held."""
        return holding

    def affordances(self, scene: Scene) -> Sequence[Affordance]:
        """Return the centres for placing, but for those that go with what is held."""
        found = scene.description.affordances_for("place")
        return [item for item in found if item.reference is None or item.reference != scene.held]

    def motion(self, scene: Scene, parameters: Array) -> Motion:
        """Return the motion that starts in a scene; see `Primitive`."""
        goal = self._goal(scene, parameters)
        mover = Mover(self._servo, CLOSE)
        scene = yield from self._approach(scene, goal, mover)
        if self._is_over(scene, parameters):
            mover.gripper = OPEN
            # What stands on something is let go of before the hand goes on down around it.
            stand = np.array([*goal[:2], scene.gripper_position[2], goal[3]])
            scene = yield from hold(scene, stand, mover, LETTING_GO)
            yield from hold(scene, goal, mover, OPENING_STEPS - LETTING_GO)

    def succeeded(self, scenes: Sequence[Scene], parameters: Array) -> bool:
        """Whether what it held was put down where the parameters say, and lies still there.

        The parameters are where the gripper lets go, height included: where the way down was
        blocked higher up, it was another place. Nothing is held any more. What was let go of
        fell and slid a little at most: an inverse dynamics model then finds the place from where
        the object lies, wherever the hand has gone since.

        The last steps are the gripper's opening: an object that was lost before is not held
        when they begin.
        """
        if len(scenes) <= OPENING_STEPS or scenes[0].held is None:
            return False
        release, after = scenes[-1 - OPENING_STEPS], scenes[-1]
        # An object that is pressed on forces the fingers apart a little, or seems not held.
        opened = after.gripper_opening > release.gripper_opening + OPENED
        let_go = release.held == scenes[0].held and opened and after.held is None
        return let_go and self._is_there(release, parameters) and self._is_put_down(scenes, release)

    def _is_put_down(self, scenes: Sequence[Scene], release: Scene) -> bool:
        """Whether what was held at the release lies still, about where it was let go of."""
        assert release.held is not None, "something was held"
        index = release.object_index(release.held)
        slide, fall = self._place.greatest_slide, self._place.greatest_fall
        return is_put_down(scenes, release, index, slide, fall)

    def _is_over(self, scene: Scene, parameters: Array) -> bool:
        """Whether the gripper is where it was called to, whatever its height."""
        near = plane_distance(scene, parameters) < self._config.position_tolerance
        return near and jaw_distance(scene, parameters[3]) < self._config.yaw_tolerance
