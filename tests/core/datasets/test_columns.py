"""Data sets of other column names and units are read by a mapping, and its mistakes are named."""

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from pydantic import ValidationError

from prime_core.contracts.demonstration import Demonstration
from prime_core.contracts.observations import Observations
from prime_core.datasets.columns.conversion import quaternions, told_actions, told_held
from prime_core.datasets.columns.settings import ColumnsConfig, OrientationConfig
from prime_core.datasets.read import read_dataset, read_demonstrations
from prime_core.errors import ConfigurationError, DatasetError
from prime_core.rotations import gripper_down, quaternion_product, yaw_of

from .edits import edit_info
from .samples import DATA, DESCRIPTION, LENGTHS, write

ARM = [f"j{number}" for number in range(7)]
TABLE: dict[str, Any] = {
    "gripper": {
        "position": {"feature": "arm.pose", "columns": ["x", "y", "z"], "unit": "mm"},
        "orientation": {"feature": "arm.pose", "columns": [3, 4, 5, 6], "format": "xyzw"},
        "opening": {"feature": "fingers", "unit": "cm"},
    },
    "joints": {"feature": "arm.joints", "unit": "deg"},
    "objects": {
        name: {
            "position": {"feature": name, "columns": [0, 1, 2]},
            "orientation": {"feature": name, "columns": [3, 4, 5, 6], "format": "wxyz"},
            "held": {"feature": name, "columns": [7]},
        }
        for name in ("milk", "bin")
    },
    "action": {"feature": "action"},
}


def vectors(values: Any) -> Any:
    flat = pa.array(np.ascontiguousarray(values, dtype=np.float64).reshape(-1))
    return pa.FixedSizeListArray.from_arrays(flat, values.shape[1])


def foreign(folder: Path) -> list[Demonstration]:
    """Write our samples with the columns and units of somebody else's recorder."""
    shown = write(folder)
    table = pq.read_table(folder / DATA).drop_columns(["simulator_state"])
    seen = Observations.join([item.observations for item in shown])
    state = seen.state.astype(np.float64)
    columns = {
        "arm.pose": np.hstack((1000 * state[:, :3], state[:, [4, 5, 6, 3]])),
        "fingers": 100 * np.hstack((0.25 * state[:, 7:8], -0.75 * state[:, 7:8])),
        "arm.joints": np.rad2deg(state[:, 8:]),
        "milk": seen.environment_state[:, :8],
        "bin": seen.environment_state[:, 8:],
    }
    for key in ("observation.state", "observation.environment_state"):
        table = table.drop_columns([key])
    for key, values in columns.items():
        table = table.append_column(key, vectors(values))
    pq.write_table(table, folder / DATA)
    names = {"arm.pose": ["x", "y", "z", "qx", "qy", "qz", "qw"], "arm.joints": {"motors": ARM}}

    def change(info: dict[str, Any]) -> None:
        for key in ("observation.state", "observation.environment_state", "simulator_state"):
            del info["features"][key]
        for key, values in columns.items():
            shape = [values.shape[1]]
            info["features"][key] = {"dtype": "float64", "shape": shape, "names": names.get(key)}
        info["robot_type"] = "somebody's"

    edit_info(folder, change)
    return shown


def changed(path: str, value: Any) -> dict[str, Any]:
    """Return the table with one key changed."""
    table = json.loads(json.dumps(TABLE))
    *way, last = path.split(".")
    node = table
    for key in way:
        node = node[key]
    if value is None:
        del node[last]
    else:
        node[last] = value
    return table


def read(folder: Path, table: dict[str, Any]) -> list[Demonstration]:
    mapping = ColumnsConfig.model_validate(table)
    found = read_demonstrations(folder, DESCRIPTION, columns=mapping)
    shown = [item for item in found if isinstance(item, Demonstration)]
    assert len(shown) == len(LENGTHS)
    return shown


def test_another_recorders_columns_and_units_are_read(tmp_path: Path) -> None:
    shown = foreign(tmp_path / "set")
    for found, wanted in zip(read(tmp_path / "set", TABLE), shown, strict=True):
        for name in ("state", "environment_state"):
            left, right = getattr(found.observations, name), getattr(wanted.observations, name)
            assert left.dtype == np.float32
            np.testing.assert_allclose(left, right, atol=2e-7)
        np.testing.assert_array_equal(found.actions, wanted.actions)
        assert found.task == wanted.task
        assert found.simulator_states is None
    with pytest.raises(DatasetError, match=r"no feature 'observation\.state'"):
        read_dataset(tmp_path / "set", DESCRIPTION)


def test_a_gripper_from_0_to_1_a_flange_and_a_base_elsewhere(tmp_path: Path) -> None:
    shown = foreign(tmp_path / "set")
    table = changed("gripper.opening", {"feature": "fingers", "columns": [0]})
    # Fingers tell 25 times the opening in metres: 2 is as wide as 0.08.
    table["gripper"]["opening"] |= {"closed": 0.0, "open": 2.0, "width": 0.08}
    table["gripper"]["tip"] = [0.0, 0.0, 0.1]
    table["gripper"]["orientation"]["turned"] = np.pi / 2
    table["origin"] = {"position": [0.5, 0.5, 0.25], "yaw": np.pi}
    found, wanted = read(tmp_path / "set", table)[0].observations, shown[0].observations
    np.testing.assert_allclose(found.gripper_opening, wanted.gripper_opening, atol=1e-7)
    flip = np.array([-1, -1, 1])
    moved = wanted.object_positions * flip + np.array([0.5, 0.5, 0.25])
    np.testing.assert_allclose(found.object_positions, moved, atol=1e-6)
    w, x, y, z = wanted.gripper_quaternion.astype(np.float64).T
    out = np.stack((2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)), axis=1)
    tips = (wanted.gripper_position + 0.1 * out) * flip + np.array([0.5, 0.5, 0.25])
    np.testing.assert_allclose(found.gripper_position, tips, atol=1e-6)
    half = np.sqrt(0.5)
    turned = quaternion_product(wanted.gripper_quaternion, [half, 0, 0, half])
    turned = quaternion_product([0, 0, 0, 1], turned)
    np.testing.assert_allclose(found.gripper_quaternion, turned, atol=1e-6)


@pytest.mark.parametrize("unit", ["rad", "deg"])
def test_orientations_in_every_format_are_the_same(unit: Any) -> None:
    scale = 1.0 if unit == "rad" else 180 / np.pi
    yaws = np.array([-2.0, 0.0, 0.5])
    down, up = gripper_down(yaws), np.array([[np.cos(y / 2), 0, 0, np.sin(y / 2)] for y in yaws])
    vectors = np.array([[0, 0, yaw] for yaw in yaws])

    def found(values: Any, kind: Any, down: bool = False) -> Any:
        config = OrientationConfig(feature="x", format=kind, unit=unit)
        return quaternions(np.asarray(values), config, down=down)

    np.testing.assert_allclose(found(down[:, [1, 2, 3, 0]], "xyzw"), down)
    np.testing.assert_allclose(found(scale * yaws[:, None], "yaw", down=True), down)
    np.testing.assert_allclose(found(scale * yaws[:, None], "yaw"), up)
    np.testing.assert_allclose(found(scale * vectors, "rotation-vector"), up, atol=1e-12)
    rolled = scale * np.array([[np.pi, 0, yaw] for yaw in yaws])
    np.testing.assert_allclose(found(rolled, "rpy"), down, atol=1e-12)
    # Fixed axes: the pitch tilts about the world's y axis, whatever the yaw.
    (tilted,) = found(scale * np.array([[0.0, 0.5, np.pi / 2]]), "rpy")
    assert yaw_of(tilted) == pytest.approx(np.pi / 2)
    assert 2 * (tilted[2] * tilted[3] - tilted[0] * tilted[1]) == pytest.approx(np.sin(0.5))


def test_what_is_held_and_what_was_done_are_told_from_poses() -> None:
    opening = np.array([0.08, 0.08, 0.06, 0.04, 0.04, 0.04, 0.06, 0.08])
    gripper = np.zeros((8, 3))
    gripper[:, 2] = [0.1, 0.01, 0.01, 0.01, 0.05, 0.1, 0.1, 0.1]
    thing = np.zeros((8, 3))
    thing[:, 2] = [0.0, 0.0, 0.0, 0.0, 0.04, 0.09, 0.06, 0.0]
    held = told_held(gripper, opening, thing)
    assert held.tolist() == [False, False, True, True, True, True, True, False]
    assert not told_held(gripper, 0.0 * opening, thing).any()  # closed on nothing
    yaws = np.array([3.1, -3.1, -3.1, -3.1, -3.1, -3.1, -3.1, -3.1])
    actions = told_actions(gripper, gripper_down(yaws), opening)
    assert actions[:, 4].tolist() == [-1, 1, 1, 1, 1, -1, -1, -1]
    np.testing.assert_allclose(actions[:, 2], [-0.05, 0, 0, 0.04, 0.05, 0, 0, 0], atol=1e-6)
    assert actions[0, 3] == pytest.approx(2 * np.pi - 6.2, abs=1e-6)
    assert not actions[:, :2].any() and not actions[-1, :4].any()


def test_poses_alone_are_enough(tmp_path: Path) -> None:
    shown = foreign(tmp_path / "set")
    table = changed("action", None)
    del table["objects"]["bin"]["held"]
    (found, *_), wanted = read(tmp_path / "set", table), shown[0].observations
    step = found.observations.gripper_position[1, 0] - found.observations.gripper_position[0, 0]
    assert found.actions[0, 0] == pytest.approx(np.clip(step, -0.05, 0.05), abs=1e-6)
    np.testing.assert_array_equal(found.observations.held[:, 0], wanted.held[:, 0])


HAS = "feature 'arm.pose' has 7 numbers (x, y, z, qx, qy, qz, qw)"
MISTAKES: dict[str, tuple[str, Any, str]] = {
    "feature": (
        "joints.feature",
        "arm.joint",
        "joints.feature: SET/meta/info.json has no feature 'arm.joint'; it has action, arm.joints, "
        "arm.pose, bin, ",
    ),
    "name": (
        "gripper.position.columns",
        ["x", "y", "height"],
        f"gripper.position.columns: there is no column 'height': {HAS}",
    ),
    "no names": (
        "objects.milk.held.columns",
        ["held"],
        "objects.milk.held.columns: there is no column 'held': feature 'milk' has 8 numbers, which "
        "have no names: give indices, such as [0, 1, 2]",
    ),
    "index": (
        "gripper.orientation.columns",
        [4, 5, 6, 7],
        f"gripper.orientation.columns: there is no column 7: {HAS}, counted from 0",
    ),
    "too few": (
        "gripper.orientation.columns",
        [3, 4, 5],
        f"gripper.orientation.columns: 3 columns are named; there should be 4: {HAS}",
    ),
    "all": (
        "gripper.position",
        {"feature": "arm.pose"},
        f"gripper.position.columns: 7 columns are named; there should be 3: {HAS}",
    ),
    "fingers": (
        "gripper.opening",
        {"feature": "arm.joints", "columns": ["j0", "j1", "j2"]},
        "gripper.opening.columns: 3 columns are named; there should be 1 or 2: feature",
    ),
    "object": (
        "objects.bin",
        None,
        "objects: 'bin' is missing: say which columns hold its pose. This environment has: milk, "
        "bin",
    ),
    "strange object": (
        "objects.can",
        TABLE["objects"]["bin"],
        "objects.can: this environment has no such object; it has: milk, bin",
    ),
}


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_mapping_that_does_not_fit_names_the_key(tmp_path: Path, mistake: str) -> None:
    foreign(tmp_path / "set")
    path, value, text = MISTAKES[mistake]
    with pytest.raises(ConfigurationError) as caught:
        read(tmp_path / "set", changed(path, value))
    assert str(caught.value).startswith(text.replace("SET", str(tmp_path / "set")))


@pytest.mark.parametrize(
    ("path", "value", "text"),
    [
        ("gripper.opening.width", 0.08, "closed, open and width go together"),
        ("gripper.orientation.format", "zyxw", "Input should be 'wxyz', 'xyzw', 'rpy'"),
        ("gripper.orientation.format", None, "Field required"),
        ("joints.units", "deg", "unknown key 'units': did you mean 'unit'?"),
        ("joints.columns", [True, 1], "Input should be a number"),
        (
            "gripper.opening",
            {"feature": "f", "closed": 1, "open": 1, "width": 0.08},
            "closed and open are both 1.0: they must differ",
        ),
    ],
)
def test_a_mapping_that_is_none_is_refused(path: str, value: Any, text: str) -> None:
    with pytest.raises(ValidationError, match=re.escape(text)):
        ColumnsConfig.model_validate(changed(path, value))


def test_numbers_in_other_units_than_the_mapping_says_are_told(tmp_path: Path) -> None:
    foreign(tmp_path / "set")
    mapping = ColumnsConfig.model_validate(changed("gripper.position.unit", "m"))
    (found, *_) = read_demonstrations(tmp_path / "set", DESCRIPTION, columns=mapping)
    assert isinstance(found, DatasetError)
    assert "positions are metres in the world frame" in str(found)
