"""What another hand wrote into a data set's info is checked, and refused by its key."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from prime_core.contracts.description import RobotDescription
from prime_core.datasets.read import read_dataset
from prime_core.errors import DatasetError

from .edits import INFO, edit_info, refusal
from .samples import DESCRIPTION, write

STATE = "observation.state"
NAMES = "it should be a list of 5 names, or null"
INFO_EDITS: dict[str, tuple[Callable[[dict[str, Any]], object], str]] = {
    "a feature is a text": (
        lambda info: info["features"].update({"action": "float32"}),
        "feature 'action' is 'float32'; it should be a table with dtype, shape and names",
    ),
    "a feature is a list": (
        lambda info: info["features"].update({STATE: [15]}),
        f"feature '{STATE}' is [15]; it should be a table with dtype, shape and names",
    ),
    "names are a text": (
        lambda info: info["features"]["action"].update(names="dx dy dz dyaw gripper"),
        f"names of feature 'action' is 'dx dy dz dyaw gripper'; {NAMES}",
    ),
    "names are numbers": (
        lambda info: info["features"]["action"].update(names=[0, 1, 2, 3, 4]),
        f"names of feature 'action' is [0, 1, 2, 3, 4]; {NAMES}",
    ),
    "a name is missing": (
        lambda info: info["features"]["action"]["names"].pop(),
        "feature 'action' has 5 numbers and 4 different names: dx, dy, dz, dyaw. Give one name "
        "for each number, or null",
    ),
    "a name is there twice": (
        lambda info: info["features"]["action"].update(names=["dx", "dx", "dz", "dyaw", "g"]),
        "feature 'action' has 5 numbers and 4 different names: dx, dx, dz, dyaw, g. Give one "
        "name for each number, or null",
    ),
    "other actions": (
        lambda info: info["features"]["action"].update(names=["dx", "dy", "dz", "roll", "gripper"]),
        "feature 'action' has 'roll' where this environment has 'dyaw'. It has dx, dy, dz, roll, "
        "gripper; wanted are, in any order, dx, dy, dz, dyaw, gripper. Either the data set is of "
        "another environment, or its names have to be changed to these",
    ),
    "a shape is a text": (
        lambda info: info["features"]["action"].update(shape="[5]"),
        "feature 'action' is float32 of shape [5]; it should be 5 numbers per frame, float32 or "
        "float64",
    ),
    "a shape is no whole number": (
        lambda info: info["features"]["action"].update(shape=[5.0]),
        "feature 'action' is float32 of shape [5.0]; it should be 5 numbers per frame, float32 or "
        "float64",
    ),
    "features are a list": (
        lambda info: info.update(features=[STATE]),
        f"features is ['{STATE}']; it should be a table of features",
    ),
    "a count is a text": (
        lambda info: info.update(total_episodes="3"),
        "total_episodes is '3'; it should be a whole number, 1 to 100000",
    ),
    "a count is a fraction": (
        lambda info: info.update(total_episodes=3.0),
        "total_episodes is 3.0; it should be a whole number, 1 to 100000",
    ),
    "no episodes": (
        lambda info: info.update(total_episodes=0),
        "total_episodes is 0; it should be a whole number, 1 to 100000",
    ),
    "too many episodes to count": (
        lambda info: info.update(total_episodes=10**18),
        "total_episodes is 1000000000000000000; it should be a whole number, 1 to 100000",
    ),
    "a rate is a text": (
        lambda info: info.update(fps="20"),
        "fps is '20'; it should be a number of frames a second above 0",
    ),
    "a rate is true": (
        lambda info: info.update(fps=True),
        "fps is True; it should be a number of frames a second above 0",
    ),
    "another rate": (
        lambda info: info.update(fps=10),
        "fps is 10; motor actions here are steps of 20 a second: resample the data set to 20",
    ),
    "no state": (
        lambda info: info["features"][STATE].update(shape=[0], names=None),
        f"feature '{STATE}' has no numbers; it should have some",
    ),
    **{
        f"data in {path[:30]!r}": (
            lambda info, path=path: info.update(data_path=path),
            f"data_path is {path!r}; it should be a path inside of the data set: LeRobot has "
            "'data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet'",
        )
        for path in (
            "/etc/passwd",
            "../other/{chunk_index}.parquet",
            "a\0b",
            "{chunk_index:>999999999}",
            "{chunk_index.__class__}",
            "data/{episode_chunk:03d}/episode_{episode_index:06d}.parquet",
        )
    },
}


@pytest.mark.parametrize("edit", INFO_EDITS)
def test_an_edited_info_is_refused_by_key(tmp_path: Path, edit: str) -> None:
    change, text = INFO_EDITS[edit]
    write(tmp_path / "set")
    edit_info(tmp_path / "set", change)
    assert refusal(tmp_path / "set") == f"{INFO}: {text}"


def test_an_info_of_another_robot_is_refused(tmp_path: Path) -> None:
    write(tmp_path / "set")
    robot = RobotDescription(mjcf="", joint_names=(), end_effector="", name="panda")
    ours = replace(DESCRIPTION, robot=robot)
    for same in (None, "unknown", "Franka_Panda", "panda"):
        edit_info(tmp_path / "set", lambda info, name=same: info.update(robot_type=name))
        read_dataset(tmp_path / "set", ours)
    edit_info(tmp_path / "set", lambda info: info.update(robot_type="so100"))
    with pytest.raises(DatasetError) as caught:
        read_dataset(tmp_path / "set", ours)
    assert str(caught.value) == (
        f"{tmp_path}/set/{INFO}: robot_type is 'so100'; this environment's robot is 'panda'. If it "
        "is the same one, write 'panda' or null there"
    )


def test_an_info_with_a_byte_order_mark_is_read(tmp_path: Path) -> None:
    write(tmp_path / "set")
    path = tmp_path / "set" / INFO
    path.write_text(path.read_text(), encoding="utf-8-sig")
    assert len(read_dataset(tmp_path / "set", DESCRIPTION).demonstrations) == 3
