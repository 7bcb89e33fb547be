"""Images of several sources as one, read where they are indexed."""

from typing import Any

import numpy as np
import pytest

from prime_core.checks.samples import sample_observations
from prime_core.contracts.images import CameraConfig, ChosenImages
from prime_core.contracts.observations import Observations


class Counting:
    """Images that count how many of them were read."""

    def __init__(self, images: Any) -> None:
        self._images, self.shape, self.read = images, images.shape, 0

    def __getitem__(self, rows: Any) -> Any:
        found = self._images[rows]
        self.read += len(found)
        return found


@pytest.fixture
def pictures() -> Any:
    return np.random.default_rng(1).integers(0, 255, (9, 4, 5, 3)).astype(np.uint8)


def test_images_of_several_sources_follow_one_another(pictures: Any) -> None:
    joined = ChosenImages.joined([pictures[:4], pictures[4:]])
    assert joined.shape == pictures.shape
    np.testing.assert_array_equal(joined[np.array([8, 0, 4, 3, 8])], pictures[[8, 0, 4, 3, 8]])
    np.testing.assert_array_equal(np.asarray(joined), pictures)
    np.testing.assert_array_equal(np.asarray(joined[2:7][1:3]), pictures[3:5])


def test_only_what_is_indexed_is_read(pictures: Any) -> None:
    sources = [Counting(pictures[:4]), Counting(pictures[4:])]
    chosen = ChosenImages.joined(sources).chosen(np.array([7, 1, 2]))
    _ = chosen.shape, chosen[1:], ChosenImages.joined([chosen, chosen])
    assert [each.read for each in sources] == [0, 0]
    np.testing.assert_array_equal(chosen[np.array([0])], pictures[[7]])
    assert [each.read for each in sources] == [0, 1]


def test_observations_are_joined_without_reading_their_images(pictures: Any) -> None:
    seen = sample_observations(np.random.default_rng(0), 9)
    source = Counting(pictures)
    parts = [Observations(seen.state, seen.environment_state, {"front": source})] * 2
    joined = Observations.join(parts)
    assert (len(joined), joined.images["front"].shape[0], source.read) == (18, 18, 0)
    np.testing.assert_array_equal(joined[np.array([17])].images["front"], pictures[[8]])


def test_images_of_one_camera_are_of_one_size(pictures: Any) -> None:
    with pytest.raises(ValueError, match="must be of one size"):
        ChosenImages.joined([pictures, pictures[:, 1:]])


def test_a_camera_is_named_once() -> None:
    with pytest.raises(ValueError, match="each camera may be named once only"):
        CameraConfig(cameras=("wrist", "wrist"))
