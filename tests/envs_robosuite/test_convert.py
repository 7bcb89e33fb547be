"""Recordings become data sets with images: the same ones however often they were stopped."""

import hashlib
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from rich.console import Console

from prime_core.datasets.demonstrator import LeRobotDemonstratorConfig
from prime_core.datasets.read import read_dataset
from prime_core.errors import PrimeError
from prime_core.experiments.conversion.asked import read_pictures
from prime_core.experiments.conversion.convert import Converted, convert
from prime_envs_robosuite.config import LiftConfig
from prime_envs_robosuite.environment import RobosuiteEnvironment

from .hdf5_files import FRAMES, good, read, record
from .test_foreign_hdf5 import ROBOMIMIC, observed

CAMERAS = ("agentview", "robot0_eye_in_hand")
PRIME = [sys.executable, "-c", "from prime_core.cli import main; main()"]
Convert = Callable[..., Converted]


@pytest.fixture
def recording(tmp_path: Path, states: Any) -> Path:
    """Four demonstrations, one of which cannot be read."""
    demos = {f"demo_{number}": good(np.roll(states, number, axis=0)) for number in (1, 2, 4)}
    for demo in demos.values():
        demo["states"][:, 0] = states[:, 0]  # the clock goes on
    demos["demo_3"] = good(states[:, :-1])
    return record(tmp_path / "demo.hdf5", {"env": "Lift"}, **demos)


def converted(source: Path, target: Path, *cameras: str, **changes: Any) -> Converted:
    size, kept_as = changes.pop("size", "32"), changes.pop("kept_as", "png")
    pictures = read_pictures(cameras, size, kept_as)
    return convert(source, target, pictures, Console(quiet=True), **{"workers": 0, **changes})


def refusal(*arguments: Any, **changes: Any) -> str:
    with pytest.raises(PrimeError) as caught:
        converted(*arguments, **changes)
    return str(caught.value)


def digests(folder: Path) -> dict[str, str]:
    files = (path for path in sorted(folder.rglob("*")) if path.is_file())
    return {
        str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in files
    }


def rendered(lift: RobosuiteEnvironment, seen: Any, size: tuple[int, int]) -> Any:
    return lift.pictures(seen, CAMERAS, *size)


def test_what_is_converted_is_what_was_recorded(
    recording: Path, tmp_path: Path, lift: RobosuiteEnvironment
) -> None:
    target = tmp_path / "set"
    found = converted(recording, target, *CAMERAS, size="24x32")
    wrong = f"{recording}: data/demo_3/states has rows of 31 numbers, must have 32: time, 16 joint "
    wrong += "positions and 15 joint velocities of a Panda and 1 object(s)"
    assert (found.demonstrations, found.frames) == (3, 3 * FRAMES)
    assert found.left_out == {"2": wrong}
    first, second, _, fourth = read(recording)
    dataset = read_dataset(target, lift.description)
    assert dataset.environment is not None
    assert dataset.environment["type"] == "robosuite/lift"
    source = LeRobotDemonstratorConfig(path=target)
    shown = [*source.demonstrations(LiftConfig(), range(3), 0)]
    for wanted, one, other in zip(
        (first, second, fourth), dataset.demonstrations, shown, strict=True
    ):
        for item in (one, other):
            for name in ("state", "environment_state"):
                left, right = getattr(item.observations, name), getattr(wanted.observations, name)
                np.testing.assert_array_equal(left, right)
            np.testing.assert_array_equal(item.actions, wanted.actions)
            np.testing.assert_array_equal(item.simulator_states, wanted.simulator_states)
            assert item.task == wanted.task
        pictures = rendered(lift, wanted.observations, (24, 32))
        for name in CAMERAS:
            np.testing.assert_array_equal(one.observations.images[name], pictures[name])
    assert {path.name for path in tmp_path.iterdir()} == {"demo.hdf5", "set"}


def test_observations_alone_are_enough(
    tmp_path: Path, states: Any, lift: RobosuiteEnvironment
) -> None:
    demo = {f"obs/{key}": values for key, values in observed(states, together=True).items()}
    demo |= {"actions": good(states)["actions"]}
    source = record(tmp_path / "low_dim.hdf5", {"env_args": ROBOMIMIC}, demo_0=demo)
    converted(source, tmp_path / "set", "agentview")
    (wanted,) = read(source)
    (found,) = read_dataset(tmp_path / "set", lift.description).demonstrations
    np.testing.assert_array_equal(found.observations.state, wanted.observations.state)
    pictures = rendered(lift, wanted.observations, (32, 32))["agentview"]
    np.testing.assert_array_equal(found.observations.images["agentview"], pictures)


def test_videos_show_what_png_files_do(recording: Path, tmp_path: Path) -> None:
    for kept_as in ("png", "video"):
        converted(recording, tmp_path / kept_as, "agentview", size="84", kept_as=kept_as)
    still, moving = (read_dataset(tmp_path / kept_as) for kept_as in ("png", "video"))
    assert len(list((tmp_path / "video" / "videos").rglob("*.mp4"))) == 3
    for one, other in zip(still.demonstrations, moving.demonstrations, strict=True):
        exact = np.asarray(one.observations.images["agentview"]).astype(float)
        off = np.abs(np.asarray(other.observations.images["agentview"]) - exact)
        assert off.mean() < 4
        assert off.max() > 0  # it is encoded, not copied


def test_without_cameras_there_are_no_images(recording: Path, tmp_path: Path) -> None:
    converted(recording, tmp_path / "set")
    converted(tmp_path / "set", tmp_path / "again")  # a data set is a source, too
    assert digests(tmp_path / "set") == digests(tmp_path / "again")
    (*_, last) = read_dataset(tmp_path / "set").demonstrations
    assert dict(last.observations.images) == {}


def command(source: Path, target: Path, workers: int) -> list[str]:
    cameras = [part for name in CAMERAS for part in ("--camera", name)]
    return [*PRIME, "convert", str(source), str(target), *cameras, "--workers", str(workers)]


@pytest.mark.slow
def test_after_kills_and_with_other_workers_the_bytes_are_the_same(
    states: NDArray[np.float64], tmp_path: Path
) -> None:
    still = np.tile(states[:1], (150, 1))
    still[:, 0] = 0.05 * np.arange(150)
    actions = np.zeros((150, 7))
    demos = {f"demo_{number}": {"states": still, "actions": actions} for number in range(8)}
    source = record(tmp_path / "demo.hdf5", {"env": "Lift"}, **demos)
    in_peace = tmp_path / "in-peace"
    subprocess.run(command(source, in_peace, 0), check=True, capture_output=True)
    target, parts = tmp_path / "killed", tmp_path / "killed.parts"
    kept: dict[Path, float] = {}
    for workers in (0, 2):
        running = subprocess.Popen(
            command(source, target, workers), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )
        deadline = time.monotonic() + 300
        while len(infos(parts)) < len(kept) + 2 and time.monotonic() < deadline:
            time.sleep(0.05)
        os.kill(running.pid, signal.SIGKILL)
        running.wait()
        assert not target.exists()
        found = infos(parts)
        assert len(kept) + 2 <= len(found) < 8
        for path, written in kept.items():
            assert found[path] == written
        kept = dict(sorted(found.items(), key=lambda item: item[1])[:-2])  # some are in hand
    done = subprocess.run(command(source, target, 2), capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert "8 demonstrations, 1200 frames, 2400 images; 0 left out" in done.stdout
    assert digests(target) == digests(in_peace)
    assert not parts.exists()


def infos(parts: Path) -> dict[Path, float]:
    """Return which episodes are written, and when."""
    return {path: path.stat().st_mtime for path in parts.glob("*/*/[0-9]*/meta/info.json")}


def test_what_cannot_be_done_is_told_and_leaves_nothing(
    recording: Path, tmp_path: Path, states: Any
) -> None:
    target = tmp_path / "set"
    text = refusal(recording, target, strict=True)
    assert text.startswith(
        "1 of 4 demonstrations cannot be used and 'strict' asks for all:\n"
        f"  2: {recording}: data/demo_3/states has rows of 31 numbers"
    )
    assert "there is no camera 'front'; there are: agentview," in refusal(
        recording, target, "front"
    )
    assert not target.exists()
    target.mkdir()
    assert refusal(recording, target) == f"{target}: is there already: choose another folder"
    target.rmdir()
    parts = tmp_path / "other.parts"
    parts.mkdir()
    assert refusal(recording, tmp_path / "other").startswith(
        f"{parts}: is there already, and no conversion made it: episodes would be kept there"
    )
    missing = tmp_path / "other.hdf5"
    assert refusal(missing, target) == f"{missing}: there is no such data set"
    door = record(tmp_path / "door.hdf5", {"env": "Door"}, demo_1=good(states))
    assert refusal(door, target) == (
        "environment 'robosuite/task': robosuite's Door has joints (Door_hinge, Door_latch_joint) "
        "of things that are fixed; what is missing are objects that lie loose (a free joint): "
        "scenes tell of those alone"
    )
    untold = record(tmp_path / "untold.hdf5", {}, demo_1=good(states))
    assert "names no recorded task: it has neither an attribute 'env'" in refusal(untold, target)


def test_a_file_of_another_format_is_no_target(recording: Path, tmp_path: Path) -> None:
    target = tmp_path / "set.hdf5"
    assert refusal(recording, target) == (
        f"{target}: found the suffix '.hdf5'; it must be a folder, for a LeRobot data set. 'prime "
        "export RUN --to robomimic' writes such files of a run's demonstrations"
    )
    assert not target.exists()


def test_wrong_options_are_told(recording: Path, tmp_path: Path) -> None:
    target = tmp_path / "set"
    assert refusal(recording, target, size="84,84") == (
        "--size 84,84: it must be a number of pixels, or HEIGHTxWIDTH such as 240x320"
    )
    assert refusal(recording, target, size="4") == (
        "images: height: found 4: input should be greater than or equal to 8\n"
        "images: width: found 4: input should be greater than or equal to 8"
    )
    assert refusal(recording, target, "wrist", "wrist") == (
        "images: found cameras ['wrist', 'wrist']: each may be named once only"
    )
    assert refusal(recording, target, "wrist", size="85", kept_as="video") == (
        "images of camera 'wrist' are 85 x 85 pixels; both must be even in videos, which halve the "
        "resolution of colour: choose another size, or PNG"
    )
    assert "unknown key 'objekt': did you mean 'object'?" in refusal(
        recording, target, environment="robosuite/pick-place", settings=["objekt=can"]
    )
    assert "--environment robosuite/lft: no environment is registered as" in refusal(
        recording, target, environment="robosuite/lft"
    )
    # The file has the last word on what it is of.
    assert "names 'Lift'; the environment takes recordings of 'PickPlaceCan'" in refusal(
        recording, target, environment="robosuite/pick-place", settings=["object=can"]
    )
    assert not target.exists()
