"""What recordings say of themselves is believed, in robosuite's layout and in robomimic's."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from prime_core.contracts.demonstration import Demonstration
from prime_core.errors import DatasetError
from prime_envs_robosuite.config import TidyUpConfig
from prime_envs_robosuite.recordings.robosuite_hdf5 import RobosuiteHdf5Config

from .hdf5_files import FRAMES, assert_same, good, read, record, refusal

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
    path = record(tmp_path / "a.hdf5", {"env": "Lift"}, demo_1=good(states))
    with pytest.raises(DatasetError, match=r"'robosuite/task'\); there are none of TidyUpConfig"):
        RobosuiteHdf5Config(path=path).demonstrate(TidyUpConfig(), 0, 0)


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
