"""What a primitive, a model or a policy may know of the world: the scene.

Lengths are metres, angles radians, quaternions w-x-y-z; poses are in the world frame.

A scene has a part that never changes in an environment, its `SceneDescription`, and the
poses of one instant, the `Scene`. The poses of one instant travel as two flat vectors under
LeRobot's names:

- ``observation.state``: gripper position (3), gripper quaternion (4), gripper opening (1),
  arm joint positions (J);
- ``observation.environment_state``: for each object in turn, position (3), quaternion (4),
  and 1 if the gripper holds it, else 0.
"""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from prime_core.arrays import Array
from prime_core.contracts.description import SceneDescription
from prime_core.contracts.observations import ENVIRONMENT_STATE_KEY, STATE_KEY
from prime_core.rotations import yaw_of


@dataclass(frozen=True, eq=False)
class Scene:
    """The world at one instant.

    Attributes:
        description: What never changes.
        gripper_position: Of the point between the fingertips [m], ``(3,)``.
        gripper_quaternion: ``(4,)``; a half turn about x at yaw 0 when it points down.
        gripper_opening: Distance between the fingers [m].
        joint_positions: Of the arm [rad], ``(J,)``.
        object_positions: [m], ``(number of objects, 3)``.
        object_quaternions: ``(number of objects, 4)``.
        held: Name of the object between the fingers, touched from both sides, or None.
    """

    description: SceneDescription = field(repr=False)
    gripper_position: Array
    gripper_quaternion: Array
    gripper_opening: float
    joint_positions: Array
    object_positions: Array
    object_quaternions: Array
    held: str | None

    @cached_property
    def gripper_yaw(self) -> float:
        """Yaw of the gripper [rad], in ``[-pi, pi)``."""
        return float(yaw_of(self.gripper_quaternion))

    def object_index(self, name: str) -> int:
        """Return the row of an object in the object arrays.

        Raises:
            KeyError: If the scene has no such object.
        """
        for index, item in enumerate(self.description.objects):
            if item.name == name:
                return index
        raise KeyError(name)

    def observation(self) -> dict[str, NDArray[np.float32]]:
        """Return the scene as observation vectors (float32)."""
        held = [[item.name == self.held] for item in self.description.objects]
        objects = np.hstack((self.object_positions, self.object_quaternions, held))
        state = np.concatenate(
            (
                self.gripper_position,
                self.gripper_quaternion,
                [self.gripper_opening],
                self.joint_positions,
            )
        )
        return {
            STATE_KEY: state.astype(np.float32),
            ENVIRONMENT_STATE_KEY: objects.ravel().astype(np.float32),
        }
