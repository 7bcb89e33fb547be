"""Segments written into data sets that are there: whole or not at all, and nothing else changed."""

import json
import os
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from prime_core.contracts.calls import PrimitiveCall
from prime_core.contracts.demonstration import Segment
from prime_core.datasets.annotation.annotate import Annotation
from prime_core.datasets.files.header import read_header
from prime_core.datasets.read import read_dataset
from prime_core.datasets.segments import frame_labels
from prime_core.datasets.write import write_dataset
from prime_core.errors import DatasetError

from .edits import edit_column, edit_info
from .samples import (
    DATA,
    DESCRIPTION,
    ENVIRONMENT,
    EPISODES,
    LENGTHS,
    SPACE,
    demonstration,
    fingerprint,
    pictured,
    write,
)

OWN = {"primitive_index", "language_persistent"}
WRITTEN = {
    DATA,
    EPISODES,
    "meta/info.json",
    "meta/stats.json",
    "meta/prime.json",
    "meta/primitives.parquet",
}


def pieces(frames: int, x: float = 0.5) -> tuple[Segment, ...]:
    return (
        Segment(0, 10, PrimitiveCall("reach", np.array([x])), -0.25, 0.75),
        Segment(10, frames - 1, PrimitiveCall("grasp", np.array([x, 1.0])), -0.5, 0.5),
    )


def annotate(source: Path, target: Path, x: float = 0.5) -> list[tuple[Segment, ...]]:
    """Annotate all episodes but the last, which was left out."""
    segments = [*(pieces(frames, x) for frames in LENGTHS[:-1]), ()]
    Annotation(read_header(source, None), target).write(segments, SPACE, None)
    return segments


def rows_of(folder: Path) -> list[list[dict[str, Any]]]:
    """Return the language rows of each frame."""
    found: list[list[dict[str, Any]]] = pq.read_table(folder / DATA)[
        "language_persistent"
    ].to_pylist()
    return found


@pytest.mark.parametrize("in_place", [False, True])
@pytest.mark.parametrize("parsed", [False, True])
def test_segments_are_written_and_all_else_is_the_same(
    tmp_path: Path, in_place: bool, parsed: bool
) -> None:
    source, whole = tmp_path / "set", tmp_path / "whole"
    shown = [pictured(demonstration(frames), seed) for seed, frames in enumerate(LENGTHS)]
    changes: dict[str, Any] = {"segments": [pieces(n, 0.1) for n in LENGTHS], "space": SPACE}
    write_dataset(
        source, shown, DESCRIPTION, environment=ENVIRONMENT, **(changes if parsed else {})
    )
    (source / "README.md").write_text("a data set card")
    (source / "videos").mkdir()
    (source / "videos" / "clip.mp4").write_bytes(os.urandom(1000))
    shutil.copytree(source, whole)
    target = source if in_place else tmp_path / "out"
    segments = annotate(source, target)

    before, after = fingerprint(whole), fingerprint(target)
    changed = {name for name in after if before.get(name) != after[name]}
    # Features and primitives of a parsed data set are known already.
    assert changed == WRITTEN - ({"meta/info.json", "meta/prime.json"} if parsed else set())
    assert set(before) <= set(after)
    assert in_place or fingerprint(source) == before
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted({"set", "whole", target.name})
    old, new = pq.read_table(whole / DATA), pq.read_table(target / DATA)
    assert {*new.column_names} == {*old.column_names} | OWN
    for name in {*old.column_names} - OWN:
        assert new[name].equals(old[name]) and new.schema.field(name).equals(old.schema.field(name))
    groups = [pq.ParquetFile(path / DATA).num_row_groups for path in (whole, target)]
    assert groups == [len(LENGTHS)] * 2

    found = read_dataset(target, DESCRIPTION)
    assert found.environment == ENVIRONMENT
    assert found.space == SPACE
    assert found.segments is not None
    for wanted, items in zip(segments, found.segments, strict=True):
        assert [(s.start, s.end, s.log_probability, s.confidence) for s in items] == [
            (s.start, s.end, s.log_probability, s.confidence) for s in wanted
        ]
    labels = [frame_labels(items, n, SPACE) for items, n in zip(segments, LENGTHS, strict=True)]
    assert new["primitive_index"].to_pylist() == np.concatenate(labels).tolist()


def test_the_metadata_tells_of_the_labels_and_of_nothing_else_that_is_new(tmp_path: Path) -> None:
    write(tmp_path / "set")
    annotate(tmp_path / "set", tmp_path / "out")
    old, new = (
        {
            "info": json.loads((folder / "meta" / "info.json").read_text()),
            "stats": json.loads((folder / "meta" / "stats.json").read_text()),
            "episodes": pq.read_table(folder / EPISODES).to_pydict(),
        }
        for folder in (tmp_path / "set", tmp_path / "out")
    )
    features = new["info"]["features"]
    assert features.pop("primitive_index") == {"dtype": "int64", "shape": [1], "names": None}
    assert features.pop("language_persistent")["dtype"] == "language"
    stats = new["stats"].pop("primitive_index")
    assert (stats["min"], stats["max"], stats["count"]) == ([0], [2], [sum(LENGTHS)])
    added = {key: new["episodes"].pop(key) for key in [*new["episodes"]] if "primitive_i" in key}
    assert added["stats/primitive_index/min"] == [[0], [0], [2]]
    assert added["stats/primitive_index/max"] == [[1], [1], [2]]
    assert new == old


def test_rows_stand_at_every_frame_with_its_own_clock(tmp_path: Path) -> None:
    write(tmp_path / "set")
    late = 100.0 + np.arange(sum(LENGTHS)) / 20
    edit_column(
        tmp_path / "set", DATA, "timestamp", lambda column: pa.array(late.astype(np.float32))
    )
    annotate(tmp_path / "set", tmp_path / "out")
    found = rows_of(tmp_path / "out")
    assert all(rows == found[0] for rows in found[: LENGTHS[0]])
    assert [row["timestamp"] for row in found[0]] == [100.0, 100.5]
    assert found[0][1] == {
        "role": "assistant",
        "content": "grasp(x=0.500 m, yaw=1.000 rad)",
        "style": "motion",
        "timestamp": 100.5,
        "camera": None,
        "tool_calls": None,
    }
    assert found[-1] == []  # of the episode that was left out


def test_annotating_twice_replaces_the_first_and_keeps_the_rows_of_others(tmp_path: Path) -> None:
    source = tmp_path / "set"
    write(source)
    call = {"type": "function", "function": {"name": "say", "arguments": {"text": "yes"}}}
    others = [
        {
            "role": role,
            "content": text,
            "style": style,
            "timestamp": time,
            "camera": None,
            "tool_calls": calls,
        }
        for role, text, style, time, calls in (
            ("user", "tidy up", "task_aug", 0.0, None),
            ("assistant", "go to the milk", "subtask", 0.0, None),
            ("assistant", "an older primitive", "motion", 0.1, None),
            ("assistant", None, "subtask", 0.7, [call]),
        )
    ]
    table = pq.read_table(source / DATA)
    column = pa.array([others] * LENGTHS[0] + [None] * sum(LENGTHS[1:]))
    pq.write_table(table.append_column("language_persistent", column), source / DATA)
    edit_info(
        source,
        lambda info: info["features"].update(
            language_persistent={"dtype": "language", "shape": [1], "names": None}
        ),
    )
    for x in (0.25, 0.5):
        annotate(source, source, x)
        found = rows_of(source)
        texts = [(row["style"], row["content"]) for row in found[3]]
        assert texts == [
            ("task_aug", "tidy up"),
            ("subtask", "go to the milk"),
            ("motion", f"reach(x={x:.3f} m)"),
            ("motion", f"grasp(x={x:.3f} m, yaw=1.000 rad)"),
            ("subtask", None),
        ]
        assert found[3][-1]["tool_calls"] == [call]
        assert [row["style"] for row in found[LENGTHS[0]]] == ["motion", "motion"]
        assert found[-1] == []
    assert pq.read_schema(source / DATA).field("language_persistent").type == column.type
    assert len(pq.read_table(source / "meta" / "primitives.parquet")) == 4


def test_where_nothing_can_be_written(tmp_path: Path) -> None:
    source = tmp_path / "set"
    write(source)
    before = fingerprint(tmp_path)
    header = read_header(source, None)
    for target, text in (
        (tmp_path, "is there already: choose another folder with --out"),
        (source / "data" / "out", "lies in the data set that is copied: choose a folder beside it"),
    ):
        with pytest.raises(DatasetError) as caught:
            Annotation(header, target)
        assert str(caught.value).startswith(f"{target}: {text}")
    annotation = Annotation(header, source)
    (source / "data" / "chunk-000" / "file-001.parquet").write_bytes(b"of a recorder")
    with pytest.raises(DatasetError, match="something else has changed the data set while it was"):
        annotation.write([(), (), ()], SPACE, None)
    (source / "data" / "chunk-000" / "file-001.parquet").unlink()
    assert fingerprint(tmp_path) == before


def test_a_file_that_is_broken_or_not_of_the_set_leaves_all_as_it_was(tmp_path: Path) -> None:
    for change, text in (
        (
            lambda path: path.write_bytes(path.read_bytes()[:-100]),
            "is broken or was never finished",
        ),
        (
            lambda path: pq.write_table(pq.read_table(path).slice(3), path),
            "the frames of episode 0 are not those that meta/episodes lists",
        ),
        (
            lambda path: pq.write_table(
                pq.read_table(path).append_column(
                    "language_persistent", pa.array(["x"] * sum(LENGTHS))
                ),
                path,
            ),
            "column 'language_persistent' is string; it should be LeRobot's language rows",
        ),
    ):
        source = tmp_path / text.split()[0]
        write(source)
        change(source / DATA)
        before = fingerprint(source)
        with pytest.raises(DatasetError, match=text):
            annotate(source, source)
        assert fingerprint(source) == before
        assert not [*tmp_path.glob(".*")]


def test_links_stay_links_in_place_and_are_followed_in_copies(tmp_path: Path) -> None:
    source, store = tmp_path / "set", tmp_path / "store"
    write(source)
    store.mkdir()
    (source / "README.md").write_text("card")
    for name in (DATA, "README.md"):
        (source / name).rename(store / Path(name).name)
        (source / name).symlink_to(store / Path(name).name)
    whole = fingerprint(store)
    annotate(source, tmp_path / "out")
    assert not any(path.is_symlink() for path in (tmp_path / "out").rglob("*"))
    (tmp_path / "link").symlink_to(source)
    annotate(tmp_path / "link", tmp_path / "link")
    assert (source / "README.md").is_symlink() and not (source / DATA).is_symlink()
    assert (tmp_path / "link").is_symlink()
    assert read_dataset(tmp_path / "link").space == SPACE
    assert fingerprint(store) == whole
    shutil.move(source / "data", tmp_path / "elsewhere")
    (source / "data").symlink_to(tmp_path / "elsewhere")
    with pytest.raises(DatasetError, match=r"is a link to .*elsewhere.*write a copy with --out"):
        Annotation(read_header(source, None), source)
