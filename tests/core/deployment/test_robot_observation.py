"""What is wrong with what a robot saw is told by its key."""

from typing import Any

import numpy as np
import pytest

from prime_core.contracts.description import ObjectDescription, SceneDescription
from prime_core.contracts.images import CameraConfig
from prime_core.contracts.observations import Modality
from prime_core.deployment.robot_observation import ObservationError, read_observation

DESCRIPTION = SceneDescription(
    objects=(ObjectDescription("cube"),),
    workspace_low=(0.0, 0.0, 0.0),
    workspace_high=(1.0, 1.0, 1.0),
    lift_height=0.5,
    joint_count=2,
)
CAMERAS = CameraConfig(cameras=("front",), size=8)
ALL: tuple[Modality, ...] = ("proprioception", "objects", "images")
STATE, OBJECTS, FRONT = (
    "observation.state",
    "observation.environment_state",
    "observation.images.front",
)


def good() -> dict[str, Any]:
    return {
        STATE: [0.5, 0, 0.2, 0, 1, 0, 0, 0.04, 0.1, 0.2],
        OBJECTS: np.array([0.5, 0, 0.02, 1, 0, 0, 0, 0]),
        FRONT: np.full((8, 8, 3), 7, dtype=np.uint8),
        "observation.images.back": "is not looked at",
    }


def read(observation: dict[str, Any], sees: tuple[Modality, ...] = ALL) -> Any:
    return read_observation(observation, DESCRIPTION, sees, CAMERAS)


def test_what_the_policy_sees_is_read_and_no_more() -> None:
    seen = read(good())
    assert seen.state.dtype == np.float32
    assert seen.state.shape == (1, 10)
    assert seen.object_positions.tolist() == [[[0.5, 0, np.float32(0.02)]]]
    assert seen.images["front"].shape == (1, 8, 8, 3)
    assert [*seen.images] == ["front"]
    bare = read({STATE: good()[STATE]}, ("proprioception",))
    assert bare.environment_state is None
    assert not bare.images


@pytest.mark.parametrize(
    ("change", "text"),
    [
        (
            {STATE: None},
            r"observation\.state: is missing, found observation\.environment_state, .*: it must be "
            r"10 numbers: gripper\.x, .*, gripper\.opening, joint_0, joint_1",
        ),
        (
            {STATE: np.zeros(9)},
            r"observation\.state: found the shape \(9,\): it must be 10 numbers",
        ),
        ({STATE: np.zeros((1, 10))}, r"observation\.state: found the shape \(1, 10\)"),
        ({STATE: "home"}, r"observation\.state: is no array of numbers"),
        ({STATE: [np.nan] * 10}, r"observation\.state: gripper\.x is nan: it must be a finite"),
        (
            {STATE: np.zeros(10)},
            r"observation\.state: the quaternion of the gripper, \[0\.0, .*\], has the length 0: "
            r"it must be 1, in the order w, x, y, z",
        ),
        ({OBJECTS: None}, r"environment_state: is missing, .*: it must be 8 numbers: cube\.x, "),
        ({OBJECTS: np.zeros(8)}, r"environment_state: the quaternion of cube, .* length 0"),
        (
            {FRONT: np.zeros((3, 8, 8), dtype=np.uint8)},
            r"images\.front: found \(3, 8, 8\) uint8: it must be \(8, 8, 3\) uint8: rows from the "
            r"top, red, green, blue",
        ),
        ({FRONT: np.zeros((8, 8, 3))}, r"images\.front: found \(8, 8, 3\) float64: it must be"),
        ({FRONT: None}, r"observation\.images\.front: is missing, found .*images\.back"),
    ],
)
def test_what_is_wrong_is_told_by_its_key(change: dict[str, Any], text: str) -> None:
    changed = {key: value for key, value in {**good(), **change}.items() if value is not None}
    with pytest.raises(ObservationError, match=text):
        read(changed)
