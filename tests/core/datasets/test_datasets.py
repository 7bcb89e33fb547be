"""LeRobot data sets: what is written comes back, LeRobot takes it, and broken ones are refused."""

import hashlib
import json
import shutil
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from prime_core.contracts.calls import Parameter, ParameterSpace, PrimitiveCall, PrimitiveSpace
from prime_core.contracts.demonstration import Demonstration, Segment
from prime_core.contracts.description import ObjectDescription, SceneDescription
from prime_core.contracts.observations import Observations
from prime_core.datasets import layout as lerobot_layout
from prime_core.datasets.demonstrator import LeRobotDemonstratorConfig
from prime_core.datasets.read import count_episodes, read_dataset, write_dataset
from prime_core.errors import DatasetError

DESCRIPTION = SceneDescription(
    objects=(ObjectDescription("milk"), ObjectDescription("bin")),
    workspace_low=(0.0, 0.0, 0.0),
    workspace_high=(1.0, 1.0, 1.0),
    lift_height=1.0,
)
SPACE = PrimitiveSpace(
    ("reach", "grasp"),
    (
        ParameterSpace((Parameter("x", "m", -1.0, 1.0),)),
        ParameterSpace(
            (Parameter("x", "m", -1.0, 1.0), Parameter("yaw", "rad", -1.5, 1.5, period=3.0))
        ),
    ),
)
LENGTHS = (30, 25, 41)
ENVIRONMENT = {"type": "robosuite/pick-place", "item": "milk"}


def demonstration(
    frames: int, seed: int = 0, task: str = "pick the milk", simulated: bool = True
) -> Demonstration:
    generator = np.random.default_rng([seed, frames])

    def numbers(width: int) -> Any:
        return generator.normal(size=(frames, width)).astype(np.float32)

    states = generator.normal(size=(frames, 20)) if simulated else None
    return Demonstration(Observations(numbers(15), numbers(16)), numbers(5), task, states)


def segments_of(frames: int) -> list[Segment]:
    return [
        Segment(0, 8, PrimitiveCall("grasp", np.array([0.25, -0.5])), -1.5),
        Segment(8, 13, PrimitiveCall("other", np.empty(0)), -0.5),
        Segment(13, frames - 1, PrimitiveCall("reach", np.array([0.75])), -2.5),
    ]


def write(folder: Path, parsed: bool = False, **changes: Any) -> list[Demonstration]:
    demonstrations = [
        demonstration(frames, seed, task=f"task {seed % 2}") for seed, frames in enumerate(LENGTHS)
    ]
    if parsed:
        changes |= {"segments": [segments_of(frames) for frames in LENGTHS], "space": SPACE}
    write_dataset(folder, demonstrations, DESCRIPTION, environment=ENVIRONMENT, **changes)
    return demonstrations


def assert_same(left: Demonstration, right: Demonstration) -> None:
    for name in ("state", "environment_state"):
        found, wanted = getattr(left.observations, name), getattr(right.observations, name)
        assert found.dtype == np.float32
        np.testing.assert_array_equal(found, wanted)
    np.testing.assert_array_equal(left.actions, right.actions)
    assert left.actions.dtype == np.float32
    assert left.task == right.task
    assert (left.simulator_states is None) == (right.simulator_states is None)
    if left.simulator_states is not None and right.simulator_states is not None:
        assert left.simulator_states.dtype == np.float64
        np.testing.assert_array_equal(left.simulator_states, right.simulator_states)


def fingerprint(folder: Path) -> dict[str, str]:
    return {
        str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }


# What is written comes back.


def test_round_trip(tmp_path: Path) -> None:
    # A folder of exca's has "=" in its name, which arrow takes for a partition if one lets it.
    folder = tmp_path / "seed=0,task=x" / "set"
    written = write(folder)
    found = read_dataset(folder, DESCRIPTION)
    for left, right in zip(found.demonstrations, written, strict=True):
        assert_same(left, right)
    assert found.episodes == (0, 1, 2)
    assert found.environment == ENVIRONMENT
    assert found.state_names == tuple(DESCRIPTION.state_names)
    assert found.environment_state_names == tuple(DESCRIPTION.environment_state_names)
    assert found.segments is None and found.space is None
    assert count_episodes(folder) == 3


def test_chosen_episodes_only(tmp_path: Path) -> None:
    written = write(tmp_path / "set", parsed=True)
    found = read_dataset(tmp_path / "set", DESCRIPTION, episodes=[2, 0])
    assert found.episodes == (2, 0)
    assert_same(found.demonstrations[0], written[2])
    assert_same(found.demonstrations[1], written[0])
    assert found.segments is not None and found.segments[0][-1].end == LENGTHS[2] - 1
    with pytest.raises(DatasetError, match="has no episode 3; it has 0 to 2"):
        read_dataset(tmp_path / "set", episodes=[3])


@pytest.mark.parametrize("motion_rows", [True, False])
def test_segments_round_trip(tmp_path: Path, motion_rows: bool) -> None:
    write(tmp_path / "set", parsed=True, motion_rows=motion_rows)
    found = read_dataset(tmp_path / "set", DESCRIPTION)
    assert found.space == SPACE
    assert found.segments is not None
    for frames, segments in zip(LENGTHS, found.segments, strict=True):
        for left, right in zip(segments, segments_of(frames), strict=True):
            assert (left.start, left.end) == (right.start, right.end)
            assert left.log_probability == right.log_probability
            assert left.call.primitive == right.call.primitive
            np.testing.assert_array_equal(left.call.parameters, right.call.parameters)


def test_labels_of_frames(tmp_path: Path) -> None:
    write(tmp_path / "set", parsed=True)
    table = pq.read_table(tmp_path / "set/data/chunk-000/file-000.parquet", partitioning=None)
    labels = table["primitive_index"].to_numpy()[: LENGTHS[0]]
    assert labels.tolist() == [1] * 8 + [2] * 5 + [0] * 17
    rows = table["language_persistent"][20].as_py()
    assert [row["style"] for row in rows] == ["motion"] * 3
    assert [row["content"] for row in rows] == [
        "grasp(x=0.250 m, yaw=-0.500 rad)",
        "other",
        "reach(x=0.750 m)",
    ]
    np.testing.assert_allclose([row["timestamp"] for row in rows], [0.0, 0.4, 0.65])


def test_without_simulator_states_objects_or_actions_done(tmp_path: Path) -> None:
    description = replace(DESCRIPTION, objects=())
    one = demonstration(1, simulated=False)
    alone = replace(
        one, observations=Observations(one.observations.state, np.zeros((1, 0), np.float32))
    )
    write_dataset(tmp_path / "set", [alone], description, segments=[[]], space=SPACE)
    found = read_dataset(tmp_path / "set", description)
    assert_same(found.demonstrations[0], alone)
    assert found.segments == ((),)


def test_many_data_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(lerobot_layout, "DATA_FILE_MEGABYTES", 0.01)
    monkeypatch.setattr(lerobot_layout, "CHUNK_SIZE", 2)
    written = write(tmp_path / "set")
    assert (tmp_path / "set/data/chunk-001/file-000.parquet").is_file()
    for left, right in zip(read_dataset(tmp_path / "set").demonstrations, written, strict=True):
        assert_same(left, right)


def test_statistics_are_those_of_all_frames(tmp_path: Path) -> None:
    written = write(tmp_path / "set")
    found = json.loads((tmp_path / "set/meta/stats.json").read_text())["action"]
    actions = np.concatenate([item.actions for item in written])
    np.testing.assert_allclose(found["mean"], actions.mean(axis=0), atol=1e-6)
    np.testing.assert_allclose(found["std"], actions.std(axis=0), atol=1e-6)
    np.testing.assert_allclose(found["min"], actions.min(axis=0))
    np.testing.assert_allclose(found["max"], actions.max(axis=0))
    assert found["count"] == [sum(LENGTHS)]
    table = pq.read_table(tmp_path / "set/meta/episodes/chunk-000/file-000.parquet")
    np.testing.assert_allclose(
        table["stats/action/q10"][0].as_py(), np.quantile(written[0].actions, 0.1, axis=0), 1e-5
    )


def test_writing_is_fast(tmp_path: Path) -> None:
    demonstrations = [demonstration(300, seed, simulated=False) for seed in range(100)]
    write(tmp_path / "warm")
    start = time.process_time()
    write_dataset(tmp_path / "set", demonstrations, DESCRIPTION)
    # 0.4 s where it was measured; LeRobot's own recorder takes 15.
    assert time.process_time() - start < 3.0


# Whole or not at all.


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

    monkeypatch.setattr("prime_core.datasets.parquet_writer._write_episodes", fail)
    with pytest.raises(DatasetError, match="no space left"):
        write(tmp_path / "set", replace=True)
    with pytest.raises(DatasetError, match="no space left"):
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
    holed = replace(good, actions=np.where(good.actions > 1, np.nan, good.actions))
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


# Broken and foreign sets.


def change_info(folder: Path, change: Callable[[dict[str, Any]], object]) -> None:
    path = folder / "meta/info.json"
    info = json.loads(path.read_text())
    change(info)
    path.write_text(json.dumps(info))


def change_data(folder: Path, change: Callable[[Any], Any]) -> None:
    path = folder / "data/chunk-000/file-000.parquet"
    pq.write_table(change(pq.read_table(path, partitioning=None)), path)


def truncate(folder: Path, name: str) -> None:
    path = folder / name
    path.write_bytes(path.read_bytes()[:-200])


def holed(table: Any) -> Any:
    values = np.array(table["action"].to_pylist(), dtype=np.float32)
    values[35, 2] = np.nan
    column = pa.FixedSizeListArray.from_arrays(pa.array(values.ravel()), 5)
    return table.set_column(table.column_names.index("action"), "action", column)


def ragged(table: Any) -> Any:
    rows = table["action"].to_pylist()
    rows[3], rows[4] = rows[3][:4], [*rows[4], 0.0]
    column = pa.array(rows, pa.list_(pa.float32()))
    return table.set_column(table.column_names.index("action"), "action", column)


DATA = "data/chunk-000/file-000.parquet"
EPISODES = "meta/episodes/chunk-000/file-000.parquet"
BREAKAGES: dict[str, tuple[Callable[[Path], object], str]] = {
    "no folder": (shutil.rmtree, r"set/meta/info.json is missing: a LeRobot v3 data set"),
    "no JSON": (lambda f: truncate(f, "meta/info.json"), r"info.json is not readable as JSON"),
    "version 2": (
        lambda f: change_info(f, lambda info: info.update(codebase_version="v2.1")),
        r"codebase_version is 'v2.1'.*convert_dataset_v21_to_v30",
    ),
    "no version": (lambda f: (f / "meta/info.json").write_text("[]"), r"codebase_version is None"),
    "no fps": (lambda f: change_info(f, lambda info: info.pop("fps")), r"fps is 'missing'"),
    "other fps": (
        lambda f: change_info(f, lambda info: info.update(fps=50)),
        r"fps is 50; motor actions here are steps of 20 a second",
    ),
    "no action": (
        lambda f: change_info(f, lambda info: info["features"].pop("action")),
        r"info.json: no feature 'action'; it should be 5 numbers.*Features: .*observation.state",
    ),
    "wide action": (
        lambda f: change_info(f, lambda info: info["features"]["action"].update(shape=[7])),
        r"'action' has 7 numbers; it should have 5 \(dx, dy, dz, dyaw, gripper\)",
    ),
    "whole numbers": (
        lambda f: change_info(f, lambda info: info["features"]["action"].update(dtype="int64")),
        r"'action' is int64 of shape \[5\]; it should be 5 numbers",
    ),
    "strange path": (
        lambda f: change_info(f, lambda info: info.update(data_path="data/{episode}")),
        r"data_path is 'data/\{episode\}'; LeRobot has 'data/chunk-",
    ),
    "other objects": (
        lambda f: change_info(
            f,
            lambda info: info["features"]["observation.environment_state"]["names"].__setitem__(
                0, "cereal.x"
            ),
        ),
        r"has 'cereal.x' where this environment has 'milk.x'",
    ),
    "other width": (
        lambda f: change_info(
            f, lambda info: info["features"]["observation.state"].update(shape=[14], names=None)
        ),
        r"'observation.state' has 14 numbers; this environment has 15: gripper.x",
    ),
    "no objects": (
        lambda f: change_info(
            f, lambda info: info["features"].pop("observation.environment_state")
        ),
        r"'observation.environment_state' is missing; this environment has 16: milk.x",
    ),
    "no episodes": (
        lambda f: shutil.rmtree(f / "meta/episodes"),
        r"meta/episodes has no file chunk-000/file-000.parquet",
    ),
    "truncated episodes": (
        lambda f: truncate(f, EPISODES),
        r"episodes/chunk-000/file-000.parquet: the file is broken or was never finished",
    ),
    "too few episodes": (
        lambda f: change_info(f, lambda info: info.update(total_episodes=7)),
        r"lists 3 episodes and .*info.json says total_episodes 7",
    ),
    "no data": (lambda f: (f / DATA).unlink(), r"data/chunk-000/file-000.parquet is missing"),
    "truncated data": (
        lambda f: truncate(f, DATA),
        r"data/chunk-000/file-000.parquet: the file is broken or was never finished",
    ),
    "empty data": (lambda f: (f / DATA).write_bytes(b""), r"the file is broken"),
    "no column": (
        lambda f: change_data(f, lambda table: table.drop_columns("action")),
        r"file-000.parquet has no column 'action'; it has observation.state",
    ),
    "fewer frames": (
        lambda f: change_data(f, lambda table: table.slice(0, 50)),
        r"episode 1 has 20 frames; it should have the frames 0 to 24",
    ),
    "shuffled frames": (
        lambda f: change_data(f, lambda table: table.take(list(range(95, -1, -1)))),
        r"it should have the frames 0 to 29 in order",
    ),
    "NaN": (
        lambda f: change_data(f, holed),
        r"'action' holds NaN or infinity in episode 1, frame 5",
    ),
    "ragged": (lambda f: change_data(f, ragged), r"'action' has 4 numbers in row 3"),
    "no segments": (
        lambda f: (f / "meta/primitives.parquet").unlink(),
        r"primitives.parquet is missing",
    ),
    "newer release": (
        lambda f: (f / "meta/prime.json").write_text('{"version": 9}'),
        r"prime.json: version is 9; this release reads version 1",
    ),
    "strange primitives": (
        lambda f: (f / "meta/prime.json").write_text('{"version": 1, "primitives": [{}]}'),
        r"prime.json: primitives is not a list of names with their parameters",
    ),
}


@pytest.mark.parametrize("breakage", BREAKAGES)
def test_a_broken_set_is_refused_and_left_as_it_is(tmp_path: Path, breakage: str) -> None:
    break_it, text = BREAKAGES[breakage]
    write(tmp_path / "set", parsed=True)
    break_it(tmp_path / "set")
    before = fingerprint(tmp_path / "set")
    with pytest.raises(DatasetError, match=text) as caught:
        read_dataset(tmp_path / "set", DESCRIPTION)
    assert str(tmp_path / "set") in str(caught.value)
    assert fingerprint(tmp_path / "set") == before


def test_a_set_from_elsewhere_is_read(tmp_path: Path) -> None:
    written = write(tmp_path / "set")
    (tmp_path / "set/meta/prime.json").unlink()

    def foreign(info: dict[str, Any]) -> None:
        info["features"].pop("simulator_state")
        info["features"]["observation.state"]["names"] = {"motors": ["a", "b"]}
        info["features"]["observation.environment_state"]["names"] = ["q"] * 16
        info["features"]["action"]["dtype"] = "float64"

    change_info(tmp_path / "set", foreign)

    def doubles(table: Any) -> Any:
        column = pa.array(table["action"].to_pylist(), pa.list_(pa.float64()))
        index = table.column_names.index("action")
        return table.drop_columns("simulator_state").set_column(index, "action", column)

    change_data(tmp_path / "set", doubles)
    found = read_dataset(tmp_path / "set", DESCRIPTION)
    assert found.environment is None and found.state_names is None
    for left, right in zip(found.demonstrations, written, strict=True):
        assert_same(left, replace(right, simulator_states=None))


def test_the_demonstrator(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    written = write(tmp_path / "set")
    monkeypatch.setattr(
        "prime_core.datasets.demonstrator._description_of", lambda environment: DESCRIPTION
    )
    environment: Any = None
    everything = LeRobotDemonstratorConfig(path=tmp_path / "set")
    assert everything.count_available() == 3
    assert_same(everything.demonstrate(environment, 1, seed=5), written[1])
    some = LeRobotDemonstratorConfig(path=tmp_path / "set", episodes=(2,))
    assert some.count_available() == 1
    assert_same(some.demonstrate(environment, 0, seed=5), written[2])
    with pytest.raises(DatasetError, match="gives 1 demonstrations, not 2"):
        some.demonstrate(environment, 1, seed=5)


# LeRobot itself.


@pytest.fixture
def lerobot(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
    """LeRobot's data set class, its caches in the test's folder, the hub out of reach."""
    lerobot_dataset = pytest.importorskip("lerobot.datasets.lerobot_dataset")
    dataset_metadata = pytest.importorskip("lerobot.datasets.dataset_metadata")
    config = pytest.importorskip("datasets.config")

    def call_hub(*_: object, **__: object) -> None:
        raise AssertionError("LeRobot asked the hub: it found the data set incomplete")

    for module in (lerobot_dataset, dataset_metadata):
        monkeypatch.setattr(module, "get_safe_version", call_hub)
        monkeypatch.setattr(module, "snapshot_download", call_hub)
    monkeypatch.setattr(config, "HF_DATASETS_CACHE", tmp_path / "cache")
    return lerobot_dataset.LeRobotDataset


def record(recorder: Any, item: Demonstration, **more: Any) -> None:
    """Record an episode as LeRobot's users do."""
    for step in range(len(item.observations)):
        frame = {
            "observation.state": item.observations.state[step],
            "observation.environment_state": item.observations.environment_state[step],
            "action": item.actions[step],
            "task": item.task,
        }
        if item.simulator_states is not None:
            frame["simulator_state"] = item.simulator_states[step]
        recorder.add_frame(frame | more)
    recorder.save_episode()
    recorder.finalize()


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
def test_the_files_are_those_of_lerobots_recorder(tmp_path: Path, lerobot: Any) -> None:
    """The same episode, written by us and by LeRobot, gives the same columns and types."""
    item = demonstration(20)
    write_dataset(tmp_path / "ours", [item], DESCRIPTION)
    features = json.loads((tmp_path / "ours/meta/info.json").read_text())["features"]
    for key in lerobot_layout.BOOKKEEPING:
        features.pop(key)
    for feature in features.values():
        feature["shape"] = tuple(feature["shape"])
    root = tmp_path / "theirs"
    options = {"root": root, "use_videos": False, "robot_type": "panda"}
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
            if not name.startswith("q"):
                np.testing.assert_allclose(ours[key][name], values, atol=1e-5, err_msg=f"{key}")
