"""Recordings of all of robosuite's tasks come in, with the shapes and the order of their models."""

from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest
from numpy.typing import NDArray

from prime_core.contracts.demonstration import Demonstration
from prime_core.contracts.environment import EnvironmentConfig
from prime_core.errors import DatasetError
from prime_core.registry.fields import read_settings
from prime_envs_robosuite.config import LiftConfig, PickPlaceConfig, StackConfig, TaskConfig
from prime_envs_robosuite.environment import RobosuiteEnvironment
from prime_envs_robosuite.recordings.recorded_tasks import (
    RECORDED_TASKS,
    environment_of,
    recorded_task,
)
from prime_envs_robosuite.recordings.robosuite_hdf5 import RobosuiteHdf5Config
from prime_envs_robosuite.simulation.physics_model import physics_model

from .conftest import Hand
from .hdf5_files import FRAMES, good, record
from .test_foreign_hdf5 import FINGERS, JOINTS

Array = NDArray[np.float64]

HUMAN = Path(__file__).parents[3] / "shared" / "human_demos"
STACK = HUMAN / "stack_v1.0" / "demo.hdf5"
MODEL = "<mujoco><asset>{}</asset><worldbody>{}</worldbody></mujoco>"


def build(config: EnvironmentConfig) -> RobosuiteEnvironment:
    environment = config.build()
    assert isinstance(environment, RobosuiteEnvironment)
    return environment


def recorded(environment: RobosuiteEnvironment) -> Array:
    """Return states as robosuite records them: time, joint positions and velocities."""
    count = len(environment.description.objects)
    now = environment.get_state()[: 1 + 9 + 7 * count + 9 + 6 * count]
    states = np.tile(now, (FRAMES, 1))
    states[:, 0] = 0.05 * np.arange(FRAMES)
    return states


def read_one(path: Path, config: EnvironmentConfig) -> Demonstration:
    return RobosuiteHdf5Config(path=path).demonstrate(config, 0, 0)


@pytest.mark.parametrize("name", [*RECORDED_TASKS, "ToolHang"])
def test_each_recorded_task_has_its_environment(name: str) -> None:
    config = read_settings(EnvironmentConfig, environment_of(name))
    assert recorded_task(config, "x") == name
    assert recorded_task(TaskConfig(name=name, horizon=9), "x") == name
    objects = build(config).task.body_names
    assert set(objects) <= set(getattr(RECORDED_TASKS.get(name), "objects", objects))


def test_a_recording_of_another_choice_is_refused(tmp_path: Path) -> None:
    path = record(tmp_path / "a.hdf5", {"env": "PickPlace"}, demo_1=good(np.zeros((FRAMES, 72))))
    with pytest.raises(DatasetError, match="names 'PickPlace'; the environment takes recordings"):
        read_one(path, PickPlaceConfig(object="can"))


def test_objects_in_another_order_are_found_by_their_names(tmp_path: Path) -> None:
    config = PickPlaceConfig(object="all")
    environment = build(config)
    environment.reset(seed=2)
    states, now = recorded(environment), environment.scene()
    # robosuite 1.0 numbered objects and called joints jnt; here the can comes first.
    order = [3, 1, 0, 2]
    names = [["Milk", "Bread", "Cereal", "Can"][index] for index in order]
    bodies = [f'<body><joint name="{name}0_jnt0" type="free"/></body>' for name in names]
    positions, velocities = states[:, 10:38], states[:, 47:]
    shuffled = np.hstack(
        (
            states[:, :10],
            *(positions[:, 7 * index : 7 * index + 7] for index in order),
            states[:, 38:47],
            *(velocities[:, 6 * index : 6 * index + 6] for index in order),
        )
    )
    model = MODEL.format("", JOINTS + FINGERS + "".join(bodies))
    path = record(
        tmp_path / "a.hdf5", {"env": "PickPlace"}, demo_1=good(shuffled, model_file=model)
    )
    objects = read_one(path, config).observations.object_positions[0]
    np.testing.assert_allclose(objects, now.object_positions, atol=1e-6)


def test_without_a_model_robosuites_order_holds(tmp_path: Path) -> None:
    config = StackConfig()
    environment = build(config)
    environment.reset(seed=2)
    demo = good(recorded(environment))
    path = record(tmp_path / "a.hdf5", {"env": "Stack"}, demo_1=demo)
    objects = read_one(path, config).observations.object_positions[0]
    np.testing.assert_allclose(objects, environment.scene().object_positions, atol=1e-6)


def test_observations_of_several_objects_are_read(tmp_path: Path) -> None:
    config = StackConfig()
    environment = build(config)
    environment.reset(seed=2)
    states = recorded(environment)
    poses = [states[:, 10 + 7 * k :][:, [0, 1, 2, 4, 5, 6, 3]] for k in (0, 1)]
    demo = good(states) | {
        "obs/robot0_joint_pos": states[:, 1:8],
        "obs/robot0_gripper_qpos": states[:, 8:10],
        "obs/object": np.hstack((*poses, np.zeros((FRAMES, 9)))),
    }
    del demo["states"]
    path = record(tmp_path / "a.hdf5", {"env": "Stack"}, demo_1=demo)
    objects = read_one(path, config).observations.object_positions[0]
    np.testing.assert_allclose(objects, environment.scene().object_positions, atol=1e-6)


@pytest.mark.parametrize("since_1_5", [False, True])
def test_both_orders_of_an_observed_object_are_read(tmp_path: Path, since_1_5: bool) -> None:
    config = PickPlaceConfig(object="can")
    environment = build(config)
    environment.reset(seed=2)
    states, scene = recorded(environment), environment.scene()
    pose = states[:, [10, 11, 12, 14, 15, 16, 13]]
    away = np.tile([*(scene.object_positions[0] - scene.gripper_position), 0, 0, 0, 1.0], (6, 1))
    demo = good(states) | {
        "obs/robot0_joint_pos": states[:, 1:8],
        "obs/robot0_gripper_qpos": states[:, 8:10],
        "obs/robot0_eef_pos": np.tile(scene.gripper_position, (FRAMES, 1)),
        "obs/object": np.hstack((away, pose) if since_1_5 else (pose, away)),
    }
    del demo["states"]
    path = record(tmp_path / "a.hdf5", {"env": "PickPlaceCan"}, demo_1=demo)
    objects = read_one(path, config).observations.object_positions[0]
    np.testing.assert_allclose(objects, scene.object_positions, atol=1e-6)


@pytest.mark.parametrize(("half_size", "held"), [(0.021, True), (0.015, False)])
def test_sizes_come_from_the_recordings_own_model(
    tmp_path: Path, lift: RobosuiteEnvironment, half_size: float, held: bool
) -> None:
    lift.reset(seed=4)
    Hand(lift).pick()
    assert lift.scene().held == "cube"
    geom = f'<geom type="box" size="{half_size} {half_size} {half_size}"/>'
    cube = f'<body name="cube"><joint name="cube_jnt0" type="free"/>{geom}</body>'
    model = MODEL.format("", JOINTS + FINGERS + cube)
    shown = good(recorded(lift), model_file=model)
    path = record(tmp_path / "a.hdf5", {"env": "Lift"}, demo_1=shown, demo_2=good(recorded(lift)))
    sized, plain = RobosuiteHdf5Config(path=path).demonstrations(LiftConfig(), (0, 1), 0)
    assert isinstance(sized, Demonstration)
    assert isinstance(plain, Demonstration)
    assert sized.observations.held[0, 0] == held
    # The next one has no model: the environment's own cube is back.
    assert plain.observations.held[0, 0]
    assert sized.simulator_states is not None
    lift.set_state(sized.simulator_states[0])


def test_meshes_are_scaled_as_in_the_recordings_own_model() -> None:
    from xml.etree import ElementTree

    from prime_envs_robosuite.simulation.object_geoms import read_geoms

    environment = build(PickPlaceConfig(object="milk"))
    host = environment.own_geoms(), environment._simulation.host
    asset = r'<mesh file="C:\\somewhere\\meshes\\milk.stl" name="m" scale="0.45 0.45 0.45"/>'
    inner = '<body pos="0 0 0.01"><geom type="mesh" mesh="m" pos="0 0 0.02"/></body>'
    root = ElementTree.fromstring(MODEL.format(asset, f'<body name="Milk0">{inner}</body>'))
    body = root.find("worldbody/body")
    assert body is not None
    geoms = read_geoms(root, body)
    assert geoms[0].position == (0.0, 0.0, 0.03)
    models = [physics_model(host[1], found) for found in (host[0], {"Milk_main": geoms})]
    sizes, places = [], []
    for model in models:
        data = mujoco.MjData(model)
        mujoco.mj_forward(model, data)
        geom = model.geom("Milk_g0")
        sizes.append(model.geom_aabb[geom.id][3:])
        places.append(data.geom_xpos[geom.id] - data.body("Milk_main").xpos)
    np.testing.assert_allclose(sizes[1], sizes[0] / 2, atol=1e-5)
    np.testing.assert_allclose(places[1], places[0] / 2 + [0, 0, 0.03], atol=1e-4)


@pytest.mark.parametrize(
    ("size", "text"),
    [
        ("a", "its model_file has a strange geom of 'cube': could not convert"),
        ("-1 -1 -1", "the geoms of 'cube' in its model_file are none: Error: size"),
    ],
)
def test_a_strange_geom_is_named(
    tmp_path: Path, lift: RobosuiteEnvironment, size: str, text: str
) -> None:
    lift.reset(seed=4)
    cube = f'<body><joint name="cube_joint0" type="free"/><geom type="box" size="{size}"/></body>'
    model = MODEL.format("", JOINTS + FINGERS + cube)
    strange = good(recorded(lift), model_file=model)
    path = record(tmp_path / "a.hdf5", {"env": "Lift"}, demo_1=strange, demo_2=good(recorded(lift)))
    source = RobosuiteHdf5Config(path=path)
    first, second = source.demonstrations(LiftConfig(), (0, 1), 0)
    assert str(first).startswith(f"{path}: data/demo_1: {text}")
    assert isinstance(second, Demonstration)


@pytest.mark.parametrize("config", [StackConfig(), TaskConfig(name="Stack")])
def test_the_human_stack_comes_in(config: Any) -> None:
    if not STACK.is_file():
        pytest.skip(f"{STACK} is not there: it is not part of the project")
    shown = read_one(STACK, config)
    assert shown.observations.state.shape == (532, 15)
    held = shown.observations.held
    (grasped,) = np.flatnonzero(np.diff(held[:, 0].astype(int)) == 1)
    (let_go,) = np.flatnonzero(np.diff(held[:, 0].astype(int)) == -1)
    assert (grasped, let_go) == (173, 520)
    assert not held[:, 1].any()  # cube B is never taken
    environment = build(config)
    environment.reset(seed=0)
    assert shown.simulator_states is not None
    environment.set_state(shown.simulator_states[-1])
    assert environment.is_success()


def test_the_human_stack_ends_where_it_is_solved() -> None:
    if not STACK.is_file():
        pytest.skip(f"{STACK} is not there: it is not part of the project")
    source: Any = RobosuiteHdf5Config(path=STACK, ends_when_solved=True)
    assert 521 < len(source.demonstrate(StackConfig(), 0, 0).observations) < 532
