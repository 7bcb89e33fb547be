"""Images of one camera and episode in a data file: PNG files in a column, as LeRobot has them."""

import io
from typing import Any

import numpy as np
from numpy.typing import NDArray

from prime_core.arrays import Indices
from prime_core.contracts.images import ChosenImages, Images
from prime_core.datasets.files import layout
from prime_core.datasets.files.episodes import EpisodeEntry
from prime_core.datasets.files.header import Camera, Header
from prime_core.datasets.files.parquet_reader import read_table
from prime_core.datasets.files.statistics import PixelCounts, Statistics
from prime_core.errors import DatasetError, DemonstrationError

AT_ONCE = 64  # images in memory while they are packed
LEVEL = 4  # of zlib; LeRobot's 6 takes twice the time, for files that are 3 % smaller
FORMATS = ("PNG", "JPEG", "WEBP")
SIGNATURE = b"\x89PNG\r\n\x1a\n"


def embedded(images: Images) -> tuple[Any, Statistics]:
    """Return images as an arrow array of PNG files, and their statistics.

    Args:
        images: ``(N, H, W, 3)``, read a few at a time. PNG files of a data set are not packed anew.
    """
    import pyarrow as pa

    source = images.whole if isinstance(images, ChosenImages) else images
    files = source.png_files() if isinstance(source, EmbeddedImages) else None
    packed: list[bytes] = []
    counts = PixelCounts(images.shape[0])
    for rows in counts.batches(AT_ONCE):
        batch = np.asarray(images[rows])
        counts.add(rows, batch)
        packed += map(_packed, batch) if files is None else [files[row] for row in rows]
    names = [layout.IMAGE_FILE.format(frame_index=frame) for frame in range(images.shape[0])]
    parts = [pa.array(packed, pa.binary()), pa.array(names, pa.string())]
    return pa.StructArray.from_arrays(parts, ["bytes", "path"]), counts.statistics()


def _packed(image: NDArray[np.uint8]) -> bytes:
    from PIL import Image

    file = io.BytesIO()
    Image.fromarray(image).save(file, "PNG", compress_level=LEVEL)
    return file.getvalue()


class EmbeddedImages:
    """The images of one camera in one episode, read from the data file where they are indexed.

    Args:
        header: Of the data set.
        entry: The episode.
        camera: Whose images.

    Attributes:
        shape: ``(N, H, W, 3)``.
    """

    def __init__(self, header: Header, entry: EpisodeEntry, camera: Camera) -> None:
        self.shape = (entry.length, *camera.shape)
        self._folder, self._path, self._episode = header.folder, entry.file, entry.index
        self._key = camera.key

    def __getitem__(self, rows: Indices) -> NDArray[np.uint8]:
        """Return images ``(n, H, W, 3)``.

        Raises:
            DemonstrationError: If one cannot be read, or is of another size.
        """
        stored = self._stored(rows)
        images = [self._unpacked(int(row), item) for row, item in zip(rows, stored, strict=True)]
        return np.array(images, dtype=np.uint8).reshape(len(rows), *self.shape[1:])

    def png_files(self) -> list[bytes] | None:
        """Return the images as they are stored; None unless all of them are PNG files.

        Raises:
            DemonstrationError: If they cannot be read; whether one is damaged shows in its pixels.
        """
        files = [item and item["bytes"] for item in self._stored(np.arange(self.shape[0]))]
        return files if all(file and file.startswith(SIGNATURE) for file in files) else None

    def _stored(self, rows: Indices) -> list[Any]:
        import pyarrow.types as kinds

        try:
            column = read_table(self._path, [self._key], [self._episode])[self._key]
        except DatasetError as error:
            raise DemonstrationError(str(error)) from error
        kind = column.type
        if not kinds.is_struct(kind) or {"bytes", "path"} - {field.name for field in kind}:
            raise DemonstrationError(
                f"{self._path}: column {self._key!r} is {kind}; it should be LeRobot's images: "
                "struct<bytes: binary, path: string>"
            )
        if len(column) != self.shape[0]:
            raise DemonstrationError(
                f"{self._path}: column {self._key!r} has {len(column)} images in episode "
                f"{self._episode}; it should have {self.shape[0]}"
            )
        items: list[Any] = column.take(np.asarray(rows)).to_pylist()
        return items

    def _unpacked(self, row: int, item: Any) -> NDArray[np.uint8]:
        """Return the image of a frame, ``(H, W, 3)``."""
        from PIL import Image, UnidentifiedImageError

        place = f"{self._path}: column {self._key!r}: the image of episode {self._episode}, frame "
        place += str(row)
        file = self._file_of(place, item)
        height, width = self.shape[1:3]
        try:
            with Image.open(file, formats=FORMATS) as image:
                if (image.mode, image.size) == ("RGB", (width, height)):
                    return np.asarray(image)
                found = f"{image.height} x {image.width} pixels, {image.mode}"
        except UnidentifiedImageError:
            found = f"no image of a format that is read ({', '.join(FORMATS)})"
        except Exception as error:  # whatever decoders raise where bytes are not what they were
            text = f"{place}, is damaged ({error or type(error).__name__}): take a whole copy"
            raise DemonstrationError(text) from error
        raise DemonstrationError(
            f"{place}, is {found}; it should be {height} x {width} pixels, RGB, as "
            f"{layout.INFO_FILE} says"
        )

    def _file_of(self, place: str, item: Any) -> Any:
        """Return what an image is read from: its bytes, or a file of the data set."""
        if item is not None and item["bytes"] is not None:
            return io.BytesIO(item["bytes"])
        if item is None or not item["path"]:
            raise DemonstrationError(f"{place}, is missing: it has neither bytes nor a path")
        path = (self._folder / item["path"]).resolve()
        if not path.is_relative_to(self._folder.resolve()) or not path.is_file():
            raise DemonstrationError(
                f"{place}, has no bytes, and its path is {item['path']!r}: it should be a file "
                "inside of the data set"
            )
        return path
