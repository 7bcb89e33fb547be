"""Writes an HDF5 file in robomimic's layout, one demonstration after another."""

import json
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from prime_core.contracts.demonstration import Demonstration
from prime_core.contracts.environment import CONTROL_FREQUENCY
from prime_core.contracts.images import Images
from prime_core.errors import DatasetError, DemonstrationError, PrimeError
from prime_envs_robosuite.environment import RobosuiteEnvironment
from prime_envs_robosuite.recordings.hdf5_file import SIMULATOR_STATES
from prime_envs_robosuite.recordings.recorded_settings import ROBOSUITE, ROBOT
from prime_envs_robosuite.recordings.robomimic_columns import (
    low_dimensional,
    osc_actions,
    solved_after,
)
from prime_envs_robosuite.simulation.physics_model import model_xml

AT_ONCE = 64
"""Images that are read and written at a time."""


def write_demonstrations(
    path: Path,
    demonstrations: Iterable[Demonstration],
    environment: RobosuiteEnvironment,
    task: str,
) -> list[str]:
    """Write a new file, and return the names of its groups.

    Args:
        path: Of the file.
        demonstrations: At least one; each has a group ``demo_N`` of all that was done.
        environment: That they are of; its state is changed.
        task: robosuite's name of it.

    Raises:
        DatasetError: If there is none.
        DemonstrationError: If one cannot be written so.
        OSError: If the file cannot be written.
    """
    import h5py

    names: list[str] = []
    total = 0
    with h5py.File(path, "w") as file:
        data = file.create_group("data")
        data.attrs["env_args"] = json.dumps(_environment_arguments(environment, task))
        for number, shown in enumerate(demonstrations):
            with _named(number):
                names.append(f"demo_{number}")
                _write_demonstration(data.create_group(names[-1]), shown, environment)
            total += shown.steps
        if not names:
            raise DatasetError("no demonstrations to write: a file has at least one")
        data.attrs["total"] = total
    return names


def write_masks(path: Path, names: list[str], validation_share: float, seed: int) -> None:
    """Say in ``mask/train`` and ``mask/valid`` which demonstrations to learn from.

    Args:
        path: Of the file.
        names: Of all groups.
        validation_share: Share of those that are not learnt from, at least one.
        seed: Of the draw.

    Raises:
        DatasetError: If none would be left to learn from.
    """
    import h5py

    count = max(1, round(validation_share * len(names)))
    if count >= len(names):
        raise DatasetError(
            f"validation_share {validation_share:g} of {len(names)} demonstrations leaves none to "
            "learn from: make it less, or show more"
        )
    order = np.random.default_rng(seed).permutation(len(names))
    masks = {"valid": np.sort(order[:count]), "train": np.sort(order[count:])}
    with h5py.File(path, "r+") as file:
        for key, chosen in masks.items():
            file[f"mask/{key}"] = np.array([names[index] for index in chosen], dtype="S")


def _environment_arguments(environment: RobosuiteEnvironment, task: str) -> dict[str, Any]:
    """Return how robomimic makes the environment; robosuite has no TidyUp and CleanUp."""
    import robosuite

    settings = {
        "robots": [ROBOT],
        "controller_configs": dict(environment.host.robots[0].composite_controller_config),
        "control_freq": CONTROL_FREQUENCY,
        "has_renderer": False,
        "has_offscreen_renderer": False,
        "use_camera_obs": False,
        "use_object_obs": True,
        "ignore_done": True,
        "reward_shaping": False,
    }
    return {
        "env_name": task,
        "env_version": robosuite.__version__,
        "type": ROBOSUITE,
        "env_kwargs": settings,
    }


@contextmanager
def _named(number: int) -> Iterator[None]:
    """Say of which demonstration an error tells."""
    try:
        yield
    except PrimeError as error:
        raise DemonstrationError(f"demonstration {number}: {error}") from error


def _write_demonstration(
    group: Any, shown: Demonstration, environment: RobosuiteEnvironment
) -> None:
    """Write what was done; the frame after the last action is in ``next_obs`` alone."""
    if not shown.steps:
        raise DemonstrationError("it has one frame: no motor action was done")
    seen, states = shown.observations, shown.simulator_states
    group.attrs["num_samples"] = shown.steps
    group.attrs["model_file"] = model_xml(environment.host)
    solved = solved_after(shown, environment)
    group["actions"] = osc_actions(shown.actions[:-1])
    group["rewards"] = solved.astype(np.float64)
    # robomimic's own: an episode may end wherever the task is solved, and does at its end.
    group["dones"] = np.append(solved[:-1], True).astype(np.int64)
    if states is not None:
        model = environment.host.sim.model
        group["states"] = states[:-1, : 1 + int(model.nq) + int(model.nv)]  # time, qpos, qvel
        group[SIMULATOR_STATES] = states
    for key, values in low_dimensional(seen, environment.description).items():
        group[f"obs/{key}"], group[f"next_obs/{key}"] = values[:-1], values[1:]
    for name, images in seen.images.items():
        _write_images(group, name, images)


def _write_images(group: Any, name: str, images: Images) -> None:
    """Write a camera's images, ``(N, H, W, 3)``, as robomimic has them: one file, no videos."""
    count = images.shape[0] - 1
    for key, first in (("obs", 0), ("next_obs", 1)):
        shape = (count, *images.shape[1:])
        stored = group.create_dataset(
            f"{key}/{name}_image", shape, np.uint8, chunks=(1, *shape[1:])
        )
        for start in range(0, count, AT_ONCE):
            rows = np.arange(start, min(start + AT_ONCE, count))
            stored[rows[0] : rows[-1] + 1] = images[rows + first]
