"""Observations, actions, the arm's description and imports."""

import subprocess
import sys
import warnings
from collections.abc import Callable
from typing import Any

import mujoco
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

from prime_core.contracts.observations import IMAGE_PREFIX, Observations
from prime_core.contracts.scene import Scene
from prime_core.errors import PrimeError
from prime_core.rotations import gripper_down
from prime_envs_robosuite.config import LiftConfig, PickPlaceConfig
from prime_envs_robosuite.environment import RobosuiteEnvironment


@pytest.fixture(params=["lift", "milk"])
def environment(request: pytest.FixtureRequest) -> RobosuiteEnvironment:
    found = request.getfixturevalue(request.param)
    assert isinstance(found, RobosuiteEnvironment)
    return found


def test_importing_the_package_imports_no_heavy_library() -> None:
    heavy = "{'robosuite', 'mujoco', 'numba', 'cv2', 'torch'}"
    code = f"import sys, prime_envs_robosuite; print(sorted({heavy} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_building_says_nothing() -> None:
    code = "from prime_envs_robosuite.config import LiftConfig as L; L(stepping='stock').build()"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert (done.stdout, done.stderr) == ("", "")


def test_building_leaves_the_global_random_state_alone() -> None:
    np.random.seed(5)
    expected = np.random.rand()
    np.random.seed(5)
    LiftConfig().build()
    assert np.random.rand() == expected


def test_gymnasium_accepts_it() -> None:
    fresh = LiftConfig(horizon=50).build()
    with warnings.catch_warnings():
        # The state vectors are unbounded, and the environment is not made by gymnasium.make.
        warnings.filterwarnings("ignore", category=UserWarning)
        check_env(fresh, skip_render_check=True)


def test_observations_are_the_scene_in_the_declared_layout(
    environment: RobosuiteEnvironment,
) -> None:
    observation, info = environment.reset(seed=7)
    assert environment.observation_space.contains(observation)
    assert info == {"is_success": False}
    for _ in range(3):
        observation, *_ = environment.step(np.array([0.02, -0.02, 0.01, 0.1, 1.0]))
        scene = environment.scene()
        for key, value in scene.observation().items():
            np.testing.assert_array_equal(observation[key], value)
        read = Scene.read(environment.description, Observations.single(observation))
        np.testing.assert_allclose(read.gripper_position, scene.gripper_position, atol=1e-6)
        np.testing.assert_allclose(read.object_positions, scene.object_positions, atol=1e-6)
        assert read.gripper_opening == pytest.approx(scene.gripper_opening, abs=1e-6)


def test_actions_move_the_gripper_in_the_world_frame_and_keep_it_down(
    environment: RobosuiteEnvironment,
) -> None:
    environment.reset(seed=8)
    before = environment.scene()
    for _ in range(12):
        environment.step(np.array([0.03, 0.03, 0.0, 0.2, -1.0]))
    after = environment.scene()
    moved = after.gripper_position - before.gripper_position
    assert moved[0] > 0.05
    assert moved[1] > 0.05
    assert abs(moved[2]) < 0.02
    assert after.gripper_yaw - before.gripper_yaw > 0.3
    down = gripper_down(after.gripper_yaw)
    assert abs(float(down @ after.gripper_quaternion)) > np.cos(0.05 / 2)
    assert after.gripper_opening > 0.075


def test_greater_actions_are_clipped(lift: RobosuiteEnvironment) -> None:
    lift.reset(seed=9)
    start = lift.get_state()
    lift.step(np.array([0.05, -0.05, 0.05, 0.5, 1.0]))
    expected = lift.get_state()
    lift.set_state(start)
    lift.step(np.array([9.0, -9.0, 9.0, 9.0, 9.0]))
    np.testing.assert_array_equal(lift.get_state(), expected)


@pytest.mark.parametrize("action", [np.zeros(7), np.full(5, np.nan)])
def test_what_is_no_action_is_refused(lift: RobosuiteEnvironment, action: Any) -> None:
    with pytest.raises(PrimeError, match="5 finite numbers"):
        lift.step(action)


def test_the_described_arm_has_the_same_kinematics(environment: RobosuiteEnvironment) -> None:
    robot = environment.description.robot
    assert robot is not None
    model = mujoco.MjModel.from_xml_string(robot.mjcf)
    data = mujoco.MjData(model)
    addresses = [model.joint(name).qposadr[0] for name in robot.joint_names]
    environment.reset(seed=10)
    for action in np.random.default_rng(1).uniform(-0.05, 0.05, (5, 5)):
        environment.step(action)
        scene = environment.scene()
        data.qpos[addresses] = scene.joint_positions
        mujoco.mj_kinematics(model, data)
        site = data.site(robot.end_effector)
        np.testing.assert_allclose(site.xpos, scene.gripper_position, atol=1e-9)
        quaternion = np.empty(4)
        mujoco.mju_mat2Quat(quaternion, site.xmat)
        assert abs(quaternion @ scene.gripper_quaternion) == pytest.approx(1.0, abs=1e-9)
    for name in (*robot.hand_geoms, *robot.furniture_geoms):
        assert model.geom(name).type == mujoco.mjtGeom.mjGEOM_BOX


def test_the_described_furniture_is_where_objects_come_to_rest(
    milk: RobosuiteEnvironment, hand: Callable[[RobosuiteEnvironment], Any]
) -> None:
    milk.reset(seed=12)
    hand(milk).grip(-1.0, 10)
    robot = milk.description.robot
    assert robot is not None
    model = mujoco.MjModel.from_xml_string(robot.mjcf)
    floor = model.body("bin1").pos + model.geom("bin1_0").pos + [0, 0, model.geom("bin1_0").size[2]]
    lowest = milk.scene().object_positions[0, 2] - 0.061  # the milk's mesh, below its centre
    assert lowest == pytest.approx(floor[2], abs=0.002)


def test_a_camera_that_is_not_there_is_named_with_those_that_are() -> None:
    with pytest.raises(PrimeError, match=r"no camera 'wirst'; there are: agentview, .*wrist"):
        LiftConfig(cameras=("wirst",)).build()


def test_images_come_on_request() -> None:
    seeing = PickPlaceConfig(cameras=("agentview", "wrist"), image_size=32).build()
    try:
        observation, _ = seeing.reset(seed=0)
    except PrimeError as error:
        assert "MUJOCO_GL" in str(error)
        pytest.skip(f"no library to render with: {error}")
    assert seeing.observation_space.contains(observation)
    first = observation[IMAGE_PREFIX + "agentview"]
    assert first.std() > 10
    for _ in range(10):
        observation, *_ = seeing.step(np.array([0.0, -0.05, -0.05, 0.0, -1.0]))
    later = observation[IMAGE_PREFIX + "agentview"]
    assert np.abs(first.astype(int) - later).mean() > 0.5
    assert observation[IMAGE_PREFIX + "wrist"].std() > 10
    seeing.close()
