"""Images of one camera in one file: compressed without loss, one image a block.

The file is a Blosc2 array (``blosc2.b2nd``); any image is read alone.
"""

from collections.abc import Iterable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from prime_core.arrays import Indices
from prime_core.errors import DamagedError
from prime_core.files import new_file

SUFFIX = ".b2nd"
LEVEL = 5  # of 9: robosuite's pictures take 12.9 kB at 84 x 84 (of 21), 14.3 with 1, 11.3 with 9


class ImageFile:
    """Images of a file, mapped into memory and unpacked where they are indexed.

    Args:
        path: Of the file.

    Raises:
        DamagedError: If it is no such file.
    """

    def __init__(self, path: Path) -> None:
        import blosc2

        try:
            self._array = blosc2.open(str(path), mode="r", mmap_mode="r")
        except (OSError, RuntimeError, ValueError) as error:
            raise DamagedError(f"{path} is no file of images: {error}") from error

    @property
    def shape(self) -> tuple[int, ...]:
        """``(N, H, W, 3)``."""
        return tuple(self._array.shape)

    def __getitem__(self, rows: slice | Indices) -> NDArray[np.uint8]:
        """Return images ``(n, H, W, 3)``."""
        if isinstance(rows, slice):
            rows = np.arange(self.shape[0])[rows]
        images = np.empty((len(rows), *self.shape[1:]), dtype=np.uint8)
        for image, row in zip(images, rows, strict=True):
            image[:] = self._array[int(row)]
        return images


def write_images(path: Path, batches: Iterable[NDArray[np.uint8]], shape: tuple[int, ...]) -> int:
    """Write images to a file, whole or not at all.

    Args:
        path: Of the file; its suffix is `SUFFIX`.
        batches: Each ``(n, H, W, 3)``; written as they come.
        shape: Of all of them, ``(N, H, W, 3)``.

    Returns:
        Bytes that they take.

    Raises:
        ValueError: If there are not N images.
    """
    import blosc2

    block = (1, *shape[1:])
    # One thread: the same bytes each time, and workers are as many as there are cores.
    packing = {"codec": blosc2.Codec.ZSTD, "clevel": LEVEL, "nthreads": 1}
    with new_file(path) as partial:
        array = blosc2.empty(
            shape, np.uint8, chunks=block, blocks=block, cparams=packing, urlpath=str(partial)
        )
        count = 0
        for batch in batches:
            for image in batch:
                if count < shape[0]:
                    array[count] = image
                count += 1
        if count != shape[0]:
            raise ValueError(f"there are {count} images, not {shape[0]}")
        del array
        return partial.stat().st_size
