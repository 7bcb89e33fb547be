"""Robosuite's own recordings come in whole, or are refused with a reason."""

from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from numpy.typing import NDArray

from prime_core.contracts.demonstration import Demonstration
from prime_core.contracts.environment import ACTION_LIMIT
from prime_core.errors import DatasetError
from prime_envs_robosuite.config import LiftConfig, PickPlaceConfig
from prime_envs_robosuite.demonstrators.simulated_teleoperator import SimulatedTeleoperatorConfig
from prime_envs_robosuite.environment import RobosuiteEnvironment
from prime_envs_robosuite.recordings.recorded_settings import ROBOSUITES_SCALE
from prime_envs_robosuite.recordings.robosuite_hdf5 import RobosuiteHdf5Config

HUMAN = Path(__file__).parents[3] / "shared" / "human_demos"
KEYBOARD, SPACE_MOUSE = HUMAN / "lift_v1.4.0_keyboard.hdf5", HUMAN / "lift_v1.4.1.hdf5"
RECORDED = [(KEYBOARD, "demo_1", 482), (KEYBOARD, "demo_2", 510), (KEYBOARD, "demo_3", 392)]
RECORDED += [(SPACE_MOUSE, "demo_1", 226), (SPACE_MOUSE, "demo_2", 1143)]
RECORDED += [(SPACE_MOUSE, "demo_3", 285), (SPACE_MOUSE, "demo_4", 296)]
LIFT_WIDTH = 32  # of a recorded state: time, 16 positions, 15 velocities


def write(path: Path, environment: str | None = "Lift", **episodes: dict[str, Any]) -> Path:
    with h5py.File(path, "w") as file:
        data = file.create_group("data")
        if environment is not None:
            data.attrs["env"] = environment
        for name, arrays in episodes.items():
            group = data.create_group(name)
            for key, values in arrays.items():
                group[key] = values
    return path


def zeros(count: int = 3, width: int = LIFT_WIDTH) -> dict[str, Any]:
    return {"states": np.zeros((count, width)), "actions": np.zeros((count, 7))}


def refusal(path: Path, **settings: Any) -> str:
    """Return what is said when the first demonstration is asked for, after the file's name."""
    source = RobosuiteHdf5Config(path=path, **settings)
    with pytest.raises(DatasetError) as caught:
        source.demonstrate(LiftConfig(), 0, 0)
    text = str(caught.value)
    assert text.startswith(f"{path}: ")
    return text.removeprefix(f"{path}: ")


def joint_states(
    environment: RobosuiteEnvironment, shown: Demonstration, first: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return qpos and qvel of a demonstration's frames; a state starts with time, qpos, qvel."""
    assert shown.simulator_states is not None
    objects = len(environment.description.objects)
    positions, velocities = 9 + 7 * objects, 9 + 6 * objects
    tail = shown.simulator_states[first:]
    return tail[:, 1 : 1 + positions], tail[:, 1 + positions : 1 + positions + velocities]


@pytest.mark.parametrize(("path", "name", "count"), RECORDED)
def test_human_demonstrations_come_in(path: Path, name: str, count: int) -> None:
    if not path.is_file():
        pytest.skip(f"{path} is not there: it is not part of the project")
    source = RobosuiteHdf5Config(path=path, episodes=(name,))
    shown = source.demonstrate(LiftConfig(), 0, 0)
    assert len(shown.observations) == count
    assert shown.task == "lift the cube"
    cube = shown.observations.environment_state
    assert not cube[0, 7] and np.all(cube[-5:, 7])
    assert cube[-1, 2] > 0.84
    assert np.all(np.abs(shown.actions) <= ACTION_LIMIT.astype(np.float32))
    moved = np.diff(shown.observations.state[:, :3], axis=0)
    for axis in (0, 2):
        # What was commanded is what happened, in the same frame and of the same sign.
        assert np.corrcoef(shown.actions[:-1, axis], moved[:, axis])[0, 1] > 0.7


@pytest.mark.parametrize(("path", "name", "count"), RECORDED[:1])
def test_restored_states_are_the_frames(
    path: Path, name: str, count: int, lift: RobosuiteEnvironment
) -> None:
    if not path.is_file():
        pytest.skip(f"{path} is not there: it is not part of the project")
    shown = RobosuiteHdf5Config(path=path).demonstrate(LiftConfig(), 0, 0)
    assert shown.simulator_states is not None
    for frame in (0, 100, count - 1):
        lift.set_state(shown.simulator_states[frame])
        state = lift.scene().observation()["observation.state"]
        assert np.array_equal(state, shown.observations.state[frame])


def test_demonstrations_are_counted_in_the_order_of_their_numbers(tmp_path: Path) -> None:
    path = write(tmp_path / "a.hdf5", demo_10=zeros(), demo_2=zeros(width=5), demo_1=zeros())
    assert RobosuiteHdf5Config(path=path).count_available() == 3
    source = RobosuiteHdf5Config(path=path)
    with pytest.raises(DatasetError, match="data/demo_2/states has rows of 5"):
        source.demonstrate(LiftConfig(), 1, 0)
    assert RobosuiteHdf5Config(path=path, episodes=("demo_2",)).count_available() == 1


def test_a_recorded_lift_comes_back(tmp_path: Path, lift: RobosuiteEnvironment) -> None:
    shown = SimulatedTeleoperatorConfig().demonstrate(LiftConfig(), 0, 1)
    positions, velocities = joint_states(lift, shown, 100)
    states = np.hstack((np.zeros((len(positions), 1)), positions, velocities))
    actions = np.zeros((len(states), 7))
    path = write(tmp_path / "a.hdf5", demo_1={"states": states, "actions": actions})
    again = RobosuiteHdf5Config(path=path).demonstrate(LiftConfig(), 0, 0)
    assert np.allclose(again.observations.state, shown.observations.state[100:], atol=1e-6)
    assert np.array_equal(
        again.observations.environment_state, shown.observations.environment_state[100:]
    )


def test_only_the_object_to_move_is_taken_from_pick_place(
    tmp_path: Path, milk: RobosuiteEnvironment
) -> None:
    shown = SimulatedTeleoperatorConfig().demonstrate(PickPlaceConfig(), 0, 1)
    first = len(shown.observations) - 5
    positions, velocities = joint_states(milk, shown, first)
    others, still = np.full((5, 21), 10.0), np.zeros((5, 18))
    states = np.hstack((np.zeros((5, 1)), positions, others, velocities, still))
    path = write(
        tmp_path / "a.hdf5", "PickPlaceMilk", demo_1={"states": states, "actions": np.zeros((5, 7))}
    )
    again = RobosuiteHdf5Config(path=path).demonstrate(PickPlaceConfig(), 0, 0)
    assert np.allclose(
        again.observations.environment_state, shown.observations.environment_state[first:]
    )


def test_actions_are_clipped_before_they_are_scaled() -> None:
    recorded = np.array([[3.75, -0.5, 0.0, 0.3, 0.3, -0.2, 1.0], [0, 0, -9.0, 0, 0, 2.0, -0.4]])
    expected = [[0.05, -0.025, 0.0, -0.1, 1.0], [0.0, 0.0, -0.05, 0.5, -1.0]]
    assert np.allclose(ROBOSUITES_SCALE.motor_actions(recorded), expected)


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    text = refusal(tmp_path / "none.hdf5")
    assert text == "there is no such file (path of demonstrator 'robosuite-hdf5')"


def test_another_kind_of_file_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "notes.hdf5"
    path.write_text("not HDF5")
    assert refusal(path) == "is not an HDF5 file; robosuite's recorder writes demo.hdf5"


def test_another_layout_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.hdf5"
    with h5py.File(path, "w") as file:
        file.create_group("episodes")
    assert refusal(path) == (
        "has no group 'data'; it holds episodes. Expected is the layout of robosuite's "
        "collect_human_demonstrations or of robomimic: a group 'data' with a group for each "
        "demonstration"
    )


def test_another_task_is_refused(tmp_path: Path) -> None:
    path = write(tmp_path / "a.hdf5", "Stack", demo_1=zeros())
    assert refusal(path) == (
        "attribute 'env' of 'data' names 'Stack'; the environment takes recordings of 'Lift'"
    )


def test_an_unnamed_task_is_refused(tmp_path: Path) -> None:
    path = write(tmp_path / "a.hdf5", None, demo_1=zeros())
    assert refusal(path) == (
        "group 'data' names no recorded task: it has neither an attribute 'env' (robosuite) nor "
        "'env_args' with an env_name (robomimic)"
    )


def test_no_demonstration_is_refused(tmp_path: Path) -> None:
    path = write(tmp_path / "a.hdf5")
    assert refusal(path) == "holds no demonstration, group 'data' is empty"


def test_an_unknown_episode_is_refused(tmp_path: Path) -> None:
    path = write(tmp_path / "a.hdf5", demo_1=zeros(), demo_2=zeros())
    text = refusal(path, episodes=("demo_7",))
    assert text == "has no group data/demo_7; there are: demo_1, demo_2"


def test_an_index_beyond_the_file_is_refused(tmp_path: Path) -> None:
    path = write(tmp_path / "a.hdf5", demo_1=zeros())
    with pytest.raises(DatasetError, match="gives 1 demonstrations, not 2"):
        RobosuiteHdf5Config(path=path).demonstrate(LiftConfig(), 1, 0)


def test_missing_arrays_are_named(tmp_path: Path) -> None:
    path = write(tmp_path / "a.hdf5", demo_1={"states": np.zeros((3, LIFT_WIDTH))})
    assert refusal(path) == "data/demo_1: has no data set 'actions'; it holds states"


def test_other_joints_are_refused(tmp_path: Path) -> None:
    path = write(tmp_path / "a.hdf5", demo_1=zeros(width=45))
    assert refusal(path) == (
        "data/demo_1/states has rows of 45 numbers, must have 32: time, 16 joint positions and "
        "15 joint velocities of a Panda and 1 object(s)"
    )


def test_actions_of_another_shape_are_refused(tmp_path: Path) -> None:
    arrays = {"states": np.zeros((3, LIFT_WIDTH)), "actions": np.zeros((3, 4))}
    path = write(tmp_path / "a.hdf5", demo_1=arrays)
    assert refusal(path) == (
        "data/demo_1/actions has shape (3, 4), must have (3, 7): an OSC_POSE action for each state"
    )


def test_numbers_must_be_finite(tmp_path: Path) -> None:
    arrays = zeros()
    arrays["states"][1, 3] = np.nan
    path = write(tmp_path / "a.hdf5", demo_1=arrays)
    assert refusal(path) == (
        "data/demo_1/states of shape (3, 32) must hold two rows of finite numbers or more"
    )


def test_success_is_no_condition(tmp_path: Path, lift: RobosuiteEnvironment) -> None:
    lift.reset(seed=0)
    state = lift.get_state()[:LIFT_WIDTH]
    arrays = {"states": np.stack((state, state)), "actions": np.zeros((2, 7))}
    arrays["states"][:, 0] = [0.0, 0.05]
    path = write(tmp_path / "a.hdf5", demo_1=arrays)
    assert RobosuiteHdf5Config(path=path).demonstrate(LiftConfig(), 0, 0).steps == 1
