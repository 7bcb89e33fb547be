"""Push: shove an object over the table with the closed gripper."""

from collections.abc import Sequence
from math import pi
from typing import Annotated

import numpy as np
from pydantic import Field

from prime_core.affordances import prior
from prime_core.affordances.goals import distance
from prime_core.affordances.outcomes import lies_still
from prime_core.configuration import Range, within
from prime_core.contracts.calls import Parameter, ParameterSpace
from prime_core.contracts.description import Affordance, SceneDescription
from prime_core.contracts.primitive import Motion
from prime_core.contracts.scene import Scene
from prime_primitives_scripted.mover import CLOSE, Mover
from prime_primitives_scripted.phases import at_most, settle
from prime_primitives_scripted.scripted import (
    Array,
    Deviations,
    Length,
    ScriptedConfig,
    ScriptedPrimitive,
)
from prime_primitives_scripted.step_limits import way_limit

GREATEST_DISPLACEMENT = (0.4, 0.4, 0.01)  # [m] (paper's release)
LEAST_MOVE = 0.07  # [m] that an object must move in the plane to count as pushed (paper's release)
DIRECTION_TOLERANCE = 0.5  # [rad] by which its direction may differ from the gripper's
STAYED = 0.01  # [m] that it may have moved when the push begins


class PushConfig(ScriptedConfig):
    """Settings of the primitive push."""

    position_std: Deviations = (0.01, 0.01, 0.005)
    """Standard deviations of the prior of where a push starts in x, y, z [m].

    Affordances say where around an object a push starts, clear of it; the release draws 0.1 m about
    the object's centre instead. Where a push started is hard to tell from what came of it: with
    wide draws, inverse dynamics models put starts on top of the object."""
    direction_std: float = Field(0.2, gt=0, le=pi)
    """Standard deviation of a push's direction about the one towards the object's centre [rad]."""
    length: Annotated[Range, within(0.01, 1)] = (0.14, 0.4)
    """Least and greatest length of a push that the prior draws [m]; shorter ones hardly move what
    they start a few centimetres from."""
    position_tolerance: Length = 0.015
    """How far from either end the gripper may come [m]."""

    def build(self, description: SceneDescription) -> "Push":
        """Make the primitive; see `PrimitiveConfig`."""
        return Push(self, description)


class Push(ScriptedPrimitive):
    """Lifts, travels above the start, descends with the gripper closed, and moves straight on.

    Its parameters are where the push starts, x, y, z [m] and yaw [rad], and its displacement
    dx, dy, dz [m].

    Args:
        config: Its settings.
        description: Of the scenes that it will work in.
    """

    name = "push"

    def __init__(self, config: PushConfig, description: SceneDescription) -> None:
        super().__init__(config, description)
        self._push = config
        self._pose_space = self.parameter_space
        displacement = tuple(
            Parameter(name, "m", -limit, limit)
            for name, limit in zip(("dx", "dy", "dz"), GREATEST_DISPLACEMENT, strict=True)
        )
        self.parameter_space = ParameterSpace((*self._pose_space.parameters, *displacement))
        self.maximum_steps += way_limit(float(np.linalg.norm(GREATEST_DISPLACEMENT)))

    def suits(self, holding: bool) -> bool:
        """Only with nothing held."""
        return not holding

    def affordances(self, scene: Scene) -> Sequence[Affordance]:
        """Return where pushes may start."""
        return scene.description.affordances_for("push")

    def propose(self, scene: Scene, generator: np.random.Generator) -> Array:
        """Draw a start beside an object and a displacement through it, ``(7,)``.

        A push keeps its direction and ends within the workspace. Where too little would be left of
        it, as of one outwards at the edge, another one is drawn; the last one stands if none has
        room, and is not reachable.
        """
        std = (*self._push.position_std, self._push.yaw_std)
        pushable = [item.pushable for item in scene.description.objects]
        if not any(pushable):
            return self.parameter_space.sample(generator)
        centres = scene.object_positions[pushable, :2]
        least, greatest = self._push.length
        for _ in range(prior.REDRAWS):
            start = prior.draw(scene, self.affordances(scene), self._pose_space, std, generator)
            ways = centres - start[:2]
            way = ways[np.argmin(np.linalg.norm(ways, axis=1))]
            angle = np.arctan2(way[1], way[0]) + generator.normal(0.0, self._push.direction_std)
            direction = np.array([np.cos(angle), np.sin(angle)])
            room = min(greatest, self._room(start[:2], direction))
            if room >= least:
                break
        length = generator.uniform(least, max(room, least))
        space, limit = self._pose_space, GREATEST_DISPLACEMENT[2]
        rise = np.clip(generator.normal(0.0, self._push.position_std[2]), -limit, limit)
        rise = np.clip(start[2] + rise, space.low[2], space.high[2]) - start[2]
        return np.array([*start, *(length * direction), rise])

    def _room(self, start: Array, direction: Array) -> float:
        """Return how far it is from a start ``(2,)`` to the workspace's edge [m]."""
        edges = np.where(direction > 0, self._pose_space.high[:2], self._pose_space.low[:2])
        # A direction along an axis never meets the other axis' edges.
        ways = (edges - start) / np.where(np.abs(direction) < 1e-9, 1e-9, direction)
        return float(np.abs(ways).min())

    def reachable(self, scene: Scene, parameters: Array) -> bool:
        """Whether the arm can get to both ends within its limits and clear of furniture."""
        if not self.parameter_space.contains(parameters):
            return False
        goals = parameters[:4], _end(parameters)
        return all(
            self._pose_space.contains(goal) and self._servo.plan(scene, goal) is not None
            for goal in goals
        )

    def motion(self, scene: Scene, parameters: Array) -> Motion:
        """Return the motion that starts in a scene; see `Primitive`."""
        start = self._goal(scene, parameters[:4])
        mover = Mover(self._servo, CLOSE)
        scene = yield from self._approach(scene, start, mover)
        if self._is_there(scene, parameters):
            end = start + np.append(parameters[4:], 0.0)
            yield from at_most(
                way_limit(float(np.linalg.norm(parameters[4:]))), scene, settle(scene, end, mover)
            )

    def succeeded(self, scenes: Sequence[Scene], parameters: Array) -> bool:
        """Whether it came to both ends, and pushed an object that may be pushed.

        From the push's start on the object moved along with the gripper, no further than it, and
        lies still. It lay still until then: a start is told from where the object was before.
        """
        after = scenes[-1]
        if scenes[0].held is not None or after.held is not None:
            return False
        began = next((item for item in scenes if self._is_there(item, parameters)), None)
        ended = distance(after, _end(parameters)) < self._push.position_tolerance
        if began is None or not ended:
            return False
        return any(
            item.pushable
            and _plane_move(scenes[0], began, index)[1] < STAYED
            and self._moved_along(_plane_move(began, after, index), parameters[4:6])
            and lies_still(scenes, index)
            for index, item in enumerate(after.description.objects)
        )

    def _moved_along(self, moved: tuple[Array, float], way: Array) -> bool:
        move, length = moved
        most = float(np.linalg.norm(way))
        along = float(move @ way) >= np.cos(DIRECTION_TOLERANCE) * length * most
        return along and LEAST_MOVE < length < most + self._push.position_tolerance


def _plane_move(before: Scene, after: Scene, index: int) -> tuple[Array, float]:
    """Return how an object moved in the plane [m], ``(2,)``, and how far [m]."""
    move = (after.object_positions[index] - before.object_positions[index])[:2]
    return move, float(np.linalg.norm(move))


def _end(parameters: Array) -> Array:
    """Return the goal ``(4,)`` where a push ends."""
    return np.append(parameters[:3] + parameters[4:], parameters[3])
