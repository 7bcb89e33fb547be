"""The frame of a call: what a learned primitive sees of the world, and acts in.

Its origin is where the call's parameters say. Its x axis points the way that the gripper has to go:
that of the displacement if there is one, else from where it starts to the origin. The gripper's yaw
is less the call's. Seen so, all calls of a primitive look alike, wherever they are and from
whatever side it comes. The parameters themselves are objects of that frame, so
that any policy over motor actions that sees objects sees them:

- ``goal`` at the origin; it counts as held while the gripper holds something,
- ``near`` on the way from the gripper to the goal, at most 3 cm along each axis: millimetres count
  there, and would be lost among the distances of a whole motion,
- ``floor`` below it, at the height 0 of the world,
- ``end`` where a displacement ends, if there is one (dx, dy, dz),
- ``numbers-0``, ... whose positions are three other parameters each, if there are others.

Objects of the environment are not seen: a primitive that knows where to go needs none, and runs in
any environment.
"""

import numpy as np

from prime_core.affordances.goals import JAW_PERIOD
from prime_core.arrays import Array, Flags, Floats
from prime_core.contracts.calls import ParameterSpace
from prime_core.contracts.description import ObjectDescription, SceneDescription
from prime_core.contracts.observations import OBJECT_WIDTH, Observations
from prime_core.errors import DatasetError
from prime_core.learning.parameter_layout import POINTS, YAW
from prime_core.rotations import gripper_down, wrap_angle

POINT, DISPLACEMENT = POINTS
NEAR = 0.03
"""How far ahead of the gripper ``near`` lies at most along each axis [m]."""


class ParameterPlaces:
    """Which of a primitive's parameters are what.

    Args:
        space: Its parameters.

    Attributes:
        point: Places of x, y, z.
        yaw: Place of the yaw; None where there is none.
        displacement: Places of dx, dy, dz; empty where there is none.
        numbers: Places of all others.

    Raises:
        DatasetError: If there is no point.
    """

    def __init__(self, space: ParameterSpace) -> None:
        names = [item.name for item in space.parameters]
        if not set(POINT) <= set(names):
            raise DatasetError(
                f"a primitive with the parameters {names} cannot be learned: "
                f"{', '.join(POINT)} [m] must be among them, for its motion is seen from there"
            )
        self.point = [names.index(name) for name in POINT]
        self.yaw = names.index(YAW) if YAW in names else None
        whole = set(DISPLACEMENT) <= set(names)
        self.displacement = [names.index(name) for name in DISPLACEMENT] if whole else []
        taken = {*self.point, self.yaw, *self.displacement}
        self.numbers = [place for place in range(len(names)) if place not in taken]

    def seen_from(self, parameters: Array, position: Array, yaw: float) -> Array:
        """Return parameters ``(P,)`` as they are seen from a pose in the world.

        Args:
            parameters: World frame.
            position: Of the pose [m], ``(3,)``.
            yaw: Of the pose [rad].
        """
        result = np.array(parameters, dtype=np.float64)
        result[self.point] = turned(result[self.point] - position, -yaw)
        return self._restturned(result, -yaw)

    def placed_at(self, seen: Array, position: Array, yaw: float) -> Array:
        """Return the parameters in the world that are seen so from a pose; see `seen_from`."""
        result = np.array(seen, dtype=np.float64)
        result[self.point] = position + turned(result[self.point], yaw)
        return self._restturned(result, yaw)

    def _restturned(self, parameters: Array, yaw: float) -> Array:
        if self.displacement:
            parameters[self.displacement] = turned(parameters[self.displacement], yaw)
        if self.yaw is not None:
            parameters[self.yaw] = wrap_angle(parameters[self.yaw] + yaw, JAW_PERIOD)
        return parameters

    @property
    def description(self) -> SceneDescription:
        """What scenes in the frame of a call are like."""
        objects = ["goal", "near", "floor", *["end"] * bool(self.displacement)]
        objects += [f"numbers-{index}" for index in range(-(-len(self.numbers) // 3))]
        return SceneDescription(
            # The jaws repeat after half a turn; all others are points.
            objects=tuple(ObjectDescription(name, 2 * (name == "goal")) for name in objects),
            workspace_low=(-2.0, -2.0, -2.0),
            workspace_high=(2.0, 2.0, 2.0),
            lift_height=0.0,
            joint_count=0,
        )


class CallFrame:
    """The frame of one call.

    Args:
        places: Of the primitive's parameters.
        parameters: Of the call, ``(P,)``, world frame.
        position: Of the gripper where the motion starts [m], ``(3,)``.
        yaw: Of the gripper there [rad]: of the two yaws that the jaws do not tell apart, the one
            with the shorter turn is the goal's.
    """

    def __init__(
        self, places: ParameterPlaces, parameters: Array, position: Array, yaw: float
    ) -> None:
        self._origin = parameters[places.point]
        self._yaw = 0.0
        if places.yaw is not None:
            self._yaw = yaw + float(wrap_angle(parameters[places.yaw] - yaw, JAW_PERIOD))
        ahead = parameters[places.displacement] if places.displacement else self._origin - position
        self._axis = float(np.arctan2(ahead[1], ahead[0]))
        points = [np.zeros(3), np.zeros(3), np.array([0.0, 0.0, -self._origin[2]])]
        if places.displacement:
            points.append(turned(ahead, -self._axis))
        numbers = parameters[places.numbers]
        numbers = np.append(numbers, np.zeros(-len(numbers) % 3))
        points += [*numbers.reshape(-1, 3)]
        objects = np.zeros((len(points), OBJECT_WIDTH), dtype=np.float32)
        objects[:, :3], objects[:, 3] = points, 1.0
        self._objects = objects

    def observations(
        self, positions: Floats, yaws: Floats, openings: Floats, holding: Flags
    ) -> Observations:
        """Return what is seen in the frame at ``N`` instants.

        Args:
            positions: Of the gripper [m], world frame, ``(N, 3)``.
            yaws: Of the gripper [rad], world frame, ``(N,)``.
            openings: Of the fingers [m], ``(N,)``.
            holding: Whether something is held, ``(N,)``.
        """
        count = len(positions)
        state = np.zeros((count, 8), dtype=np.float32)
        state[:, :3] = turned(positions - self._origin, -self._axis)
        state[:, 3:7] = gripper_down(yaws - self._yaw)
        state[:, 7] = openings
        objects = np.repeat(self._objects[None], count, axis=0)
        objects[:, 0, 7] = holding
        objects[:, 1, :3] = state[:, :3] + np.clip(-state[:, :3], -NEAR, NEAR)
        return Observations(state, objects.reshape(count, -1))

    def actions_in(self, actions: Floats) -> Floats:
        """Return motor actions of the world, ``(N, 5)``, as they are in the frame."""
        return self._with_moves(actions, -self._axis)

    def action_out(self, action: Array) -> Array:
        """Return a motor action of the frame, ``(5,)``, as it is in the world."""
        return self._with_moves(action, self._axis)

    @staticmethod
    def _with_moves(actions: Floats, yaw: float) -> Floats:
        result = np.array(actions, dtype=np.float64)
        result[..., :3] = turned(result[..., :3], yaw)
        return result


def turned(points: Floats, yaw: float) -> Floats:
    """Return points ``(..., 3)`` turned about z by a yaw [rad]."""
    cosine, sine = np.cos(yaw), np.sin(yaw)
    x, y, z = np.moveaxis(np.asarray(points, dtype=np.float64), -1, 0)
    return np.stack((cosine * x - sine * y, sine * x + cosine * y, z), axis=-1)
