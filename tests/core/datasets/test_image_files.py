"""Files of images: exact, the same bytes each time, read one by one, damage told."""

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from prime_core.datasets.images.files import SUFFIX, ImageFile, write_images
from prime_core.errors import DamagedError


@pytest.fixture
def images() -> NDArray[np.uint8]:
    return np.random.default_rng(0).integers(0, 255, (7, 12, 10, 3)).astype(np.uint8)


def test_images_come_back_as_they_were(tmp_path: Path, images: NDArray[np.uint8]) -> None:
    path = tmp_path / f"front{SUFFIX}"
    size = write_images(path, [images[:3], images[3:]], images.shape)
    file = ImageFile(path)
    assert (file.shape, size) == (images.shape, path.stat().st_size)
    np.testing.assert_array_equal(file[:], images)
    np.testing.assert_array_equal(file[np.array([5, 0, 5])], images[[5, 0, 5]])
    np.testing.assert_array_equal(file[2:4], images[2:4])


def test_the_same_images_are_the_same_bytes(tmp_path: Path, images: NDArray[np.uint8]) -> None:
    paths = [tmp_path / f"{name}{SUFFIX}" for name in ("one", "two")]
    write_images(paths[0], [images], images.shape)
    write_images(paths[1], [images[:1], images[1:]], images.shape)
    assert paths[0].read_bytes() == paths[1].read_bytes()


@pytest.mark.parametrize("count", [6, 8])
def test_a_file_is_whole_or_not_there(
    tmp_path: Path, images: NDArray[np.uint8], count: int
) -> None:
    path = tmp_path / f"front{SUFFIX}"
    with pytest.raises(ValueError, match=f"there are 7 images, not {count}"):
        write_images(path, [images], (count, *images.shape[1:]))
    assert list(tmp_path.iterdir()) == []


def test_a_damaged_file_is_told(tmp_path: Path, images: NDArray[np.uint8]) -> None:
    path = tmp_path / f"front{SUFFIX}"
    write_images(path, [images], images.shape)
    path.write_bytes(path.read_bytes()[:100])
    with pytest.raises(DamagedError, match=r"front\.b2nd is no file of images"):
        ImageFile(path)
