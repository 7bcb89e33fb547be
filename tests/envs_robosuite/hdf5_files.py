"""HDF5 files as robosuite's recorder writes them, and what is read of them."""

import json
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

from prime_core.contracts.demonstration import Demonstration
from prime_core.errors import DatasetError, DemonstrationError
from prime_envs_robosuite.config import LiftConfig
from prime_envs_robosuite.recordings.robosuite_hdf5 import RobosuiteHdf5Config

FRAMES = 6


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
