"""Images of data sets: what is written comes back, and nothing is read before it is indexed."""

import io
import json
import os
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from PIL import Image

from prime_core.contracts.demonstration import Demonstration
from prime_core.datasets.files import layout
from prime_core.datasets.read import read_dataset, write_dataset
from prime_core.errors import DatasetError, DemonstrationError

from .edits import INFO, edit_column, edit_info, refusal
from .samples import (
    CAMERAS,
    DATA,
    DESCRIPTION,
    assert_same,
    demonstration,
    fingerprint,
    pictured,
)

TOP = "observation.images.top"
LENGTHS = (5, 7)


def write(folder: Path) -> list[Demonstration]:
    written = [pictured(demonstration(frames, seed), seed) for seed, frames in enumerate(LENGTHS)]
    write_dataset(folder, written, DESCRIPTION)
    return written


def images_of(folder: Path, episode: int = 1, camera: str = "top") -> Any:
    return read_dataset(folder, DESCRIPTION).demonstrations[episode].observations.images[camera]


def failure(folder: Path, frame: int = 3) -> str:
    """Return what is said of a frame of the second episode, which is used from state alone."""
    images = images_of(folder)
    with pytest.raises(DemonstrationError) as caught:
        images[np.array([frame])]
    text = str(caught.value)
    assert text.startswith(str(folder))
    return text.removeprefix(f"{folder}/")


def test_images_come_back_bit_for_bit(tmp_path: Path) -> None:
    written = write(tmp_path / "set")
    found = read_dataset(tmp_path / "set", DESCRIPTION).demonstrations
    for left, right in zip(found, written, strict=True):
        assert_same(left, right)
        assert left.observations.images.keys() == CAMERAS.keys()
        for name, images in left.observations.images.items():
            expected = right.observations.images[name]
            assert images.shape == expected.shape
            np.testing.assert_array_equal(np.asarray(images), expected)
            np.testing.assert_array_equal(images[np.array([4, 0, 4])], expected[[4, 0, 4]])
            np.testing.assert_array_equal(np.asarray(images[1:3]), expected[1:3])
            assert images[np.array([], dtype=np.int64)].shape == (0, *expected.shape[1:])
    # Read images are written as they are: the same files again.
    write_dataset(tmp_path / "again", found, DESCRIPTION)
    assert fingerprint(tmp_path / "again") == fingerprint(tmp_path / "set")


def test_images_are_read_when_they_are_indexed_and_never_before(tmp_path: Path) -> None:
    written = write(tmp_path / "set")
    found = read_dataset(tmp_path / "set", DESCRIPTION).demonstrations
    (tmp_path / "set" / DATA).unlink()
    for left, right in zip(found, written, strict=True):
        assert_same(left, right)
        assert left.observations.images["top"].shape == (len(left.observations), 10, 16, 3)
    with pytest.raises(DemonstrationError, match=f"{DATA} is missing: the data set is not compl"):
        np.asarray(found[0].observations.images["top"])


class Watched:
    """Images that are made when they are indexed, and remember how."""

    def __init__(self, number: int, log: list[tuple[int, int]], frames: int) -> None:
        self.shape = (frames, 8, 8, 3)
        self._number, self._log = number, log

    def __getitem__(self, rows: Any) -> Any:
        self._log.append((self._number, len(rows)))
        images = np.zeros((len(rows), *self.shape[1:]), dtype=np.uint8)
        images[:] = np.asarray(rows)[:, None, None, None]
        return images


def test_images_are_written_a_few_at_a_time(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(layout, "DATA_FILE_MEGABYTES", 0.01)
    log: list[tuple[int, int]] = []
    items = []
    for number, frames in enumerate((150, 70)):
        one = demonstration(frames, number)
        seen = replace(one.observations, images={"top": Watched(number, log, frames)})
        items.append(replace(one, observations=seen))
    write_dataset(tmp_path / "set", items, DESCRIPTION)
    assert log == [(0, 64), (0, 64), (0, 22), (1, 64), (1, 6)]
    assert (tmp_path / "set/data/chunk-000/file-001.parquet").is_file()
    greys = images_of(tmp_path / "set", 0)[np.array([0, 63, 64, 149])][:, 0, 0, 0]
    assert greys.tolist() == [0, 63, 64, 149]


def test_statistics_are_those_of_the_frames_that_lerobot_looks_at(tmp_path: Path) -> None:
    """Of 150 frames 100 are looked at."""
    one = pictured(demonstration(150))
    write_dataset(tmp_path / "set", [one], DESCRIPTION)
    found = json.loads((tmp_path / "set/meta/stats.json").read_text())[TOP]
    chosen = np.round(np.linspace(0, 149, 100)).astype(int)
    pixels = np.asarray(one.observations.images["top"])[chosen].reshape(-1, 3) / 255
    assert found["count"] == [100]
    for name, expected in {
        "mean": pixels.mean(axis=0),
        "std": pixels.std(axis=0),
        "min": pixels.min(axis=0),
        "max": pixels.max(axis=0),
        "q50": np.quantile(pixels, 0.5, axis=0, method="inverted_cdf"),
        "q99": np.quantile(pixels, 0.99, axis=0, method="inverted_cdf"),
    }.items():
        np.testing.assert_allclose(np.array(found[name]), expected.reshape(3, 1, 1), atol=1e-9)


def test_demonstrations_must_have_the_same_images(tmp_path: Path) -> None:
    good = pictured(demonstration(5))
    seen = good.observations
    wrist = {"wrist": seen.images["wrist"]}
    for images, found in (
        ({}, "of no camera"),
        (wrist, "{'wrist': (5, 8, 8, 3)}"),
        ({"top": seen.images["top"][:4]}, "{'top': (4, 10, 16, 3)}"),
        (
            wrist | {"top": seen.images["top"][:, :9]},
            "{'wrist': (5, 8, 8, 3), 'top': (5, 9, 16, 3)}",
        ),
    ):
        other = replace(good, observations=replace(seen, images=images))
        with pytest.raises(DatasetError) as caught:
            write_dataset(tmp_path / "set", [good, other], DESCRIPTION)
        assert str(caught.value) == (
            f"demonstration 1 has images {found}; it should have {{'top': (5, 10, 16, 3), 'wrist': "
            "(5, 8, 8, 3)}: one of each frame, (height, width, 3), of the same cameras as "
            "demonstration 0"
        )
    assert not (tmp_path / "set").exists()


def edit_images(folder: Path, change: Callable[[dict[str, Any]], object], frame: int = 3) -> None:
    """Change the struct of one image of the second episode."""

    def changed(column: Any) -> Any:
        items = column.to_pylist()
        change(items[LENGTHS[0] + frame])
        return pa.array(items, column.type)

    edit_column(folder, DATA, TOP, changed)


def flipped(item: dict[str, Any]) -> None:
    data = bytearray(item["bytes"])
    data[len(data) // 2] ^= 4
    item["bytes"] = bytes(data)


def saved_as(mode: str, size: tuple[int, int]) -> Callable[[dict[str, Any]], object]:
    file = io.BytesIO()
    Image.new(mode, size).save(file, "PNG")
    return lambda item: item.update(bytes=file.getvalue())


PLACE = f"{DATA}: column '{TOP}': the image of episode 1, frame 3,"
RIGHT = "it should be 10 x 16 pixels, RGB, as meta/info.json says"
SPOILT: dict[str, tuple[Callable[[dict[str, Any]], object], str]] = {
    "a bit is flipped": (
        flipped,
        "is damaged (broken data stream when reading image file): take a whole copy",
    ),
    "it ends early": (
        lambda item: item.update(bytes=item["bytes"][:100]),
        "is damaged (image file is truncated): take a whole copy",
    ),
    "it is no image": (
        lambda item: item.update(bytes=b"none"),
        f"is no image of a format that is read (PNG, JPEG, WEBP); {RIGHT}",
    ),
    "another size": (saved_as("RGB", (16, 12)), f"is 12 x 16 pixels, RGB; {RIGHT}"),
    "no colours": (saved_as("L", (16, 10)), f"is 10 x 16 pixels, L; {RIGHT}"),
    "nothing": (
        lambda item: item.update(bytes=None, path=None),
        "is missing: it has neither bytes nor a path",
    ),
    "a path to nowhere": (
        lambda item: item.update(bytes=None, path="images/1.png"),
        "has no bytes, and its path is 'images/1.png': it should be a file inside of the data set",
    ),
    "a path to elsewhere": (
        lambda item: item.update(bytes=None, path="../secret.png"),
        "has no bytes, and its path is '../secret.png': it should be a file inside of the data set",
    ),
}


@pytest.mark.parametrize("kind", SPOILT)
def test_a_spoilt_image_is_told_by_its_frame(tmp_path: Path, kind: str) -> None:
    change, text = SPOILT[kind]
    Image.new("RGB", (16, 10)).save(tmp_path / "secret.png")
    written = write(tmp_path / "set")
    edit_images(tmp_path / "set", change)
    assert failure(tmp_path / "set") == f"{PLACE} {text}"
    others = np.array([0, 2, 4])
    expected = written[1].observations.images["top"][others]
    np.testing.assert_array_equal(images_of(tmp_path / "set")[others], expected)


@pytest.mark.parametrize("absolute", [False, True])
def test_images_in_files_of_their_own_are_read(tmp_path: Path, absolute: bool) -> None:
    written = write(tmp_path / "set")
    name = f"images/{TOP}/episode-000001/frame-000003.png"
    path = tmp_path / "set" / name
    path.parent.mkdir(parents=True)

    def moved(item: dict[str, Any]) -> None:
        path.write_bytes(item["bytes"])
        item.update(bytes=None, path=os.fspath(path) if absolute else name)

    edit_images(tmp_path / "set", moved)
    expected = written[1].observations.images["top"]
    np.testing.assert_array_equal(np.asarray(images_of(tmp_path / "set")), expected)


def test_images_of_other_columns_are_refused(tmp_path: Path) -> None:
    write(tmp_path / "set")
    files = "struct<bytes: binary, path: string>"
    edit_column(tmp_path / "set", DATA, TOP, lambda column: column.field("bytes"))
    assert failure(tmp_path / "set") == (
        f"{DATA}: column '{TOP}' is binary; it should be LeRobot's images: {files}"
    )
    images = images_of(tmp_path / "set", camera="wrist")
    path = tmp_path / "set" / DATA
    pq.write_table(pq.read_table(path, partitioning=None).slice(0, 10), path)
    with pytest.raises(DemonstrationError, match=r"has 5 images in episode 1; it should have 7$"):
        np.asarray(images)


def test_features_of_cameras_are_checked(tmp_path: Path) -> None:
    write(tmp_path / "set")

    def images(info: dict[str, Any]) -> Any:
        return info["features"][TOP]

    edit_info(tmp_path / "set", lambda info: images(info).update(shape=[3, 10, 16]))
    assert images_of(tmp_path / "set").shape == (7, 10, 16, 3)
    for change in (
        {"shape": [10, 16, 1]},  # LeRobot's depth in its first versions
        {"shape": [10, 16, 3], "info": {"is_depth_map": True}},
        {"shape": [10, 16, 3], "info": {"video.is_depth_map": True}},
        {"info": None, "video_info": {"video.is_depth_map": True}},
    ):
        edit_info(tmp_path / "set", lambda info, change=change: images(info).update(change))  # type: ignore[misc]
        (found, _) = read_dataset(tmp_path / "set", DESCRIPTION).demonstrations
        assert [*found.observations.images] == ["wrist"]
    for shape in ([10, 16], "10 x 16", [10, 16.0, 3]):
        edit_info(tmp_path / "set", lambda info, shape=shape: images(info).update(shape=shape))  # type: ignore[misc]
        edit_info(tmp_path / "set", lambda info: images(info).update(video_info=None))
        assert refusal(tmp_path / "set") == (
            f"{INFO}: feature '{TOP}' is image of shape {shape}; it should be [height, width, 3]"
        )
