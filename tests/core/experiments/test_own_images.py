"""Demonstrations that come with images of the cameras that models see are seen as they are."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from rich.console import Console

from prime_core.checks.samples import DESCRIPTION
from prime_core.datasets.read import read_dataset, write_dataset
from prime_core.errors import DatasetError
from prime_core.experiments.experiment import Experiment
from prime_core.experiments.parse_dataset import parse_foreign
from prime_core.experiments.running import run_experiment

from ..datasets.test_foreign import DATA, edit_column
from ..point_mass import SOLVED_HEIGHT
from .toy_pack import ClimberConfig, PointMassConfig

Make = Callable[..., Experiment]

GREY = ("idm={type: toy/grey}", "images={cameras: [front], size: 8}")
FRONT = "observation.images.front"
WANTED = (
    "models see front at 8 x 8 pixels here: change the data set, or 'images' of the experiment, so "
    "that names and sizes are the same. Of a data set without any images they are made of poses"
)


def climbs(folder: Path, images: dict[str, tuple[int, ...]]) -> Path:
    """Write two climbs with images whose grey goes from 0 to 100, and from 1 to 101."""
    shown = []
    for index in range(2):
        one = ClimberConfig().demonstrate(PointMassConfig(), index, 7)
        greys = np.rint(np.linspace(0, 100, len(one.observations))).astype(np.uint8) + index
        seen = {
            name: np.broadcast_to(greys[:, None, None, None], (len(greys), *size, 3))
            for name, size in images.items()
        }
        shown.append(replace(one, observations=replace(one.observations, images=seen)))
    write_dataset(folder, shown, DESCRIPTION)
    return folder


def greys_of(images: Any) -> Any:
    return np.asarray(images)[:, 0, 0, 0].tolist()


def ends_of(parsed: Any) -> list[float]:
    """Return the height that the only rise of each ends at."""
    calls = [[item.call for item in one.segments] for one in parsed.values()]
    assert all([call.primitive for call in each] == ["rise"] for each in calls)
    return [round(float(call.parameters[0]), 6) for (call,) in calls]


def test_an_experiment_learns_from_the_images_of_a_data_set(toy: Make, tmp_path: Path) -> None:
    source = climbs(tmp_path / "climbs", {"front": (8, 8), "other": (9, 12)})
    job = toy(*GREY, f"demonstrations={{type: lerobot, path: {source}}}")
    run_experiment(job, Console(quiet=True), "export")
    kept = job.images.demonstrations.load()
    exported = read_dataset(job.export.folder / "dataset").demonstrations
    for item, one in enumerate(read_dataset(source).demonstrations):
        expected = np.asarray(one.observations.images["front"])
        for images in (kept[str(item)], exported[item].observations.images):
            assert [*images] == ["front"]
            np.testing.assert_array_equal(np.asarray(images["front"]), expected)


def test_the_export_has_images_where_models_see_some(toy: Make) -> None:
    job = toy(*GREY)
    run_experiment(job, Console(quiet=True), "export")
    for one in read_dataset(job.export.folder / "dataset").demonstrations:
        heights = np.rint(one.observations.gripper_position[:, 2] * 100)
        assert greys_of(one.observations.images["front"]) == heights.tolist()
    blind = toy(folder=job.folder.parent / "blind")
    assert "images" not in blind.export.infra.uid()
    run_experiment(blind, Console(quiet=True), "export")
    for one in read_dataset(blind.export.folder / "dataset").demonstrations:
        assert not one.observations.images


@pytest.mark.parametrize(
    ("images", "problem"),
    [
        ({"top": (8, 8)}, f"is missing. It has observation.images.top (8 x 8); {WANTED}"),
        ({"front": (8, 12)}, f"is 8 x 12 pixels. It has {FRONT} (8 x 12); {WANTED}"),
    ],
)
def test_other_cameras_and_sizes_are_refused(
    toy: Make, tmp_path: Path, images: dict[str, tuple[int, ...]], problem: str
) -> None:
    source = climbs(tmp_path / "climbs", images)
    job = toy(*GREY, f"demonstrations={{type: lerobot, path: {source}}}")
    with pytest.raises(DatasetError) as caught:
        run_experiment(job, Console(quiet=True), "export")
    assert str(caught.value) == f"{source}: feature '{FRONT}' {problem}"
    run = toy(*GREY, folder=tmp_path / "other")
    run_experiment(run, Console(quiet=True), "idm")
    with pytest.raises(DatasetError) as caught:
        parse_foreign(source, run.folder, tmp_path / "out")
    assert str(caught.value) == f"{source}: feature '{FRONT}' {problem}"
    assert not (tmp_path / "out").exists()


def test_prime_parse_looks_at_the_images_of_a_data_set(toy: Make, tmp_path: Path) -> None:
    """Their greys say other heights than the poses do."""
    job = toy(*GREY)
    run_experiment(job, Console(quiet=True), "idm")
    source = climbs(tmp_path / "climbs", {"front": (8, 8), "other": (9, 12)})
    parsed = parse_foreign(source, job.folder, tmp_path / "out").parsed
    assert ends_of(parsed) == [1.0, 1.01]
    written = [read_dataset(folder).demonstrations for folder in (tmp_path / "out", source)]
    for one, own in zip(*written, strict=True):
        assert [*one.observations.images] == ["front"]
        expected = greys_of(own.observations.images["front"])
        assert greys_of(one.observations.images["front"]) == expected


def test_prime_parse_makes_images_of_poses_where_there_are_none(toy: Make, tmp_path: Path) -> None:
    job = toy(*GREY)
    run_experiment(job, Console(quiet=True), "idm")
    source = climbs(tmp_path / "climbs", {})
    found = parse_foreign(source, job.folder, tmp_path / "out")
    assert min(ends_of(found.parsed)) > SOLVED_HEIGHT
    assert not read_dataset(tmp_path / "out").demonstrations[0].observations.images


def broken(folder: Path) -> Path:
    """Spoil an image of the second of two climbs."""

    def spoil(column: Any) -> Any:
        items = column.to_pylist()
        items[-2]["bytes"] = items[-2]["bytes"][:50]
        return pa.array(items, column.type)

    edit_column(climbs(folder, {"front": (8, 8)}), DATA, FRONT, spoil)
    return folder


def test_a_broken_image_costs_its_demonstration_where_it_is_seen(toy: Make, tmp_path: Path) -> None:
    source = broken(tmp_path / "climbs")
    frame = len(read_dataset(source).demonstrations[1].observations) - 2
    reason = (
        f"{source}/{DATA}: column '{FRONT}': the image of episode 1, frame {frame}, is damaged "
        "(image file is truncated): take a whole copy"
    )
    job = toy(*GREY)
    run_experiment(job, Console(quiet=True), "idm")
    with pytest.raises(DatasetError, match="1 of 2 demonstrations cannot be used and 'strict' as"):
        parse_foreign(source, job.folder, tmp_path / "strict", strict=True)
    found = parse_foreign(source, job.folder, tmp_path / "out")
    assert found.left_out == {"1": reason} and [*found.parsed] == ["0"]
    learning = toy(
        *GREY, f"demonstrations={{type: lerobot, path: {source}}}", folder=tmp_path / "other"
    )
    with pytest.raises(DatasetError) as caught:
        run_experiment(learning, Console(quiet=True), "export")
    assert str(caught.value) == reason
    # Nobody looks at it in a run of states, whatever its cameras are.
    blind = toy(folder=tmp_path / "blind")
    run_experiment(blind, Console(quiet=True), "idm")
    found = parse_foreign(source, blind.folder, tmp_path / "blind-out")
    assert min(ends_of(found.parsed)) > SOLVED_HEIGHT and not found.left_out
    assert not read_dataset(tmp_path / "blind-out").demonstrations[0].observations.images
