"""Images go from here to LeRobot and back, as PNG files and as videos."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from prime_core.contracts.demonstration import Demonstration
from prime_core.datasets.read import read_dataset, write_dataset

from .samples import CAMERAS, DESCRIPTION, assert_same, demonstration, pictured, record

pytestmark = [pytest.mark.slow, pytest.mark.filterwarnings("ignore")]

FEATURES = {
    "observation.state": {"dtype": "float32", "shape": (15,), "names": None},
    "observation.environment_state": {"dtype": "float32", "shape": (16,), "names": None},
    "action": {"dtype": "float32", "shape": (5,), "names": None},
}
SIDES = ["height", "width", "channels"]


def assert_same_images(found: Demonstration, wanted: Demonstration, within: float = 0.0) -> None:
    assert found.observations.images.keys() == wanted.observations.images.keys()
    for name, images in found.observations.images.items():
        expected = np.asarray(wanted.observations.images[name]).astype(float)
        off = np.abs(np.asarray(images) - expected).max()
        assert off <= within, f"{name}: {off}"


def as_lerobot_has_it(image: Any) -> Any:
    return image.transpose(2, 0, 1).astype(np.float32) / 255


def test_lerobot_opens_and_resumes_what_has_images(tmp_path: Path, lerobot: Any) -> None:
    written = [pictured(demonstration(frames, seed), seed) for seed, frames in enumerate((4, 6))]
    root = tmp_path / "set"
    write_dataset(root, written, DESCRIPTION)
    opened = lerobot("local/set", root=root)
    assert opened.meta.camera_keys == ["observation.images.top", "observation.images.wrist"]
    numbered = [(item, frame) for item in written for frame in range(len(item.observations))]
    for index, (item, frame) in enumerate(numbered):
        for name in CAMERAS:
            found = opened[index][f"observation.images.{name}"].numpy()
            expected = as_lerobot_has_it(item.observations.images[name][frame])
            np.testing.assert_array_equal(found, expected)
    for name in CAMERAS:
        for statistic in ("mean", "std", "min", "max", "q01", "q99"):
            stats = opened.meta.stats[f"observation.images.{name}"]
            assert stats[statistic].shape == (3, 1, 1)

    added = pictured(demonstration(5, seed=9), seed=9)
    record(lerobot.resume("local/set", root=root), added)
    for found, wanted in zip(
        read_dataset(root, DESCRIPTION).demonstrations, [*written, added], strict=True
    ):
        assert_same(found, wanted)
        assert_same_images(found, wanted)


def test_images_of_lerobots_recorder_are_read(tmp_path: Path, lerobot: Any) -> None:
    written = [pictured(demonstration(5, seed, simulated=False), seed) for seed in range(2)]
    cameras = {
        f"observation.images.{name}": {"dtype": "image", "shape": (*size, 3), "names": SIDES}
        for name, size in CAMERAS.items()
    }
    root = tmp_path / "set"
    recorder = lerobot.create("local/set", 20, FEATURES | cameras, root=root, use_videos=False)
    record(recorder, written[0])
    record(lerobot.resume("local/set", root=root), written[1])
    for found, wanted in zip(read_dataset(root).demonstrations, written, strict=True):
        assert_same_images(found, wanted)


def test_videos_of_lerobots_recorder_are_read(tmp_path: Path, lerobot: Any) -> None:
    """Episodes share a file, and one has a file of its own."""
    written = [grey(seed) for seed in range(3)]
    camera = {"observation.images.a": {"dtype": "video", "shape": (48, 64, 3), "names": SIDES}}
    root = tmp_path / "set"
    recorder = lerobot.create("local/set", 20, FEATURES | camera, root=root, use_videos=True)
    record(recorder, written[0], finish=False)
    record(recorder, written[1])
    record(lerobot.resume("local/set", root=root), written[2])
    assert (root / "videos/observation.images.a/chunk-000/file-001.mp4").is_file()
    assert_same_videos(root, written, lerobot)


def test_lerobot_opens_and_resumes_what_has_videos(tmp_path: Path, lerobot: Any) -> None:
    written = [grey(seed) for seed in range(3)]
    root = tmp_path / "set"
    write_dataset(root, written[:2], DESCRIPTION, videos=True)
    assert_same_videos(root, written[:2], lerobot)
    theirs = lerobot("local/set", root=root, video_backend="pyav").meta
    assert theirs.video_keys == ["observation.images.a"]
    assert theirs.stats["observation.images.a"]["mean"].shape == (3, 1, 1)
    record(lerobot.resume("local/set", root=root), written[2])
    assert_same_videos(root, written, lerobot)
    write_dataset(tmp_path / "again", read_dataset(root).demonstrations, DESCRIPTION, videos=True)
    assert_same_videos(tmp_path / "again", written, lerobot)
    name = "videos/observation.images.a/chunk-000/file-000.mp4"
    assert (tmp_path / "again" / name).read_bytes() == (root / name).read_bytes()


def grey(seed: int) -> Demonstration:
    """Return a demonstration with six images, each of its own grey."""
    item = demonstration(6, seed, simulated=False)
    greys = np.arange(6, dtype=np.uint8) * 13 + 70 * seed + 20
    frames = np.broadcast_to(greys[:, None, None, None], (6, 48, 64, 3)).copy()
    frames[:, :24, :, 0] += 10  # what is up, and what is red
    return replace(item, observations=replace(item.observations, images={"a": frames}))


def assert_same_videos(root: Path, written: list[Demonstration], lerobot: Any) -> None:
    """Assert that we and LeRobot see the same in the videos of a data set, which is right."""
    found = read_dataset(root).demonstrations
    opened = lerobot("local/set", root=root, video_backend="pyav")
    for number, (one, wanted) in enumerate(zip(found, written, strict=True)):
        assert_same_images(one, wanted, within=6)
        images = one.observations.images["a"]
        for frame in (5, 0, 3):
            theirs = opened[6 * number + frame]["observation.images.a"].numpy()
            ours = as_lerobot_has_it(images[np.array([frame])][0])
            np.testing.assert_array_equal(ours, theirs)
