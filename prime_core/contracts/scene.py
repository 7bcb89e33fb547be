"""What a primitive may know at one instant: the scene."""

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from prime_core.arrays import Array
from prime_core.contracts.description import SceneDescription
from prime_core.contracts.observations import (
    ENVIRONMENT_STATE_KEY,
    STATE_KEY,
    Observations,
)
from prime_core.errors import UnknownObjectsError
from prime_core.rotations import yaw_of

EMPTY_OPENING = 0.004
"""Opening up to which closed fingers hold nothing [m]; `benchmarks/holding.py` measures it."""

STILL_FINGERS = 5e-4
"""Change of the opening from one instant to the next up to which the fingers do not move [m]."""


@dataclass(frozen=True, eq=False)
class ObjectPoses:
    """Where the objects are.

    Attributes:
        positions: [m], ``(objects, 3)``, in the order of ``SceneDescription.objects``.
        quaternions: ``(objects, 4)``.
        held: Name of the object between the fingers, touched from both sides, or None.
    """

    positions: Array
    quaternions: Array
    held: str | None


@dataclass(frozen=True, eq=False)
class Scene:
    """The robot and, where they are known, the objects at one instant; world frame.

    Attributes:
        description: What never changes.
        gripper_position: Of the point between the fingertips [m], ``(3,)``.
        gripper_quaternion: ``(4,)``; a half turn about x at yaw 0 when it points down.
        gripper_opening: Distance between the fingers [m].
        joint_positions: Of the arm [rad], ``(J,)``.
        objects: Where the objects are; None where that is not known.
        gripper_command: The gripper's last command, from -1 (open) to 1 (close); None where none
            was sent yet, or it is not known.
        fingers_move: Whether the opening is another one than at the instant before.
    """

    description: SceneDescription = field(repr=False)
    gripper_position: Array
    gripper_quaternion: Array
    gripper_opening: float
    joint_positions: Array
    objects: ObjectPoses | None = None
    gripper_command: float | None = None
    fingers_move: bool = False

    @classmethod
    def read(
        cls,
        description: SceneDescription,
        seen: Observations,
        gripper_command: float | None = None,
        opening_before: float | None = None,
    ) -> Self:
        """Read one observation.

        Args:
            description: Of the environment.
            seen: One instant, ``N = 1``.
            gripper_command: The gripper's last command, where it is known.
            opening_before: Distance between the fingers at the instant before [m], likewise.
        """
        state = seen.state[0].astype(np.float64)
        objects = None
        if seen.environment_state is not None:
            held = np.flatnonzero(seen.held[0])
            objects = ObjectPoses(
                positions=seen.object_positions[0].astype(np.float64),
                quaternions=seen.object_quaternions[0].astype(np.float64),
                held=description.objects[held[0]].name if held.size else None,
            )
        opening = float(state[7])
        before = opening if opening_before is None else opening_before
        return cls(
            description=description,
            gripper_position=state[:3],
            gripper_quaternion=state[3:7],
            gripper_opening=opening,
            joint_positions=state[8:],
            objects=objects,
            gripper_command=gripper_command,
            fingers_move=abs(opening - before) > STILL_FINGERS,
        )

    @cached_property
    def gripper_yaw(self) -> float:
        """Yaw of the gripper [rad], in ``[-pi, pi)``."""
        return float(yaw_of(self.gripper_quaternion))

    @property
    def holding(self) -> bool:
        """Whether the gripper holds something.

        Known of the objects where they are known; else told from the gripper: it was told to
        close, and its fingers are apart and still. On their way they hold nothing yet.
        """
        if self.objects is not None:
            return self.objects.held is not None
        closing = self.gripper_command is not None and self.gripper_command > 0
        return closing and not self.fingers_move and self.gripper_opening > EMPTY_OPENING

    @property
    def known_objects(self) -> ObjectPoses:
        """Where the objects are.

        Raises:
            UnknownObjectsError: If that is not known.
        """
        if self.objects is None:
            raise UnknownObjectsError
        return self.objects

    @property
    def object_positions(self) -> Array:
        """[m], ``(objects, 3)``; see `known_objects`."""
        return self.known_objects.positions

    @property
    def object_quaternions(self) -> Array:
        """``(objects, 4)``; see `known_objects`."""
        return self.known_objects.quaternions

    @property
    def held(self) -> str | None:
        """Name of the object between the fingers, or None; see `known_objects`."""
        return self.known_objects.held

    def object_index(self, name: str) -> int:
        """Return the row of an object in the object arrays.

        Raises:
            KeyError: If the scene has no such object.
        """
        for index, item in enumerate(self.description.objects):
            if item.name == name:
                return index
        raise KeyError(name)

    def observation(self) -> dict[str, NDArray[Any]]:
        """Return the scene as observation vectors (float32), by LeRobot's keys."""
        state = np.concatenate(
            (
                self.gripper_position,
                self.gripper_quaternion,
                [self.gripper_opening],
                self.joint_positions,
            )
        )
        vectors = {STATE_KEY: state.astype(np.float32)}
        if self.objects is not None:
            held = [[item.name == self.objects.held] for item in self.description.objects]
            flags = np.array(held, dtype=np.float64).reshape(-1, 1)
            objects = np.hstack((self.objects.positions, self.objects.quaternions, flags))
            vectors[ENVIRONMENT_STATE_KEY] = objects.ravel().astype(np.float32)
        return vectors
