"""Observations: what was seen at many instants, as arrays.

Lengths are metres, angles radians, quaternions w-x-y-z; poses are in the world frame. Robot state
and object poses travel as two flat vectors under LeRobot's names:

- ``observation.state``: gripper position (3), gripper quaternion (4), gripper opening (1),
  arm joint positions (J);
- ``observation.environment_state``: for each object in turn, position (3), quaternion (4),
  and 1 if the gripper holds it, else 0.

Images are ``observation.images.NAME``.
"""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal, Self

import numpy as np
from numpy.typing import NDArray

from prime_core.arrays import Array, Indices
from prime_core.contracts.images import ChosenImages, Images
from prime_core.rotations import yaw_of

STATE_KEY = "observation.state"
ENVIRONMENT_STATE_KEY = "observation.environment_state"
IMAGE_PREFIX = "observation.images."

GRIPPER_WIDTH = 8  # gripper position, quaternion and opening in the state vector
OBJECT_WIDTH = 8  # position, quaternion and held flag of one object

Modality = Literal["proprioception", "objects", "images"]
"""What a model may see: robot state, object poses, images."""


@dataclass(frozen=True, eq=False)
class Observations:
    """What was seen at ``N`` instants; one live instant is ``N = 1``.

    Attributes:
        state: ``observation.state``, ``(N, 8 + J)`` float32.
        environment_state: ``observation.environment_state``, ``(N, 8 * objects)`` float32; None
            where object poses are not known.
        images: By camera, ``(N, H, W, 3)`` uint8; nothing is read before it is indexed.
    """

    state: NDArray[np.float32]
    environment_state: NDArray[np.float32] | None = None
    images: Mapping[str, Images] = field(default_factory=dict)

    @classmethod
    def single(cls, observation: Mapping[str, NDArray[Any]]) -> Self:
        """Return one instant, ``N = 1``.

        Args:
            observation: By LeRobot's keys, as an environment gives it.
        """
        objects = observation.get(ENVIRONMENT_STATE_KEY)
        return cls(
            state=np.asarray(observation[STATE_KEY], dtype=np.float32)[None],
            environment_state=None if objects is None else np.asarray(objects, np.float32)[None],
            images={
                key.removeprefix(IMAGE_PREFIX): image[None]
                for key, image in observation.items()
                if key.startswith(IMAGE_PREFIX)
            },
        )

    @classmethod
    def join(cls, parts: Sequence[Self]) -> Self:
        """Return the instants of several observations one after another; images stay unread.

        Raises:
            ValueError: If there is none, or only some of them have object poses or an image.
        """
        if not parts:
            raise ValueError("there are no observations to join")
        objects = [item.environment_state for item in parts]
        cameras = set(parts[0].images)
        known = [item for item in objects if item is not None]
        if len(known) not in (0, len(parts)) or any(set(p.images) != cameras for p in parts):
            raise ValueError("observations that are joined must see the same")
        return cls(
            state=np.concatenate([item.state for item in parts]),
            environment_state=np.concatenate(known) if known else None,
            images={
                name: ChosenImages.joined([item.images[name] for item in parts])
                for name in parts[0].images
            },
        )

    def __len__(self) -> int:
        return len(self.state)

    def __getitem__(self, rows: slice | Indices) -> Self:
        """Return some instants.

        Args:
            rows: Their rows. A slice of a memory map stays one; rows of an array are read.
        """
        objects = self.environment_state
        return type(self)(
            self.state[rows],
            None if objects is None else objects[rows],
            {name: images[rows] for name, images in self.images.items()},
        )

    def only(self, sees: Collection[Modality]) -> Self:
        """Return what a model that declares what it sees may see: the one door to every model.

        Raises:
            ValueError: If it sees object poses or images where there are none.
        """
        if "objects" in sees and self.environment_state is None:
            raise ValueError("the model sees objects, but object poses are not known here")
        if "images" in sees and not self.images:
            raise ValueError("the model sees images, but there are none here")
        return type(self)(
            self.state,
            self.environment_state if "objects" in sees else None,
            self.images if "images" in sees else {},
        )

    @property
    def gripper_position(self) -> NDArray[np.float32]:
        """Of the point between the fingertips [m], ``(N, 3)``."""
        return self.state[:, :3]

    @property
    def gripper_quaternion(self) -> NDArray[np.float32]:
        """``(N, 4)``."""
        return self.state[:, 3:7]

    @property
    def gripper_yaw(self) -> Array:
        """[rad], in ``[-pi, pi)``, ``(N,)``."""
        return yaw_of(self.gripper_quaternion)

    @property
    def gripper_opening(self) -> NDArray[np.float32]:
        """Distance between the fingers [m], ``(N,)``."""
        return self.state[:, 7]

    @property
    def joint_positions(self) -> NDArray[np.float32]:
        """Of the arm [rad], ``(N, J)``."""
        return self.state[:, GRIPPER_WIDTH:]

    @property
    def object_positions(self) -> NDArray[np.float32]:
        """[m], ``(N, objects, 3)``."""
        return self._objects[:, :, :3]

    @property
    def object_quaternions(self) -> NDArray[np.float32]:
        """``(N, objects, 4)``."""
        return self._objects[:, :, 3:7]

    @property
    def held(self) -> NDArray[np.bool_]:
        """Whether each object is between the fingers, ``(N, objects)``."""
        flags: NDArray[np.bool_] = self._objects[:, :, 7] > 0.5
        return flags

    @property
    def _objects(self) -> NDArray[np.float32]:
        if self.environment_state is None:
            raise ValueError("object poses are not known in these observations")
        count = self.environment_state.shape[1] // OBJECT_WIDTH
        return self.environment_state.reshape(len(self), count, OBJECT_WIDTH)
