"""Videos of data sets: frames are picked by the clock, when they are indexed."""

import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from prime_core.datasets.read import read_dataset, write_dataset
from prime_core.errors import DemonstrationError
from prime_core.reporting.video import write_video

from .edits import edit_column, edit_info
from .samples import DATA, DESCRIPTION, EPISODES, assert_same, demonstration

TOP = "observation.images.top"
VIDEO = f"videos/{TOP}/chunk-000/file-000.mp4"
FROM = f"videos/{TOP}/from_timestamp"
LENGTHS = (6, 8, 5)
GREYS = np.arange(19) * 12 + 15


def write(folder: Path) -> None:
    """Write three episodes of one video, in which each frame has its own grey."""
    items = [demonstration(frames, seed) for seed, frames in enumerate(LENGTHS)]
    write_dataset(folder, items, DESCRIPTION)
    frames = np.broadcast_to(GREYS[:, None, None, None], (19, 32, 48, 3)).astype(np.uint8)
    write_video(folder / VIDEO, frames)
    feature = {"dtype": "video", "shape": [32, 48, 3], "names": ["height", "width", "channels"]}
    path = "videos/{video_key}/chunk-{chunk_index:03d}/file-{file_index:03d}.mp4"
    edit_info(folder, lambda info: info.update(video_path=path))
    edit_info(folder, lambda info: info["features"].update({TOP: feature}))
    table = pq.read_table(folder / EPISODES, partitioning=None)
    starts = np.cumsum((0, *LENGTHS[:-1])) / 20
    for name in ("chunk_index", "file_index"):
        table = table.append_column(f"videos/{TOP}/{name}", pa.array([0, 0, 0]))
    pq.write_table(table.append_column(FROM, pa.array(starts)), folder / EPISODES)


def images_of(folder: Path, episode: int) -> Any:
    (found,) = read_dataset(folder, DESCRIPTION, episodes=[episode]).demonstrations
    assert_same(found, demonstration(LENGTHS[episode], episode))
    return found.observations.images["top"]


def greys_of(images: Any) -> Any:
    return np.asarray(images).mean(axis=(1, 2, 3))


def failure(folder: Path, episode: int, frames: list[int]) -> str:
    images = images_of(folder, episode)
    with pytest.raises(DemonstrationError) as caught:
        images[np.array(frames)]
    text = str(caught.value)
    assert text.startswith(str(folder))
    return text.removeprefix(f"{folder}/")


def test_each_frame_is_the_one_of_its_time(tmp_path: Path) -> None:
    write(tmp_path / "set")
    first = 0
    for episode, length in enumerate(LENGTHS):
        images, greys = images_of(tmp_path / "set", episode), GREYS[first : first + length]
        assert images.shape == (length, 32, 48, 3)
        np.testing.assert_allclose(greys_of(images), greys, atol=3)
        for rows in ([4], [3, 0, 3, 1], [0]):
            np.testing.assert_allclose(greys_of(images[np.array(rows)]), greys[rows], atol=3)
        assert images[np.array([], dtype=np.int64)].shape == (0, 32, 48, 3)
        first += length


def test_the_clock_of_the_data_says_when(tmp_path: Path) -> None:
    """An episode may begin late: LeRobot cuts the start of a recording off."""
    write(tmp_path / "set")

    def late(column: Any) -> Any:
        return pa.array(np.asarray(column) + np.float32(0.1), pa.float32())

    edit_column(tmp_path / "set", DATA, "timestamp", late)
    np.testing.assert_allclose(greys_of(images_of(tmp_path / "set", 0)), GREYS[2:8], atol=3)


def test_what_is_wrong_with_a_video_is_told_when_it_is_looked_at(tmp_path: Path) -> None:
    folder = tmp_path / "set"
    write(folder)
    edit_column(folder, EPISODES, FROM, lambda _: pa.array([0.0, 0.3, 0.8]))
    assert failure(folder, 2, [0, 4, 3]) == (
        f"{VIDEO}: '{TOP}': frame 4 of episode 2 should be 1 s from the start, and the video has "
        "no frame then; the last that was found is at 0.9 s: take a whole copy"
    )
    edit_column(folder, EPISODES, FROM, lambda _: pa.array([0.02, -1.0, 1e300]))
    assert "frame 1 of episode 0 should be 0.07 s" in failure(folder, 0, [1])
    for episode, start in ((1, "-1.0"), (2, "1e+300")):
        assert failure(folder, episode, [0]) == (
            f"{EPISODES}: {FROM} is {start} in episode {episode}; it should be the seconds from "
            "the video's start"
        )
    edit_column(folder, EPISODES, FROM, lambda _: pa.array([0.0, 0.3, 0.7]))
    edit_info(folder, lambda info: info["features"][TOP].update(shape=[48, 32, 3]))
    assert failure(folder, 0, [0]) == (
        f"{VIDEO}: '{TOP}': frames are 32 x 48 pixels; they should be 48 x 32, as meta/info.json "
        "says"
    )


@pytest.mark.parametrize("kept", [0, 30, 400])
def test_a_broken_video_is_told(tmp_path: Path, kept: int) -> None:
    write(tmp_path / "set")
    path = tmp_path / "set" / VIDEO
    path.write_bytes(path.read_bytes()[:kept])
    text = failure(tmp_path / "set", 1, [2])
    assert text.startswith(f"{VIDEO}: '{TOP}': the video cannot be decoded in episode 1 (")
    assert text.endswith("): take a whole copy") and str(tmp_path) not in text


def test_bytes_in_the_middle_are_told_or_cost_no_frame(tmp_path: Path) -> None:
    write(tmp_path / "set")
    path = tmp_path / "set" / VIDEO
    data = bytearray(path.read_bytes())
    middle = data.index(b"mdat") + 800
    data[middle:] = bytes(len(data) - middle)
    path.write_bytes(data)
    assert failure(tmp_path / "set", 2, [4]).startswith(f"{VIDEO}: '{TOP}': ")


def test_a_video_that_is_missing_is_told(tmp_path: Path) -> None:
    folder = tmp_path / "set"
    write(folder)
    shutil.rmtree(folder / "videos")
    assert failure(folder, 1, [0]) == (f"{VIDEO} is missing: it should hold '{TOP}' of episode 1")
    wanted = (
        "it should be a path inside of the data set: LeRobot has "
        "'videos/{video_key}/chunk-{chunk_index:03d}/file-{file_index:03d}.mp4'"
    )
    for template in (None, 7, "../{video_key}.mp4", "{video_key!r}", "{episode}"):
        edit_info(folder, lambda info, path=template: info.update(video_path=path))  # type: ignore[misc]
        assert failure(folder, 1, [0]) == f"meta/info.json: video_path is {template!r}; {wanted}"
    table = pq.read_table(folder / EPISODES, partitioning=None)
    pq.write_table(table.drop_columns([FROM]), folder / EPISODES)
    assert failure(folder, 1, [0]).startswith(f"{EPISODES} has no column '{FROM}'; it has ")
