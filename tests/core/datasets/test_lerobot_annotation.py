"""LeRobot's own classes open, show and resume what was annotated, also what they recorded."""

from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet as pq
import pytest

from prime_core.datasets.annotation.annotate import Annotation
from prime_core.datasets.columns.settings import ColumnsConfig
from prime_core.datasets.files.header import read_header, read_mapped_header
from prime_core.datasets.read import read_dataset, read_demonstrations

from .samples import DATA, DESCRIPTION, LENGTHS, SPACE, demonstration, fingerprint, pictured, write
from .test_annotation import OWN, pieces

pytestmark = [pytest.mark.slow, pytest.mark.filterwarnings("ignore")]

FPS = 30
POSE = ["x", "y", "z", "qw", "qx", "qy", "qz", "opening"]
FEATURES: dict[str, Any] = {
    "observation.state.gripper": {"dtype": "float32", "shape": (8,), "names": POSE},
    "observation.state.joints": {"dtype": "float32", "shape": (7,), "names": None},
    "objects": {"dtype": "float32", "shape": (16,), "names": None},
    "action": {"dtype": "float32", "shape": (7,), "names": {"motors": list("abcdefg")}},
    "observation.images.top": {
        "dtype": "video",
        "shape": (64, 64, 3),
        "names": ["height", "width", "channels"],
    },
    "observation.images.wrist": {
        "dtype": "image",
        "shape": (8, 8, 3),
        "names": ["height", "width", "channels"],
    },
}
MAPPING = ColumnsConfig.model_validate(
    {
        "gripper": {
            "position": {"feature": "observation.state.gripper", "columns": ["x", "y", "z"]},
            "orientation": {
                "feature": "observation.state.gripper",
                "columns": ["qw", "qx", "qy", "qz"],
                "format": "wxyz",
            },
            "opening": {"feature": "observation.state.gripper", "columns": ["opening"]},
        },
        "joints": {"feature": "observation.state.joints"},
        "objects": {
            name: {
                "position": {"feature": "objects", "columns": list(range(first, first + 3))},
                "orientation": {
                    "feature": "objects",
                    "columns": list(range(first + 3, first + 7)),
                    "format": "wxyz",
                },
            }
            for first, name in ((0, "milk"), (8, "bin"))
        },
    }
)


def recorded(lerobot: Any, root: Path) -> None:
    """Record two episodes with features of other names, a video and embedded images."""
    recorder = lerobot.create("local/set", FPS, FEATURES, root=root, use_videos=True)
    for number, frames in enumerate(LENGTHS[:2]):
        item = pictured(demonstration(frames, seed=number))
        seen = item.observations
        assert seen.environment_state is not None
        for step in range(frames):
            recorder.add_frame(
                {
                    "observation.state.gripper": seen.state[step, :8],
                    "observation.state.joints": seen.state[step, 8:],
                    "objects": seen.environment_state[step],
                    "action": np.full(7, step, dtype=np.float32),
                    "observation.images.top": np.full((64, 64, 3), 8 * step % 256, dtype=np.uint8),
                    "observation.images.wrist": seen.images["wrist"][step],
                    "task": f"task {number}",
                }
            )
        recorder.save_episode()
    recorder.finalize()


@pytest.mark.parametrize("in_place", [False, True])
def test_lerobot_shows_what_it_recorded_with_segments(
    tmp_path: Path, lerobot: Any, in_place: bool
) -> None:
    render = pytest.importorskip("lerobot.datasets.language_render")
    recipes = pytest.importorskip("lerobot.configs.recipe")
    source, target = tmp_path / "set", tmp_path / ("set" if in_place else "out")
    recorded(lerobot, source)
    before, table = fingerprint(source), pq.read_table(source / DATA)
    items = [lerobot("local/set", root=source)[row] for row in (0, 20, LENGTHS[0] + 12)]

    header = read_mapped_header(source, None, MAPPING)
    (found, *_) = read_demonstrations(source, DESCRIPTION, columns=MAPPING, fps=None)
    np.testing.assert_array_equal(
        found.observations.state, demonstration(LENGTHS[0], seed=0).observations.state
    )
    segments = [pieces(LENGTHS[0]), pieces(LENGTHS[1])]
    Annotation(header, target).write(segments, SPACE, MAPPING)

    after = fingerprint(target)
    kept = {name for name in before if name.endswith((".mp4", "tasks.parquet"))}
    assert len(kept) == 2 and all(after[name] == before[name] for name in kept)
    new = pq.read_table(target / DATA)
    assert {*new.column_names} - {*table.column_names} == OWN
    assert all(new[name].equals(table[name]) for name in table.column_names)

    opened = lerobot("local/set", root=target)
    assert opened.meta.has_language_columns
    assert opened.meta.stats["primitive_index"]["count"] == [sum(LENGTHS[:2])]
    for row, wanted in zip((0, 20, LENGTHS[0] + 12), items, strict=True):
        item = opened[row]
        for key, value in wanted.items():
            assert np.array_equal(np.asarray(item[key]), np.asarray(value)), key
        rows, now = item["language_persistent"], float(item["timestamp"])
        row_now = render.active_at(now, persistent=rows, style="motion")
        is_first = int(item["frame_index"]) < 10
        assert row_now["content"] == (
            "reach(x=0.500 m)" if is_first else "grasp(x=0.500 m, yaw=1.000 rad)"
        )
        assert int(item["primitive_index"]) == (0 if is_first else 1)
    recipe = recipes.TrainingRecipe(
        bindings={"doing": "active_at(t, style=motion)"},
        messages=[
            recipes.MessageTurn(role="user", content="${task}", stream="high_level"),
            recipes.MessageTurn(
                role="assistant", content="${doing}", stream="high_level", target=True
            ),
        ],
    )
    said = render.render_sample(
        recipe=recipe, persistent=rows, events=[], t=0.0, sample_idx=0, task="task 1"
    )
    assert [turn["content"] for turn in said["messages"]] == ["task 1", "reach(x=0.500 m)"]


def test_lerobot_goes_on_recording_what_was_annotated(tmp_path: Path, lerobot: Any) -> None:
    root = tmp_path / "set"
    write(root)
    Annotation(read_header(root, None), root).write([pieces(n) for n in LENGTHS], SPACE, None)
    recorder = lerobot.resume("local/set", root=root)
    added = demonstration(9, seed=7)
    for step in range(9):
        recorder.add_frame(
            {
                "observation.state": added.observations.state[step],
                "observation.environment_state": added.observations.environment_state[step],
                "action": added.actions[step],
                "simulator_state": added.simulator_states[step],
                "primitive_index": np.array([2]),
                "language_persistent": None,
                "task": added.task,
            }
        )
    recorder.save_episode()
    recorder.finalize()
    more = [*(pieces(n, 0.25) for n in LENGTHS), ()]
    Annotation(read_header(root, None), root).write(more, SPACE, None)
    opened = lerobot("local/set", root=root)
    assert opened.num_episodes == 4
    assert opened[len(opened) - 1]["language_persistent"] == []
    assert opened[0]["language_persistent"][0]["content"] == "reach(x=0.250 m)"
    segments = read_dataset(root, DESCRIPTION).segments
    assert segments is not None and [len(items) for items in segments] == [2, 2, 2, 0]
