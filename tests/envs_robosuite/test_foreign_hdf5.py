"""What recordings say of themselves is believed; one bad demonstration does not end the others."""

import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

from prime_core.contracts.demonstration import Demonstration
from prime_core.errors import DatasetError, DemonstrationError
from prime_envs_robosuite.config import LiftConfig, NutAssemblyConfig
from prime_envs_robosuite.environment import RobosuiteEnvironment
from prime_envs_robosuite.recordings.robosuite_hdf5 import RobosuiteHdf5Config

FRAMES = 6
ARM = {"type": "OSC_POSE", "control_delta": True, "input_max": 1, "input_min": -1}
ROBOMIMIC = {
    "env_name": "Lift",
    "env_version": "1.4.1",
    "type": 1,
    "env_kwargs": {"robots": ["Panda"], "control_freq": 20, "controller_configs": ARM},
}
JOINTS = "".join(f'<body><joint name="robot0_joint{n}"/>' for n in range(1, 8)) + "</body>" * 7
FINGERS = "".join(
    f'<body><joint name="gripper0_finger_joint{n}" type="slide"/></body>' for n in (1, 2)
)
CUBE = '<body><joint name="cube_joint0" type="free"/></body>'
MODEL = "<mujoco><worldbody>{}</worldbody></mujoco>"


@pytest.fixture(scope="module")
def states(lift: RobosuiteEnvironment) -> Any:
    """Time, qpos and qvel of a gripper that goes down, ``(FRAMES, 32)``."""
    lift.reset(seed=0)
    rows = [lift.get_state()[:32]]
    for _ in range(FRAMES - 1):
        lift.step(np.array([0.0, 0.0, -0.03, 0.0, -1.0]))
        rows.append(lift.get_state()[:32])
    found = np.stack(rows)
    found[:, 0] = 0.05 * np.arange(FRAMES)
    return found


def record(path: Path, attributes: dict[str, Any], **groups: dict[str, Any]) -> Path:
    """Write a file; what is no array becomes an attribute of its group."""
    with h5py.File(path, "w") as file:
        data = file.create_group("data")
        for name, value in attributes.items():
            data.attrs[name] = json.dumps(value) if isinstance(value, dict) else value
        for name, arrays in groups.items():
            group = data.create_group(name)
            for key, values in arrays.items():
                if isinstance(values, np.ndarray):
                    group[key] = values
                else:
                    group.attrs[key] = values
    return path


def good(states: Any, **more: Any) -> dict[str, Any]:
    actions = np.tile([0.0, 0.0, -0.6, 0.0, 0.0, 0.0, -1.0], (FRAMES, 1))
    return {"states": states, "actions": actions} | more


def read(path: Path) -> list[Demonstration | DemonstrationError]:
    source = RobosuiteHdf5Config(path=path)
    return [*source.demonstrations(LiftConfig(), range(source.count_available()), 0)]


def refusal(path: Path) -> str:
    with pytest.raises(DatasetError) as caught:
        read(path)
    assert str(caught.value).startswith(f"{path}: ")
    return str(caught.value).removeprefix(f"{path}: ")


def assert_same(found: Demonstration | DemonstrationError, wanted: Demonstration) -> None:
    assert isinstance(found, Demonstration), found
    np.testing.assert_allclose(found.observations.state, wanted.observations.state, atol=1e-6)
    left, right = found.observations.environment_state, wanted.observations.environment_state
    np.testing.assert_allclose(left, right, atol=1e-6)
    np.testing.assert_allclose(found.actions, wanted.actions, atol=1e-6)


@pytest.fixture(scope="module")
def shown(states: Any, tmp_path_factory: pytest.TempPathFactory) -> Demonstration:
    path = record(tmp_path_factory.mktemp("a") / "a.hdf5", {"env": "Lift"}, demo_1=good(states))
    return RobosuiteHdf5Config(path=path).demonstrate(LiftConfig(), 0, 0)


ABSOLUTE = "it must be true or 'delta': absolute actions are not read, displacements are"
PARTS = {"type": "BASIC", "body_parts": {"right": {"type": "OSC_POSE", "input_type": "absolute"}}}
INFOS: dict[str, tuple[Any, str]] = {
    "another robot": ({"robots": "Sawyer"}, "says robots 'Sawyer'; it must be 'Panda'"),
    "two robots": (
        {"robots": ["Panda", "Panda"]},
        "says robots ['Panda', 'Panda']; it must be 'Panda'",
    ),
    "another rate": ({"control_freq": 10}, "says control_freq 10; it must be 20"),
    "a rate as a text": ({"control_freq": "20"}, "says control_freq '20'; it must be 20"),
    "another task": ({"env_name": "Stack"}, "says env_name 'Stack'; it must be 'Lift'"),
    "another gripper": (
        {"gripper_types": "RethinkGripper"},
        "says gripper_types 'RethinkGripper'; it must be 'default'",
    ),
    "another controller": (
        {"controller_configs": {"type": "JOINT_VELOCITY"}},
        "says controller type 'JOINT_VELOCITY'; it must be 'OSC_POSE'",
    ),
    "absolute actions": (
        {"controller_configs": ARM | {"control_delta": False}},
        f"says control_delta False; {ABSOLUTE}",
    ),
    "absolute actions since 1.5": (
        {"controller_configs": PARTS},
        f"says input_type 'absolute'; {ABSOLUTE}",
    ),
    "stiffness as an action": (
        {"controller_configs": ARM | {"impedance_mode": "variable_kp"}},
        "says impedance_mode 'variable_kp'; it must be 'fixed'",
    ),
    "a whole body": (
        {"controller_configs": PARTS | {"type": "WHOLE_BODY_IK"}},
        "says controller 'WHOLE_BODY_IK'; it must be 'BASIC' with a controller of the right arm",
    ),
    "a controller as a text": (
        {"controller_configs": "OSC_POSE"},
        "says controller_configs 'OSC_POSE'; it must be a table",
    ),
    "limits as texts": (
        {"controller_configs": ARM | {"output_max": "0.05 m"}},
        "says output_max '0.05 m'; it must be one number or six",
    ),
    "limits that are not there": (
        {"controller_configs": ARM | {"output_max": None}},
        "says output_max None; it must be one number or six",
    ),
    "limits of another width": (
        {"controller_configs": ARM | {"output_max": [0.05] * 7}},
        f"says output_max {[0.05] * 7}; it must be one number or six",
    ),
    "limits that are true": (
        {"controller_configs": ARM | {"input_max": True}},
        "says input_max True; it must be one number or six",
    ),
    "limits that are no numbers": (
        {"controller_configs": ARM | {"input_max": float("nan")}},
        "says input_max nan; it must be at most 1e+06",
    ),
    "limits in millimetres": (
        {"controller_configs": ARM | {"output_max": 50}},
        "says output_max 50; it must be at most 1 metre or radian a step",
    ),
    "limits that nothing can hold": (
        {"controller_configs": ARM | {"input_min": -(10**400)}},
        f"says input_min {-(10**400)}; it must be at most 1e+06",
    ),
}


@pytest.mark.parametrize("case", INFOS)
def test_what_a_recording_says_of_itself_is_believed(
    tmp_path: Path, states: Any, case: str
) -> None:
    settings, text = INFOS[case]
    path = record(tmp_path / "a.hdf5", {"env": "Lift", "env_info": settings}, demo_1=good(states))
    assert refusal(path) == f"'env_info' of 'data' {text}"
    kwargs = ROBOMIMIC | {"env_kwargs": settings}
    path = record(tmp_path / "b.hdf5", {"env_args": kwargs}, demo_1=good(states))
    assert refusal(path) == f"'env_args' of 'data' {text}"


ATTRIBUTES: dict[str, tuple[dict[str, Any], str]] = {
    "no JSON": (
        {"env": "Lift", "env_info": "{'robots': 1}"},
        "group 'data': attribute 'env_info' is not JSON: Expecting property name enclosed in "
        "double quotes: line 1 column 2 (char 1)",
    ),
    "no table": (
        {"env": "Lift", "env_info": '["Panda"]'},
        "group 'data': attribute 'env_info' is '[\"Panda\"]'; it must be a table in JSON",
    ),
    "no text": (
        {"env": np.array([1, 2])},
        "group 'data': attribute 'env' is array([1, 2]); it must be a text",
    ),
    "another simulator": (
        {"env_args": ROBOMIMIC | {"type": 2}},
        "'env_args' of 'data' says type 2; type 1, an environment of robosuite, is read",
    ),
    "another task": (
        {"env_args": ROBOMIMIC | {"env_name": "ToolHang"}},
        "attribute 'env_args' of 'data' names 'ToolHang'; the environment takes recordings of "
        "'Lift'",
    ),
    "two tasks": (
        {"env": "Stack", "env_args": ROBOMIMIC},
        "attribute 'env' of 'data' names 'Stack'; the environment takes recordings of 'Lift'",
    ),
}


@pytest.mark.parametrize("case", ATTRIBUTES)
def test_strange_attributes_are_refused_by_name(tmp_path: Path, states: Any, case: str) -> None:
    attributes, text = ATTRIBUTES[case]
    assert refusal(record(tmp_path / "a.hdf5", attributes, demo_1=good(states))) == text


def test_a_task_without_recordings_is_refused(tmp_path: Path, states: Any) -> None:
    path = record(tmp_path / "a.hdf5", {"env": "NutAssembly"}, demo_1=good(states))
    with pytest.raises(DatasetError, match="recordings of robosuite's Lift and PickPlace; there"):
        RobosuiteHdf5Config(path=path).demonstrate(NutAssemblyConfig(), 0, 0)


def test_actions_are_scaled_as_the_controller_was(
    tmp_path: Path, states: Any, shown: Demonstration
) -> None:
    half = {"output_max": [0.025] * 3 + [0.25] * 3, "output_min": [-0.025] * 3 + [-0.25] * 3}
    path = record(
        tmp_path / "a.hdf5",
        {"env": "Lift", "env_info": {"controller_configs": ARM | half}},
        demo_1=good(states),
    )
    (found,) = read(path)
    assert isinstance(found, Demonstration)
    np.testing.assert_allclose(found.actions[:-1, 2], 0.5 * shown.actions[:-1, 2])
    assert np.allclose(shown.actions[:-1, 2], -0.03)


def observed(states: Any, together: bool) -> dict[str, Any]:
    """Return robomimic's observations of states."""
    cube = states[:, [10, 11, 12, 14, 15, 16, 13]]  # the quaternion's w last
    found = {"robot0_joint_pos": states[:, 1:8], "robot0_gripper_qpos": states[:, 8:10]}
    if together:
        return found | {"object": np.hstack((cube, np.zeros((FRAMES, 3))))}
    return found | {"cube_pos": cube[:, :3], "cube_quat": cube[:, 3:]}


@pytest.mark.parametrize("together", [True, False])
@pytest.mark.parametrize("with_states", [True, False])
def test_robomimics_layout_is_read(
    tmp_path: Path, states: Any, shown: Demonstration, together: bool, with_states: bool
) -> None:
    demo = good(states, num_samples=FRAMES)
    demo |= {f"obs/{key}": values for key, values in observed(states, together).items()}
    if not with_states:
        del demo["states"]
    path = record(tmp_path / "low_dim.hdf5", {"env_args": ROBOMIMIC}, demo_0=demo)
    (found,) = read(path)
    assert_same(found, shown)


def test_joints_are_matched_by_name(tmp_path: Path, states: Any, shown: Demonstration) -> None:
    cube_first = np.hstack(
        (states[:, :1], states[:, 10:17], states[:, 1:10], states[:, 26:], states[:, 17:26])
    )
    path = record(
        tmp_path / "a.hdf5",
        {"env": "Lift"},
        demo_1=good(states, model_file=MODEL.format(JOINTS + FINGERS + CUBE)),
        demo_2=good(cube_first, model_file=MODEL.format(CUBE + JOINTS + FINGERS)),
        demo_3=good(states, model_file=MODEL.format(FINGERS + CUBE)),
        demo_4=good(states, model_file="<mujoco>"),
        demo_5=good(states[:, :-1], model_file=MODEL.format(CUBE + JOINTS + FINGERS)),
    )
    first, second, *others = read(path)
    assert_same(first, shown)
    assert_same(second, shown)
    assert [str(item).removeprefix(f"{path}: data/") for item in others] == [
        "demo_3: its model_file has the joints gripper0_finger_joint1, gripper0_finger_joint2, "
        "cube_joint0; wanted are those of a Panda, of its two fingers and of 'cube' (robosuite's "
        "names)",
        "demo_4: its model_file is no XML: no element found: line 1, column 8",
        "demo_5/states has rows of 31 numbers, must have 32: time, 16 joint positions and 15 joint "
        "velocities of its model_file",
    ]


def changed(states: Any, change: Callable[[Any], None]) -> Any:
    copy = states.copy()
    change(copy)
    return copy


def test_bad_demonstrations_do_not_end_the_others(
    tmp_path: Path, states: Any, shown: Demonstration
) -> None:
    holed = changed(states, lambda rows: rows.__setitem__((2, 3), np.nan))
    degrees = changed(states, lambda rows: rows.__setitem__((slice(None), 2), 120.0))
    flat = changed(states, lambda rows: rows.__setitem__((slice(None), slice(13, 17)), 0.0))
    far = changed(states, lambda rows: rows.__setitem__((1, 10), -1e30))
    fast = changed(states, lambda rows: rows.__setitem__((1, 20), 1e300))
    slow = changed(states, lambda rows: rows.__imul__(np.r_[2.0, np.ones(31)]))
    millimetres = changed(states, lambda rows: rows.__setitem__((slice(None), 12), 830.0))
    wide = changed(states, lambda rows: rows.__setitem__((slice(None), 8), 40.0))
    path = record(
        tmp_path / "a.hdf5",
        {"env": "Lift"},
        demo_0=good(holed),
        demo_1={"states": states},
        demo_2=good(states, actions=np.zeros((0, 7))),
        demo_3=good(states),
        demo_4=good(degrees),
        demo_5=good(flat),
        demo_6=good(slow),
        demo_7=good(states, num_samples=5),
        demo_8=good(states, actions=np.array([["a"] * 7] * FRAMES, dtype="S1")),
        demo_9={},
        demo_10=good(states),
        demo_14=good(millimetres),
        demo_15=good(wide),
        demo_16=good(far),
        demo_17=good(fast),
    )
    with h5py.File(path, "a") as file:
        file["data/demo_11"] = np.zeros(3)
        file["data/demo_12"] = h5py.SoftLink("/nowhere")
        file["data/demo_13/actions"] = h5py.ExternalLink("gone.hdf5", "/actions")
        file["data/demo_13/states"] = states
    found = dict(enumerate(read(path)))
    for number in (3, 10):
        assert_same(found.pop(number), shown)
    said = {number: str(item).removeprefix(f"{path}: data/") for number, item in found.items()}
    rows = "must hold two rows of finite numbers or more"
    assert {number: text for number, text in said.items() if number < 12} == {
        0: f"demo_0/states of shape (6, 32) {rows}",
        1: "demo_1: has no data set 'actions'; it holds states",
        2: f"demo_2/actions of shape (0, 7) {rows}",
        4: "demo_4: a joint of the arm is at 120; joint positions are radians",
        5: "demo_5: the object's quaternion has the length 0 in row 0; it must be 1",
        6: "demo_6/states: time goes on by 0.1 s after row 0; it must go on by 0.05 s, 20 times a "
        "second",
        7: "demo_7 has 6 actions; its num_samples says 5",
        8: "demo_8/actions holds |S1; it must hold numbers",
        9: "demo_9: has no data set 'states'; it holds nothing",
        11: "demo_11 is no group of a demonstration",
    }
    metres = "it should be metres, at most"
    assert said[14] == f"demo_14: the object is at 830; {metres} 10"
    assert said[15] == f"demo_15: a finger is at 40; {metres} 0.3"
    assert said[16] == f"demo_16: the object is at 1e+30; {metres} 10"
    assert said[17] == (
        "demo_17: a velocity is 1e+300; it should be metres or radians a second, at most 10000"
    )
    assert said[12].startswith("demo_12: cannot be read: ")
    assert said[13] == "demo_13: has no data set 'actions'; it holds actions, states"


def test_a_file_cut_in_half_is_told_so(tmp_path: Path, states: Any) -> None:
    path = record(tmp_path / "a.hdf5", {"env": "Lift"}, demo_1=good(states))
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    text = refusal(path)
    assert text.startswith("cannot be read: truncated file: eof = ")
    assert text.endswith("It was not closed or not copied to its end") and "\n" not in text


def test_a_file_that_is_written_elsewhere_is_told_so(tmp_path: Path, states: Any) -> None:
    path = record(tmp_path / "a.hdf5", {"env": "Lift"}, demo_1=good(states))
    code = f"import h5py; f = h5py.File({str(path)!r}, 'a'); print('open', flush=True); input()"
    with subprocess.Popen(
        [sys.executable, "-c", code], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as writer:
        assert writer.stdout is not None and writer.stdout.readline() == "open\n"
        text = refusal(path)
        writer.communicate("\n")
    assert text == "is open for writing elsewhere: end what records into it, then read it"


def test_a_folder_and_a_data_set_in_the_place_of_a_group_are_refused(tmp_path: Path) -> None:
    (tmp_path / "folder.hdf5").mkdir()
    assert refusal(tmp_path / "folder.hdf5") == "cannot be read: Is a directory"
    with h5py.File(tmp_path / "a.hdf5", "w") as file:
        file["data"] = np.zeros(3)
    assert refusal(tmp_path / "a.hdf5").startswith("has no group 'data'; it holds data. Expected")


@pytest.mark.skipif(os.geteuid() != 0, reason="takes another user's rights, which only root can")
def test_a_file_without_permission_is_told_so(tmp_path: Path, states: Any) -> None:
    path = record(tmp_path / "a.hdf5", {"env": "Lift"}, demo_1=good(states))
    for folder in (tmp_path, *tmp_path.parents[:2]):
        folder.chmod(0o755)
    path.chmod(0o000)
    os.seteuid(65534)
    try:
        text = refusal(path)
    finally:
        os.seteuid(0)
    assert text == "cannot be read: Permission denied"


def test_a_small_file_of_very_many_numbers_is_not_read(tmp_path: Path, states: Any) -> None:
    path = record(tmp_path / "a.hdf5", {"env": "Lift"}, demo_1=good(states))
    with h5py.File(path, "a") as file:
        file.create_dataset("data/demo_2/states", (10**9, 32), "f8", chunks=(1000, 32))
        file["data/demo_2/actions"] = np.zeros((FRAMES, 7))
    assert path.stat().st_size < 100_000
    _, refused = read(path)
    assert str(refused) == (
        f"{path}: data/demo_2/states has the shape (1000000000, 32); at most 20000000 numbers are "
        "read"
    )
