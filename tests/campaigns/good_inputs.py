"""Small good inputs of every kind: a finished run, its data set, recordings, and bombs.

out/lift-quick   the finished run
given            what a user brings: experiments, a data set, recordings
neighbour        what nobody may change
bombs            small files that stand for very many numbers
"""

import json
import os
import shutil
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from contained_command import Limits, run_contained

from prime_core.datasets.files.layout import MOTION_KEY
from prime_core.experiments.reading import apply_setting
from prime_core.experiments.yaml_text import dump_yaml, read_mapping

ROOT = Path(__file__).parents[2]
RUN = "lift-quick"
TINY = [
    *(ROOT / "tests" / "tiny_experiment.txt").read_text().split(),
    "idm.steps_per_epoch=3",
    "policies.prime.steps_per_epoch=3",
    "policies.prime.finetuning_steps_per_epoch=3",
    "compute.workers=0",
]
LAST = "evaluation.prime"
FRAMES = 40
BOMB_ROWS = 2_000_000
ROBOMIMIC = {
    "env_name": "Lift",
    "env_version": "1.4.1",
    "type": 1,
    "env_kwargs": {
        "robots": ["Panda"],
        "control_freq": 20,
        "controller_configs": {"type": "OSC_POSE", "control_delta": True},
    },
}


def make_inputs(base: Path) -> None:
    """Make the folder of good inputs, unless it is there."""
    if (base / "complete").exists():
        return
    shutil.rmtree(base, ignore_errors=True)
    given = base / "given"
    for name in (given, base / "neighbour", base / "bombs", base / "out"):
        name.mkdir(parents=True)
    data = read_mapping(ROOT / "experiments" / "lift_quick.yaml")
    for setting in TINY:
        apply_setting(data, setting)
    (given / "lift.yaml").write_text(dump_yaml(data))
    for name, demonstrator in {
        "from_lerobot": {"type": "lerobot", "path": "given/dataset"},
        "from_robosuite": {"type": "robosuite-hdf5", "path": "given/robosuite.hdf5"},
        "from_robomimic": {"type": "robosuite-hdf5", "path": "given/robomimic.hdf5"},
    }.items():
        mine = {**data, "name": name, "demonstrations": demonstrator}
        (given / f"{name}.yaml").write_text(dump_yaml(mine))
    run = ["run", "given/lift.yaml", "--out", "out", "--until", LAST]
    done = run_contained(run, base, Limits(900, 4 * 2**30))
    if done.code:
        raise SystemExit(f"the good run ended with {done.code}: {done.stderr}")
    folder = base / "out" / RUN
    shutil.copytree(os.path.realpath(folder / "dataset"), given / "dataset")
    results = json.loads((folder / "results.json").read_text())
    del results["checksum"]  # as one that was edited
    (given / "results.json").write_text(json.dumps(results, indent=1))
    _record(given)
    _make_bombs(base / "bombs", given / "dataset")
    (base / "neighbour" / "precious.txt").write_text("nobody may change this\n")
    shutil.copy(given / "robosuite.hdf5", base / "neighbour" / "other.hdf5")
    (base / "complete").touch()


def _record(folder: Path) -> None:
    """Write what robosuite's recorder and robomimic would have written of a hand that goes down."""
    from prime_envs_robosuite.config import LiftConfig

    lift = LiftConfig().build()
    lift.reset(seed=0)
    rows = [lift.get_state()[:32]]
    for _ in range(FRAMES - 1):
        lift.step(np.array([0.0, 0.0, -0.005, 0.0, -1.0]))
        rows.append(lift.get_state()[:32])
    lift.close()
    states = np.stack(rows)
    states[:, 0] = 0.05 * np.arange(FRAMES)
    actions = np.tile([0.0, 0.0, -0.1, 0.0, 0.0, 0.0, -1.0], (FRAMES, 1))
    cube = states[:, [10, 11, 12, 14, 15, 16, 13]]
    observed = {
        "robot0_joint_pos": states[:, 1:8],
        "robot0_gripper_qpos": states[:, 8:10],
        "cube_pos": cube[:, :3],
        "cube_quat": cube[:, 3:],
    }
    with h5py.File(folder / "robosuite.hdf5", "w") as file:
        _group(file, {"env": "Lift"}, {"states": states, "actions": actions})
    with h5py.File(folder / "robomimic.hdf5", "w") as file:
        arrays = {f"obs/{key}": values for key, values in observed.items()}
        _group(file, {"env_args": json.dumps(ROBOMIMIC)}, arrays | {"actions": actions})
        for name in ("demo_1", "demo_2"):
            file[f"data/{name}"].attrs["num_samples"] = FRAMES


def _group(file: Any, attributes: dict[str, str], arrays: dict[str, Any]) -> None:
    data = file.create_group("data")
    data.attrs.update(attributes)
    for name in ("demo_1", "demo_2"):
        for key, values in arrays.items():
            data[f"{name}/{key}"] = values


def _make_bombs(folder: Path, dataset: Path) -> None:
    """Write files of some kilobytes that stand for gigabytes."""
    with h5py.File(folder / "states.hdf5", "w") as file:
        data = file.create_group("data")
        data.attrs["env"] = "Lift"
        for key, width in (("states", 32), ("actions", 7)):
            data.create_dataset(f"demo_1/{key}", (BOMB_ROWS, width), "f8", chunks=(1000, width))
    (path,) = dataset.glob("data/*/*.parquet")
    few = pq.read_table(path).slice(0, 1).drop_columns([MOTION_KEY])  # slow to write
    many = pa.concat_tables([few] * 200_000).combine_chunks()
    with pq.ParquetWriter(folder / "frames.parquet", many.schema, compression="zstd") as writer:
        for _ in range(BOMB_ROWS // len(many)):
            writer.write_table(many)
