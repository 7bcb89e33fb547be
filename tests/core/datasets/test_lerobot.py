"""LeRobot itself opens, resumes and shows the data sets, and writes the same files."""

import io
import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet as pq
import pytest
from PIL import Image

from prime_core.contracts.description import RobotDescription
from prime_core.datasets.files import layout as lerobot_layout
from prime_core.datasets.read import read_dataset, write_dataset

from .samples import (
    DATA,
    DESCRIPTION,
    ENVIRONMENT,
    EPISODES,
    LENGTHS,
    assert_same,
    demonstration,
    pictured,
    record,
    write,
)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize(("parsed", "motion_rows"), [(False, False), (True, False), (True, True)])
def test_lerobot_opens_and_resumes(
    tmp_path: Path, lerobot: Any, parsed: bool, motion_rows: bool
) -> None:
    root = tmp_path / "set"
    written = write(root, parsed=parsed, motion_rows=motion_rows)
    opened = lerobot("local/set", root=root)
    assert (opened.num_episodes, len(opened)) == (3, sum(LENGTHS))
    item = opened[LENGTHS[0] + 7]
    np.testing.assert_array_equal(item["observation.state"], written[1].observations.state[7])
    np.testing.assert_array_equal(item["action"], written[1].actions[7])
    assert item["task"] == "task 1"
    assert set(opened.meta.stats["action"]) >= {"mean", "std", "min", "max", "q01", "q99"}
    window = lerobot("local/set", root=root, episodes=[2], delta_timestamps={"action": [0, 0.05]})
    np.testing.assert_array_equal(window[3]["action"], written[2].actions[3:5])

    more: dict[str, Any] = {"primitive_index": np.array([2])} if parsed else {}
    if motion_rows:
        more["language_persistent"] = None
    added = demonstration(9, seed=7, task="task new")
    record(lerobot.resume("local/set", root=root), added, **more)
    opened = lerobot("local/set", root=root)
    assert opened.num_episodes == 4
    assert opened[len(opened) - 1]["task"] == "task new"
    found = read_dataset(root, DESCRIPTION)
    for left, right in zip(found.demonstrations, [*written, added], strict=True):
        assert_same(left, right)
    assert found.environment == ENVIRONMENT
    lengths = None if found.segments is None else [len(items) for items in found.segments]
    assert lengths == ([3, 3, 3, 0] if parsed else None)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")
def test_lerobot_shows_the_segments(tmp_path: Path, lerobot: Any) -> None:
    torch = pytest.importorskip("torch")
    language = pytest.importorskip("lerobot.datasets.language_render")
    collate = pytest.importorskip("lerobot.utils.collate")
    write(tmp_path / "set", parsed=True)
    opened = lerobot("local/set", root=tmp_path / "set")
    item = opened[LENGTHS[0] + 10]
    row = language.active_at(
        float(item["timestamp"]), persistent=item["language_persistent"], style="motion"
    )
    assert row["content"] == "other"
    loader = torch.utils.data.DataLoader(
        opened, batch_size=8, collate_fn=collate.lerobot_collate_fn
    )
    batch = next(iter(loader))
    assert batch["action"].shape == (8, 5) and batch["primitive_index"].shape == (8,)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")
def test_a_set_of_lerobots_recorder_is_read(tmp_path: Path, lerobot: Any) -> None:
    written = [demonstration(12, seed, f"task {seed}", simulated=False) for seed in range(3)]
    features = {
        "observation.state": {"dtype": "float32", "shape": (15,), "names": None},
        "observation.environment_state": {"dtype": "float32", "shape": (16,), "names": None},
        "action": {"dtype": "float32", "shape": (5,), "names": None},
    }
    root = tmp_path / "set"
    record(lerobot.create("local/set", 20, features, root=root, use_videos=False), written[0])
    for item in written[1:]:
        record(lerobot.resume("local/set", root=root), item)
    assert (root / "data/chunk-000/file-002.parquet").is_file()
    for left, right in zip(read_dataset(root, DESCRIPTION).demonstrations, written, strict=True):
        assert_same(left, right)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("images", ["none", "png", "video"])
def test_the_files_are_those_of_lerobots_recorder(
    tmp_path: Path, lerobot: Any, images: str
) -> None:
    """The same episode, written by us and by LeRobot, gives the same columns and types."""
    item = demonstration(20) if images == "none" else pictured(demonstration(20))
    videos = images == "video"
    if videos:  # LeRobot's encoder crashes at pictures of 8 x 8
        seen = item.observations
        large = {name: each.repeat(8, 1).repeat(8, 2) for name, each in seen.images.items()}
        item = replace(item, observations=replace(seen, images=large))
    robot = RobotDescription(mjcf="", joint_names=(), end_effector="", name="panda")
    write_dataset(tmp_path / "ours", [item], replace(DESCRIPTION, robot=robot), videos=videos)
    features = json.loads((tmp_path / "ours/meta/info.json").read_text())["features"]
    for key in lerobot_layout.BOOKKEEPING:
        features.pop(key)
    for feature in features.values():
        feature["shape"] = tuple(feature["shape"])
        feature.pop("info", None)
    root = tmp_path / "theirs"
    options = {"root": root, "use_videos": videos, "robot_type": "panda"}
    record(lerobot.create("local/set", 20, features, **options), item)
    for name in (DATA, EPISODES, "meta/tasks.parquet"):
        ours, theirs = pq.read_schema(tmp_path / "ours" / name), pq.read_schema(root / name)
        assert ours.equals(theirs), name
    infos = [
        json.loads((tmp_path / side / "meta/info.json").read_text()) for side in ("ours", "theirs")
    ]
    assert infos[0] == infos[1]
    ours, theirs = (
        json.loads((tmp_path / side / "meta/stats.json").read_text()) for side in ("ours", "theirs")
    )
    assert ours.keys() == theirs.keys()
    for key, statistics in theirs.items():
        for name, values in statistics.items():
            # LeRobot reads quantiles off a histogram, which is coarse on twenty frames.
            if "images" in key or not name.startswith("q"):
                near = 1e-5 if "images" not in key else 1 / 255 if name.startswith("q") else 1e-4
                np.testing.assert_allclose(ours[key][name], values, atol=near, err_msg=f"{key}")
    columns = [name for name in features if "images" in name and not videos]
    tables = [pq.read_table(tmp_path / side / DATA, columns=columns) for side in ("ours", "theirs")]
    for name in columns:
        for one, other in zip(*(table[name].to_pylist() for table in tables), strict=True):
            assert one["path"] == other["path"]
            pixels = [np.asarray(Image.open(io.BytesIO(each["bytes"]))) for each in (one, other)]
            np.testing.assert_array_equal(*pixels)
