"""Features match what a hand computes, and what looks the same has the same features."""

import numpy as np
import pytest
from numpy.typing import NDArray

from prime_core.contracts.description import ObjectDescription, SceneDescription
from prime_core.contracts.observations import Observations
from prime_core.learning.scene_features import FeatureEncoder
from prime_core.rotations import gripper_down, quaternion_product

Array = NDArray[np.float64]

DESCRIPTION = SceneDescription(
    objects=(
        ObjectDescription("carton", yaw_symmetry=4),
        ObjectDescription("nut", yaw_symmetry=1),
        ObjectDescription("can", yaw_symmetry=0),
    ),
    workspace_low=(-1.0, -1.0, 0.0),
    workspace_high=(1.0, 1.0, 1.0),
    lift_height=1.0,
    joint_count=2,
)
ENCODER = FeatureEncoder(DESCRIPTION)
GRIPPER = ["x", "y", "z", "opening", "yaw_sin", "yaw_cos", "yaw"]
POSE = ["x", "y", "z", "relative_x", "relative_y", "relative_z", "up_x", "up_y", "up_z"]
POSE += ["lying_sin", "lying_cos"]
YAW = ["yaw_sin", "yaw_cos", "relative_yaw_sin", "relative_yaw_cos", "relative_yaw"]
NAMES = [
    *(f"gripper.{part}" for part in GRIPPER),
    *(f"{name}.{part}" for name in ("carton", "nut") for part in [*POSE, *YAW, "held"]),
    *(f"can.{part}" for part in [*POSE, "held"]),
]
UPRIGHT = np.array([1.0, 0.0, 0.0, 0.0])


def turn(axis: str, angle: float) -> Array:
    quaternion = np.zeros(4)
    quaternion[0], quaternion["wxyz".index(axis)] = np.cos(angle / 2), np.sin(angle / 2)
    return quaternion


def features(
    gripper_yaw: float = 0.0,
    carton: Array = UPRIGHT,
    nut: Array = UPRIGHT,
    can: Array = UPRIGHT,
    held: str = "",
) -> dict[str, float]:
    """Return the features, by name, of a scene with everything at a fixed place."""
    state = np.array([0.1, 0.2, 0.3, *gripper_down(gripper_yaw), 0.04, 0.5, 0.6])
    rows = []
    for item, quaternion in zip(DESCRIPTION.objects, (carton, nut, can), strict=True):
        rows += [0.5, 0.1, 0.2, *quaternion, float(item.name == held)]
    frames = Observations(state[None].astype(np.float32), np.array(rows, dtype=np.float32)[None])
    return dict(zip(NAMES, ENCODER.encode(frames)[0].tolist(), strict=True))


def assert_same(left: dict[str, float], right: dict[str, float], prefix: str = "") -> None:
    for name, value in left.items():
        if name.startswith(prefix):
            assert value == pytest.approx(right[name], abs=1e-5), name


def test_width_is_that_of_the_features() -> None:
    assert ENCODER.width == len(NAMES) == len(features()) == 7 + 17 + 17 + 12


def test_gripper_features_are_those_of_a_hand_computation() -> None:
    found = features(gripper_yaw=np.pi / 2 + 0.2)
    assert found["gripper.x"] == pytest.approx(0.1)
    assert found["gripper.opening"] == pytest.approx(0.04)
    assert found["gripper.yaw"] == pytest.approx(0.2 - np.pi / 2, abs=1e-5)
    assert found["gripper.yaw_sin"] == pytest.approx(np.sin(np.pi + 0.4), abs=1e-5)
    assert found["gripper.yaw_cos"] == pytest.approx(np.cos(np.pi + 0.4), abs=1e-5)


def test_object_features_are_those_of_a_hand_computation() -> None:
    found = features(gripper_yaw=0.3, carton=turn("z", 0.5), held="carton")
    assert found["carton.y"] == pytest.approx(0.1)
    assert found["carton.relative_x"] == pytest.approx(0.4)
    assert found["carton.relative_y"] == pytest.approx(-0.1)
    assert [found[f"carton.up_{axis}"] for axis in "xyz"] == pytest.approx([0, 0, 1], abs=1e-6)
    assert found["carton.yaw_sin"] == pytest.approx(np.sin(4 * 0.5), abs=1e-5)
    assert found["carton.yaw_cos"] == pytest.approx(np.cos(4 * 0.5), abs=1e-5)
    assert found["carton.relative_yaw_sin"] == pytest.approx(np.sin(4 * 0.2), abs=1e-5)
    assert found["carton.relative_yaw_cos"] == pytest.approx(np.cos(4 * 0.2), abs=1e-5)
    assert found["carton.relative_yaw"] == pytest.approx(0.2, abs=1e-5)
    assert (found["carton.held"], found["nut.held"], found["can.held"]) == (1, 0, 0)


def test_the_turn_to_an_object_is_the_shortest_of_those_that_look_the_same() -> None:
    found = features(gripper_yaw=0.0, carton=turn("z", 1.5), nut=turn("z", 3.0))
    assert found["carton.relative_yaw"] == pytest.approx(1.5 - np.pi / 2, abs=1e-5)
    assert found["nut.relative_yaw"] == pytest.approx(3.0 - np.pi, abs=1e-5)


def test_a_round_object_has_no_yaw() -> None:
    assert_same(features(), features(can=turn("z", 1.1)))


@pytest.mark.parametrize("tilt", [0.0, 0.4, np.pi / 2, 2.5])
def test_a_turn_by_the_symmetry_changes_nothing_however_the_object_lies(tilt: float) -> None:
    pose = quaternion_product(turn("y", tilt), turn("z", 0.3))
    turned = quaternion_product(pose, turn("z", np.pi / 2))
    assert_same(features(carton=pose), features(carton=turned), "carton.")
    assert features(nut=pose)["nut.yaw_sin"] != pytest.approx(features(nut=turned)["nut.yaw_sin"])


def test_half_a_turn_of_the_gripper_changes_nothing() -> None:
    pose = quaternion_product(turn("x", 0.3), turn("z", 0.4))
    near = features(gripper_yaw=0.3, carton=pose, nut=pose, can=pose)
    assert_same(near, features(gripper_yaw=0.3 - np.pi, carton=pose, nut=pose, can=pose))


def test_the_sign_of_a_quaternion_changes_nothing() -> None:
    pose = quaternion_product(turn("x", 0.7), turn("z", 2.0))
    assert_same(features(nut=pose, can=pose), features(nut=-pose, can=-pose))


def test_how_a_fallen_object_lies_is_seen_from_the_gripper() -> None:
    # Its z axis points along the world's y axis: a quarter turn from a gripper at yaw 0.
    along_y = features(can=turn("x", -np.pi / 2))
    assert along_y["can.up_y"] == pytest.approx(1, abs=1e-6)
    assert along_y["can.lying_cos"] == pytest.approx(-1, abs=1e-5)
    turned = features(gripper_yaw=np.pi / 2, can=turn("x", -np.pi / 2))
    assert turned["can.lying_cos"] == pytest.approx(1, abs=1e-5)
    assert features()["can.lying_cos"] == pytest.approx(0, abs=1e-6)


def test_nothing_jumps_as_an_object_falls_upside_down() -> None:
    past, before = (features(nut=turn("x", np.pi + step)) for step in (1e-3, -1e-3))
    for name, value in past.items():
        assert value == pytest.approx(before[name], abs=5e-3), name


def test_many_frames_are_encoded_as_each_alone() -> None:
    generator = np.random.default_rng(0)
    quaternions = generator.normal(size=(70_000, 4))
    quaternions /= np.linalg.norm(quaternions, axis=1, keepdims=True)
    state = np.zeros((70_000, DESCRIPTION.state_width), np.float32)
    state[:, 3:7] = gripper_down(generator.uniform(-3, 3, 70_000))
    objects = np.zeros((70_000, DESCRIPTION.environment_state_width), np.float32)
    objects[:, 3:7] = objects[:, 11:15] = objects[:, 19:23] = quaternions
    frames = Observations(state, objects)
    encoded = ENCODER.encode(frames)
    assert encoded.dtype == np.float32 and encoded.shape == (70_000, ENCODER.width)
    for index in (0, 65_535, 65_536, 69_999):
        alone = ENCODER.encode(frames[np.array([index])])
        np.testing.assert_allclose(alone[0], encoded[index], rtol=1e-6, atol=1e-6)


def test_no_frames_have_no_features() -> None:
    state = np.zeros((0, DESCRIPTION.state_width), np.float32)
    none = Observations(state, np.zeros((0, DESCRIPTION.environment_state_width), np.float32))
    assert ENCODER.encode(none).shape == (0, ENCODER.width)
