"""LeRobot data sets are written whole or not at all."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from prime_core.contracts.calls import PrimitiveCall
from prime_core.contracts.demonstration import Segment
from prime_core.datasets.read import read_dataset, write_dataset
from prime_core.errors import DatasetError

from .samples import (
    DESCRIPTION,
    SPACE,
    demonstration,
    fingerprint,
    write,
)


def test_an_existing_folder_is_kept(tmp_path: Path) -> None:
    write(tmp_path / "set")
    before = fingerprint(tmp_path / "set")
    with pytest.raises(DatasetError, match="is there already"):
        write(tmp_path / "set")
    (tmp_path / "precious").mkdir()
    (tmp_path / "precious" / "thesis.tex").write_text("x")
    with pytest.raises(DatasetError, match="is no data set"):
        write(tmp_path / "precious", replace=True)
    assert fingerprint(tmp_path / "set") == before
    assert (tmp_path / "precious" / "thesis.tex").exists()


def test_replacing_leaves_the_new_one_only(tmp_path: Path) -> None:
    write(tmp_path / "set", parsed=True)
    write(tmp_path / "set", replace=True)
    assert read_dataset(tmp_path / "set").segments is None
    assert [path.name for path in tmp_path.iterdir()] == ["set"]


def test_a_failure_leaves_the_old_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write(tmp_path / "set")
    before = fingerprint(tmp_path / "set")

    def fail(*_: object) -> None:
        raise OSError("no space left on device")

    monkeypatch.setattr("prime_core.datasets.parquet_writer.write_episodes", fail)
    with pytest.raises(OSError, match="no space left"):
        write(tmp_path / "set", replace=True)
    with pytest.raises(OSError, match="no space left"):
        write(tmp_path / "new")
    assert fingerprint(tmp_path / "set") == before
    assert [path.name for path in tmp_path.iterdir()] == ["set"]


def test_what_does_not_fit_is_not_written(tmp_path: Path) -> None:
    good, folder = demonstration(12), tmp_path / "set"
    narrow = replace(good, actions=good.actions[:, :4])
    with pytest.raises(DatasetError, match=r"demonstration 1: action has shape \(12, 4\)"):
        write_dataset(folder, [good, narrow], DESCRIPTION)
    with pytest.raises(DatasetError, match="either all have simulator states or none"):
        write_dataset(folder, [good, replace(good, simulator_states=None)], DESCRIPTION)
    blind = replace(good, observations=good.observations.only(["proprioception"]))
    with pytest.raises(DatasetError, match="demonstration 1 does not tell where objects are"):
        write_dataset(folder, [good, blind], DESCRIPTION)
    holed = replace(good, actions=np.where(good.actions > 0, np.nan, good.actions))
    with pytest.raises(DatasetError, match="demonstration 0: action holds NaN"):
        write_dataset(folder, [holed], DESCRIPTION)
    with pytest.raises(DatasetError, match="at least one episode"):
        write_dataset(folder, [], DESCRIPTION)
    late = [Segment(0, 12, PrimitiveCall("reach", np.zeros(1)), 0.0)]
    with pytest.raises(ValueError, match="ends at 11 or earlier"):
        write_dataset(folder, [good], DESCRIPTION, segments=[late], space=SPACE)
    unknown = [Segment(0, 11, PrimitiveCall("wipe", np.zeros(1)), 0.0)]
    with pytest.raises(ValueError, match="'wipe'; the space has reach, grasp and other"):
        write_dataset(folder, [good], DESCRIPTION, segments=[unknown], space=SPACE)
    assert list(tmp_path.iterdir()) == []
