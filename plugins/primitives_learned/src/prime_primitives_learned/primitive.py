"""A learned primitive at work."""

import copy
from collections.abc import Sequence

import numpy as np

from prime_core.affordances import prior
from prime_core.affordances.goals import distance, jaw_distance
from prime_core.affordances.outcomes import is_put_down, lies_still
from prime_core.affordances.pose_space import pose_space
from prime_core.arrays import Array
from prime_core.contracts.calls import ParameterSpace
from prime_core.contracts.description import SceneDescription
from prime_core.contracts.environment import ACTION_LIMIT
from prime_core.contracts.policy import MotorPolicy
from prime_core.contracts.primitive import Motion, Primitive
from prime_core.contracts.scene import Scene
from prime_core.rotations import yaw_of
from prime_primitives_learned.frame import CallFrame, ParameterPlaces
from prime_primitives_learned.settings import Tolerances
from prime_primitives_learned.statistics import MOVED, SegmentStatistics

SLACK = 2.0  # times the longest segment that a motion may take: it may start further away
SURE = 3  # steps in a row that say that it is over: what a policy draws may be wrong once
GREATEST_SLIDE, GREATEST_FALL = 0.03, 0.08  # [m] of what is let go of and yet placed


class LearnedPrimitive(Primitive):
    """Moves as the segments do that it was trained on, to where a call says.

    It starts where they start, with something held or with nothing, and has succeeded where the
    gripper is where the call says at the instant that decides, and holds afterwards what the
    segments' does.

    Args:
        name: What primitive calls name it by.
        statistics: What the segments tell besides their motion.
        policy: Moves the gripper in the frame of a call; its sixth number says that it is over.
        tolerances: Of the prior and of the success.
        description: Of the scenes that it will work in.
    """

    def __init__(
        self,
        name: str,
        statistics: SegmentStatistics,
        policy: MotorPolicy,
        tolerances: Tolerances,
        description: SceneDescription,
    ) -> None:
        self.name = name
        self.parameter_space = _within_workspace(statistics.space, description)
        self.maximum_steps = round(SLACK * statistics.longest)
        self._statistics, self._policy, self._tolerances = statistics, policy, tolerances
        self._places = ParameterPlaces(statistics.space)
        self._is_pose = pose_space(description) == self.parameter_space

    def can_start(self, scene: Scene) -> bool:
        """Whether something is held, or nothing, as where the segments start; see `Primitive`."""
        wanted = self._statistics.holds_before
        return wanted is None or wanted == scene.holding

    def propose(self, scene: Scene, generator: np.random.Generator) -> Array:
        """Draw parameters ``(P,)`` near an affordance, or near an object as the segments had them.

        Affordances tell poses alone: a primitive with other parameters is drawn near an object.
        """
        found = scene.description.affordances_for(self._statistics.name)
        usable = [item for item in found if item.reference is None or item.reference != scene.held]
        if not (self._is_pose and usable) and self._statistics.relative_parameters:
            objects = self._objects(scene)
            if objects:
                return self._near_object(scene, objects, generator)
        if self._is_pose:
            std = (*self._tolerances.position_std, self._tolerances.yaw_std)
            return prior.draw(scene, usable, self.parameter_space, std, generator)
        return self.parameter_space.sample(generator)

    def _near_object(
        self, scene: Scene, objects: list[int], generator: np.random.Generator
    ) -> Array:
        """Draw parameters of a segment, placed at one of some objects."""
        index = objects[int(generator.integers(len(objects)))]
        shown = self._statistics.relative_parameters
        relative = np.array(shown[int(generator.integers(len(shown)))])
        yaw = float(yaw_of(scene.object_quaternions[index]))
        drawn = self._places.placed_at(relative, scene.object_positions[index], yaw)
        drawn[self._places.point] += generator.normal(0.0, self._tolerances.position_std)
        return np.clip(drawn, self.parameter_space.low, self.parameter_space.high)

    def _objects(self, scene: Scene) -> list[int]:
        """Return the objects that calls may be about: of a push, those that may be pushed."""
        pushes = self._statistics.moves
        return [
            index
            for index, item in enumerate(scene.description.objects)
            if item.name != scene.held and (item.pushable or not pushes)
        ]

    def motion(self, scene: Scene, parameters: Array) -> Motion:
        """Return the motion that starts in a scene; see `Primitive`."""
        frame = CallFrame(self._places, parameters, scene.gripper_position, scene.gripper_yaw)
        policy = copy.copy(self._policy)  # what it remembers is this motion's
        policy.reset(np.random.default_rng(0))  # the same scene gives the same motion
        over = 0
        while over < SURE:
            seen = frame.observations(
                scene.gripper_position[None],
                np.array([scene.gripper_yaw]),
                np.array([scene.gripper_opening]),
                np.array([scene.holding]),
            )
            action = policy.act(seen.only(policy.sees))
            if action is None:
                return
            over = over + 1 if action[5] > 0 else 0
            moved = frame.action_out(action[:5])
            scene = yield np.clip(moved, -ACTION_LIMIT, ACTION_LIMIT)

    def succeeded(self, scenes: Sequence[Scene], parameters: Array) -> bool:
        """Whether it did what the segments do, where the call says.

        The gripper is where the parameters say when it comes to hold something or lets go of it,
        or at the end where neither happens. What is let go of lies still below; a push ends where
        its displacement does, and something that was not held moved along.
        """
        before, after = scenes[0], scenes[-1]
        wanted = self._statistics.holds_after
        if wanted is not None and (after.held is not None) != wanted:
            return False
        if self._statistics.holds_before == wanted and before.held != after.held:
            return False
        if self._places.displacement:
            return self._pushed(scenes, parameters)
        decides = next((item for item in scenes[1:] if item.held != before.held), after)
        if not self._is_there(decides, parameters):
            return False
        return after.held is not None or before.held is None or _lies(scenes, before.held)

    def _is_there(self, scene: Scene, parameters: Array) -> bool:
        near = distance(scene, parameters[self._places.point]) < self._tolerances.position_tolerance
        yaw = self._places.yaw
        if yaw is None or not near:
            return near
        return jaw_distance(scene, float(parameters[yaw])) < self._tolerances.yaw_tolerance

    def _pushed(self, scenes: Sequence[Scene], parameters: Array) -> bool:
        after = scenes[-1]
        began = next((item for item in scenes if self._is_there(item, parameters)), None)
        end = parameters[self._places.point] + parameters[self._places.displacement]
        if began is None or distance(after, end) > self._tolerances.position_tolerance:
            return False
        if not self._statistics.moves:
            return True
        moves = (after.object_positions - began.object_positions)[:, :2]
        along = moves @ parameters[self._places.displacement][:2] > 0
        moved = along & (np.linalg.norm(moves, axis=1) > MOVED)
        return any(
            moved[index] and item.pushable and lies_still(scenes, index)
            for index, item in enumerate(after.description.objects)
        )


def _within_workspace(space: ParameterSpace, description: SceneDescription) -> ParameterSpace:
    """Return a space whose pose lies within an environment's workspace."""
    own = {item.name: item for item in pose_space(description).parameters}
    return ParameterSpace(tuple(own.get(item.name, item) for item in space.parameters))


def _lies(scenes: Sequence[Scene], name: str) -> bool:
    """Whether what was held lies still, about where it was let go of."""
    released = next(item for item in scenes if item.held != name)
    index = released.object_index(name)
    return is_put_down(scenes, released, index, GREATEST_SLIDE, GREATEST_FALL)
