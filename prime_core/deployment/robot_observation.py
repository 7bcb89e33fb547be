"""Reads what a robot saw at one instant, and says what is wrong with it."""

from collections.abc import Collection, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from prime_core.contracts.description import SceneDescription
from prime_core.contracts.images import CameraConfig
from prime_core.contracts.observations import (
    ENVIRONMENT_STATE_KEY,
    IMAGE_PREFIX,
    OBJECT_WIDTH,
    STATE_KEY,
    Modality,
    Observations,
)
from prime_core.errors import PrimeError

NORM_TOLERANCE = 0.05
"""Of a quaternion's length from 1."""

QUATERNION = 3
"""Where it begins in the numbers of the gripper, and in those of an object."""


class ObservationError(PrimeError):
    """An observation is not what a policy can look at. The text names the key."""


def observation_keys(sees: Collection[Modality], cameras: CameraConfig | None) -> tuple[str, ...]:
    """Return the keys that a policy looks at; see `read_observation`."""
    shown = cameras.cameras if "images" in sees and cameras is not None else ()
    objects = (ENVIRONMENT_STATE_KEY,) if "objects" in sees else ()
    return (STATE_KEY, *objects, *(IMAGE_PREFIX + camera for camera in shown))


def read_observation(
    observation: Mapping[str, Any],
    description: SceneDescription,
    sees: Collection[Modality],
    cameras: CameraConfig | None,
) -> Observations:
    """Return one instant, ``N = 1``, of what a policy looks at; other keys are left alone.

    Args:
        observation: By LeRobot's keys; see `prime_core.contracts.observations`.
        description: Of the scenes that the policy knows.
        sees: What the policy looks at.
        cameras: What it sees images through; None where it sees none.

    Raises:
        ObservationError: If a key is missing, or its value has another shape or type, numbers that
            are not finite, or quaternions that are none.
    """
    found: dict[str, NDArray[Any]] = {}
    for key in observation_keys(sees, cameras):
        if key.startswith(IMAGE_PREFIX):
            assert cameras is not None, "only cameras give such keys"
            found[key] = _image(observation, key, cameras.size)
        elif key == STATE_KEY:
            gripper = {"the gripper": QUATERNION}
            found[key] = _vector(observation, key, description.state_names, gripper)
        else:
            objects = {
                item.name: OBJECT_WIDTH * index + QUATERNION
                for index, item in enumerate(description.objects)
            }
            found[key] = _vector(observation, key, description.environment_state_names, objects)
    return Observations.single(found)


def _vector(
    observation: Mapping[str, Any], key: str, names: Sequence[str], quaternions: Mapping[str, int]
) -> NDArray[np.float32]:
    wanted = f"it must be {len(names)} numbers: {', '.join(names)}"
    try:
        values = np.asarray(_value(observation, key, wanted), dtype=np.float32)
    except (TypeError, ValueError) as error:
        raise ObservationError(f"{key}: is no array of numbers ({error}): {wanted}") from None
    if values.shape != (len(names),):
        raise ObservationError(f"{key}: found the shape {values.shape}: {wanted}")
    for name, value in zip(names, values, strict=True):
        if not np.isfinite(value):
            raise ObservationError(f"{key}: {name} is {value}: it must be a finite number")
    for name, first in quaternions.items():
        norm = float(np.linalg.norm(values[first : first + 4]))
        if abs(norm - 1) > NORM_TOLERANCE:
            raise ObservationError(
                f"{key}: the quaternion of {name}, {values[first : first + 4].tolist()}, has the "
                f"length {norm:.3g}: it must be 1, in the order w, x, y, z"
            )
    return values


def _image(observation: Mapping[str, Any], key: str, size: int) -> NDArray[np.uint8]:
    wanted = f"it must be ({size}, {size}, 3) uint8: rows from the top, red, green, blue"
    image = np.asarray(_value(observation, key, wanted))
    if image.shape != (size, size, 3) or image.dtype != np.uint8:
        raise ObservationError(f"{key}: found {image.shape} {image.dtype}: {wanted}")
    return image


def _value(observation: Mapping[str, Any], key: str, wanted: str) -> Any:
    if key not in observation:
        found = ", ".join(sorted(map(str, observation))) or "nothing"
        raise ObservationError(f"{key}: is missing, found {found}: {wanted}")
    return observation[key]
