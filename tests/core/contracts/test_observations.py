"""Observations: what is lazy, what models are given, and what can be joined."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from prime_core.checks.samples import sample_observations
from prime_core.contracts.observations import Modality, Observations
from prime_core.rotations import gripper_down

COUNT = 6


def with_images(images: Any) -> Observations:
    seen = sample_observations(np.random.default_rng(0), COUNT)
    return Observations(seen.state, seen.environment_state, {"front": images})


@pytest.fixture
def pictures() -> Any:
    return np.random.default_rng(1).integers(0, 255, (COUNT, 4, 5, 3)).astype(np.uint8)


@pytest.fixture
def file(tmp_path: Path, pictures: Any) -> Path:
    path = tmp_path / "front.npy"
    np.save(path, pictures)
    return path


class Untouchable:
    """Images that fail the test when they are read, but for slices, which stay images."""

    def __init__(self, shape: tuple[int, ...]) -> None:
        self.shape = shape

    def __getitem__(self, rows: Any) -> "Untouchable":
        assert isinstance(rows, slice), f"images were read at {rows}"
        return Untouchable((len(range(*rows.indices(self.shape[0]))), *self.shape[1:]))

    def __array__(self, *_: Any, **__: Any) -> Any:
        raise AssertionError("images were read")


def test_a_slice_of_a_memory_map_stays_one(file: Path, pictures: Any) -> None:
    seen = with_images(np.load(file, mmap_mode="r"))
    part = seen[2:5][1:]
    assert isinstance(part.images["front"], np.memmap)
    assert np.shares_memory(part.images["front"], seen.images["front"])
    np.testing.assert_array_equal(part.images["front"], pictures[3:5])
    np.testing.assert_array_equal(part.state, seen.state[3:5])
    assert part.environment_state is not None and seen.environment_state is not None
    np.testing.assert_array_equal(part.environment_state, seen.environment_state[3:5])


def test_rows_are_read_and_no_others(file: Path, pictures: Any) -> None:
    part = with_images(np.load(file, mmap_mode="r"))[np.array([4, 0, 4])]
    np.testing.assert_array_equal(part.images["front"], pictures[[4, 0, 4]])
    assert len(part) == 3


def test_nothing_is_read_before_it_is_indexed() -> None:
    seen = with_images(Untouchable((COUNT, 4, 5, 3)))
    part = seen.only(["proprioception", "objects", "images"])[1:4]
    assert (len(part), part.images["front"].shape) == (3, (3, 4, 5, 3))
    blind = seen.only(["proprioception"])[np.array([0, 2])]
    assert (len(blind), dict(blind.images)) == (2, {})


@pytest.mark.parametrize(
    ("sees", "objects", "images"),
    [
        (("proprioception",), False, False),
        (("proprioception", "objects"), True, False),
        (("proprioception", "images"), False, True),
        (("proprioception", "objects", "images"), True, True),
    ],
)
def test_a_model_is_given_what_it_sees_and_nothing_else(
    pictures: Any, sees: tuple[Modality, ...], objects: bool, images: bool
) -> None:
    seen = with_images(pictures)
    given = seen.only(sees)
    np.testing.assert_array_equal(given.state, seen.state)
    assert (given.environment_state is not None) == objects
    assert set(given.images) == ({"front"} if images else set())
    if not objects:
        for name in ("object_positions", "object_quaternions", "held"):
            with pytest.raises(ValueError, match="object poses are not known"):
                getattr(given, name)


@pytest.mark.parametrize(
    ("sees", "text"),
    [
        ("objects", "the model sees objects, but object poses are not known here"),
        ("images", "the model sees images, but there are none here"),
    ],
)
def test_what_a_model_sees_must_be_there(sees: Modality, text: str) -> None:
    blind = Observations(np.zeros((2, 15), np.float32))
    with pytest.raises(ValueError, match=text):
        blind.only(["proprioception", sees])


def test_observations_are_joined_in_order(file: Path, pictures: Any) -> None:
    seen = with_images(np.load(file, mmap_mode="r"))
    joined = Observations.join([seen[4:], seen[:1]])
    np.testing.assert_array_equal(joined.state, seen.state[[4, 5, 0]])
    assert joined.environment_state is not None and seen.environment_state is not None
    np.testing.assert_array_equal(joined.environment_state, seen.environment_state[[4, 5, 0]])
    np.testing.assert_array_equal(joined.images["front"], pictures[[4, 5, 0]])
    blind = Observations.join([seen.only(["proprioception"])] * 2)
    assert (len(blind), blind.environment_state, dict(blind.images)) == (2 * COUNT, None, {})


@pytest.mark.parametrize("sees", [("proprioception",), ("objects",), ("images",)])
def test_what_sees_other_things_is_not_joined(pictures: Any, sees: tuple[Modality, ...]) -> None:
    seen = with_images(pictures)
    for parts in ([seen, seen.only(sees)], [seen.only(sees), seen]):
        with pytest.raises(ValueError, match="joined must see the same"):
            Observations.join(parts)


def test_nothing_is_not_joined() -> None:
    with pytest.raises(ValueError, match="no observations to join"):
        Observations.join([])


def test_one_live_observation_is_one_row(pictures: Any) -> None:
    seen = with_images(pictures)
    assert seen.environment_state is not None
    live = Observations.single(
        {
            "observation.state": seen.state[3].astype(np.float64),
            "observation.environment_state": seen.environment_state[3],
            "observation.images.front": pictures[3],
        }
    )
    assert len(live) == 1
    assert live.state.dtype == np.float32
    np.testing.assert_array_equal(live.state, seen.state[3:4])
    np.testing.assert_array_equal(live.held, seen.held[3:4])
    np.testing.assert_array_equal(live.images["front"], pictures[3:4])
    alone = Observations.single({"observation.state": seen.state[3]})
    assert (alone.environment_state, dict(alone.images)) == (None, {})


def test_names_are_those_of_the_numbers() -> None:
    state = np.zeros((2, 10), np.float32)
    state[:, :3], state[:, 7], state[:, 8:] = [0.1, 0.2, 0.3], 0.05, [1.0, -1.0]
    state[:, 3:7] = gripper_down([0.4, -2.9])
    objects = np.arange(32, dtype=np.float32).reshape(2, 16)
    objects[:, [7, 15]] = [[0, 1], [1, 0]]
    seen = Observations(state, objects)
    np.testing.assert_allclose(seen.gripper_position, np.float32([[0.1, 0.2, 0.3]] * 2))
    np.testing.assert_array_equal(seen.gripper_quaternion, state[:, 3:7])
    np.testing.assert_allclose(seen.gripper_yaw, [0.4, -2.9], atol=1e-6)
    np.testing.assert_array_equal(seen.gripper_opening, np.float32([0.05, 0.05]))
    np.testing.assert_array_equal(seen.joint_positions, [[1, -1]] * 2)
    assert seen.object_positions.tolist() == [
        [[0, 1, 2], [8, 9, 10]],
        [[16, 17, 18], [24, 25, 26]],
    ]
    assert seen.object_quaternions[1, 1].tolist() == [27, 28, 29, 30]
    assert seen.held.tolist() == [[False, True], [True, False]]


def test_no_objects_are_known_objects() -> None:
    seen = Observations(np.zeros((3, 15), np.float32), np.zeros((3, 0), np.float32))
    assert seen.only(["objects"]).object_positions.shape == (3, 0, 3)
    assert seen.held.shape == (3, 0)
