"""``prime annotate`` on a run of the toy pack, which needs no simulator."""

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
import typer
import yaml
from rich.console import Console

from prime_core.checks.samples import DESCRIPTION
from prime_core.cli.annotate import annotate
from prime_core.datasets.read import read_dataset, write_dataset
from prime_core.errors import ConfigurationError, DatasetError, PrimeError
from prime_core.experiments.annotate_dataset import annotate_dataset, frames_at, read_columns
from prime_core.experiments.experiment import Experiment
from prime_core.experiments.exporting.policy import Choice, export_policy
from prime_core.experiments.running import run_experiment

from ..datasets.edits import edit_info
from ..datasets.samples import DATA, fingerprint
from .toy_pack import ClimberConfig, PointMassConfig

Make = Callable[..., Experiment]

MAPPING = {
    "gripper": {
        "position": {"feature": "pose", "columns": ["px", "py", "pz"], "unit": "mm"},
        "orientation": {"feature": "pose", "columns": ["r", "p", "y"], "format": "rpy"},
        "opening": {"feature": "pose", "columns": ["open"]},
    },
    "joints": {"feature": "joints"},
    "objects": {
        item.name: {
            "position": {"feature": item.name, "columns": [0, 1, 2]},
            "orientation": {"feature": item.name, "columns": [3, 4, 5, 6], "format": "wxyz"},
        }
        for item in DESCRIPTION.objects
    },
}


def foreign(folder: Path, fps: int = 20) -> Path:
    """Write climbs as somebody else's recorder would, with a mapping of its columns beside it."""
    climber, environment = ClimberConfig(count=2, step=0.02 * 20 / fps), PointMassConfig()
    shown = [climber.demonstrate(environment, index, 7) for index in range(2)]
    write_dataset(folder, shown, DESCRIPTION)
    table = pq.read_table(folder / DATA)
    state, things = (
        np.array(table[key].to_pylist(), dtype=np.float64)
        for key in ("observation.state", "observation.environment_state")
    )
    columns = {
        "pose": np.hstack(
            (1000 * state[:, :3], np.tile([np.pi, 0.0, 0.0], (len(state), 1)), state[:, 7:8])
        ),
        "joints": state[:, 8:],
    }
    for number, item in enumerate(DESCRIPTION.objects):
        columns[item.name] = things[:, 8 * number : 8 * number + 7]
    names = {"pose": ["px", "py", "pz", "r", "p", "y", "open"]}
    kept = ("frame_index", "episode_index", "index", "task_index")
    arrays = {key: pa.array(list(values)) for key, values in columns.items()}
    clock = (np.array(table["frame_index"]) / fps).astype(np.float32)
    arrays |= {key: table[key] for key in kept} | {"timestamp": pa.array(clock)}
    pq.write_table(pa.table(arrays), folder / DATA)

    def change(info: dict[str, Any]) -> None:
        info["features"] = {key: info["features"][key] for key in (*kept, "timestamp")}
        for key, values in columns.items():
            info["features"][key] = {
                "dtype": "float64",
                "shape": [values.shape[1]],
                "names": names.get(key),
            }
        info["fps"] = fps

    edit_info(folder, change)
    (folder / "meta" / "prime.json").unlink()
    mapping = folder.with_suffix(".yaml")
    mapping.write_text(yaml.safe_dump(MAPPING))
    return mapping


def assert_same_files(left: Path, right: Path) -> None:
    """Compare data sets; of data files what is in them: arrow may call a list's items otherwise."""
    files = [
        {name: digest for name, digest in fingerprint(folder).items() if name != DATA}
        for folder in (left, right)
    ]
    assert files[0] == files[1]
    # As texts, for NaN is not equal to itself.
    assert str(pq.read_table(left / DATA).to_pylist()) == str(
        pq.read_table(right / DATA).to_pylist()
    )


def test_a_copy_is_annotated_and_what_was_left_out_is_listed(
    trained: Path, climbs: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = fingerprint(climbs)
    reason = f"{climbs}/{DATA}: column 'action' holds NaN or infinity in episode 1, frame 2; all"
    with pytest.raises(DatasetError) as caught:
        annotate_dataset(climbs, trained, tmp_path / "out", strict=True)
    assert f"1 of 3 demonstrations cannot be used and 'strict' asks for all:\n  1: {reason}" in str(
        caught.value
    )
    assert not (tmp_path / "out").exists()
    annotate(climbs, trained)
    said = " ".join(capsys.readouterr().out.split())
    assert "2 demonstrations, 1.0 primitives for 8 steps, 0.0% of the steps unexplained; " in said
    assert f"1 left out. Written to {climbs}-annotated 0: " in said
    assert f"0: rise (0.90) 2: rise (0.90) 1 left out: {reason}" in said
    assert fingerprint(climbs) == before
    table = pq.read_table(tmp_path / "climbs-annotated" / "meta" / "primitives.parquet")
    assert table["episode"].to_pylist() == [0, 2]
    assert table["confidence"].to_pylist() == pytest.approx([0.9, 0.9])
    with pytest.raises(DatasetError, match="is there already: choose another folder with --out"):
        annotate(climbs, trained)


def test_in_place_it_is_the_same_as_in_a_copy(trained: Path, climbs: Path, tmp_path: Path) -> None:
    annotate(climbs, trained, out=tmp_path / "out")
    annotate(climbs, trained, in_place=True)
    assert fingerprint(climbs) == fingerprint(tmp_path / "out")
    annotate(climbs, trained, in_place=True)
    assert_same_files(climbs, tmp_path / "out")
    with pytest.raises(typer.BadParameter, match="writes into the data set itself: leave out --o"):
        annotate(climbs, trained, in_place=True, out=tmp_path / "more")


@pytest.mark.parametrize("fps", [10, 20, 60])
def test_a_data_set_from_elsewhere_is_annotated_at_its_own_rate(
    trained: Path, tmp_path: Path, fps: int
) -> None:
    source = tmp_path / "set"
    mapping = foreign(source, fps)
    frames = pq.read_table(source / DATA)["episode_index"].to_pylist().count(0)
    found = annotate_dataset(source, trained, source, mapping)
    assert not found.left_out
    (segment,) = found.parsed["0"].segments
    assert (segment.start, segment.end) == (0, frames - 1)
    top = found.parsed["0"].demonstration.observations.gripper_position[-1, 2]
    assert segment.call.parameters == pytest.approx([top])
    kept = json.loads((source / "meta" / "prime.json").read_text())
    assert kept["columns"]["gripper"]["position"]["unit"] == "mm"
    # The mapping is kept with it: whoever reads the data set needs it no more.
    again = annotate_dataset(source, trained, tmp_path / "out")
    assert_same_files(tmp_path / "out", source)
    assert again.parsed["0"].segments[0].end == frames - 1
    read = read_dataset(source, DESCRIPTION, fps=None)
    assert read.segments is not None and read.segments[0][0].confidence == pytest.approx(0.9)
    with pytest.raises(DatasetError, match="it is read for an environment, by whose names"):
        read_dataset(source, fps=None)


def test_demonstrations_of_an_experiment_have_a_mapping_too(toy: Make, tmp_path: Path) -> None:
    foreign(tmp_path / "set")
    demonstrations = {"type": "lerobot", "path": str(tmp_path / "set"), "columns": MAPPING}
    job = toy(f"demonstrations={json.dumps(demonstrations)}", "evaluation.runner=plain")
    run_experiment(job, Console(quiet=True), "parsing")
    parsed = job.parsing.load()
    assert [item.primitives for item in parsed.values()] == [1, 1]
    (segment,) = parsed["0"].segments
    assert segment.confidence == pytest.approx(0.9)


def test_mistakes_name_the_file_and_the_key(trained: Path, tmp_path: Path) -> None:
    mapping = foreign(tmp_path / "set")
    for path, change, text in (
        ("joints", {"feature": "arm"}, "joints.feature: "),
        ("joints", {}, "joints.feature: this key is missing"),
        ("joint", {}, "unknown key 'joint': did you mean 'joints'?"),
    ):
        mapping.write_text(yaml.safe_dump({**MAPPING, path: change}))
        with pytest.raises(ConfigurationError) as caught:
            annotate_dataset(tmp_path / "set", trained, tmp_path / "out", mapping)
        assert str(caught.value).startswith(f"{mapping}: {text}")
    mapping.write_text("")
    with pytest.raises(ConfigurationError, match="nothing at the top: a mapping of columns is a"):
        read_columns(mapping)
    with pytest.raises(DatasetError, match="no feature 'observation"):
        annotate_dataset(tmp_path / "set", trained, tmp_path / "out")
    with pytest.raises(DatasetError, match=r"none/meta/info\.json is missing: a LeRobot v3"):
        annotate_dataset(tmp_path / "none", trained, tmp_path / "out")
    foreign(tmp_path / "other")
    with pytest.raises(ConfigurationError) as caught:
        annotate_dataset(tmp_path / "other", tmp_path, tmp_path / "out", tmp_path / "other.yaml")
    assert str(caught.value).startswith(f"{tmp_path}: there is no experiment.yaml in it")
    assert not (tmp_path / "out").exists()


def test_frames_nearest_to_another_clock() -> None:
    assert frames_at(20, 20, 5).tolist() == [0, 1, 2, 3, 4]
    assert frames_at(20, 30, 8).tolist() == [0, 2, 3, 4, 6, 7]
    assert frames_at(20, 60, 8).tolist() == [0, 3, 6, 7]
    assert frames_at(20, 10, 4).tolist() == [0, 1, 2, 3]
    assert frames_at(20, 60, 1).tolist() == [0]


def test_exported_models_need_no_environment(
    finished: Path, climbs: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    export_policy(finished, Choice("calls"), tmp_path / "exported")
    annotate_dataset(climbs, finished, tmp_path / "by-the-run")

    def absent(self: PointMassConfig) -> None:
        raise ImportError("no simulator is installed here")

    monkeypatch.setattr(PointMassConfig, "build", absent)
    annotate_dataset(climbs, tmp_path / "exported", tmp_path / "out")
    assert_same_files(tmp_path / "out", tmp_path / "by-the-run")
    shutil.rmtree(tmp_path / "exported" / "idm")
    with pytest.raises(PrimeError, match="idm holds no model"):
        annotate_dataset(climbs, tmp_path / "exported", tmp_path / "again")
    assert not (tmp_path / "again").exists()
