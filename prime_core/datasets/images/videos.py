"""Images of one camera and episode as frames of a video.

LeRobot joins the videos of many episodes; what is written here has a file for each.
"""

import os
import shutil
from collections.abc import Mapping
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from prime_core.arrays import Floats, Indices
from prime_core.contracts.images import ChosenImages, Images
from prime_core.datasets.files import layout
from prime_core.datasets.files.episodes import CLOCK_TOLERANCE, EpisodeEntry, file_in
from prime_core.datasets.files.header import Camera, Header
from prime_core.datasets.files.parquet_reader import numbers, read_table, whole_numbers
from prime_core.datasets.files.statistics import PixelCounts, Statistics
from prime_core.errors import DatasetError, DemonstrationError, PrimeError

LONGEST = 1e7  # [s], four months: what is later is no time in a video
AT_ONCE = 64  # images in memory while they are encoded


def check_sizes(images: Mapping[str, tuple[int, ...]]) -> None:
    """Check that images can be frames of videos.

    Args:
        images: Their shapes by camera, ``(H, W, 3)``.

    Raises:
        DatasetError: If a height or width is odd.
    """
    for name, (height, width, *_) in images.items():
        if height % 2 or width % 2:
            raise DatasetError(
                f"images of camera {name!r} are {height} x {width} pixels; both must be even in "
                "videos, which halve the resolution of colour: choose another size, or PNG"
            )


def write_frames(path: Path, images: Images, fps: int) -> Statistics:
    """Write an episode's images as a video, encoded as LeRobot does by default.

    Args:
        path: Of the file; its folder is made if need be.
        images: ``(N, H, W, 3)``, read a few at a time. A video that holds them alone is copied.
        fps: Frames a second.

    Returns:
        Their statistics, before they are encoded; of a video that is copied, as it shows them.

    Raises:
        PrimeError: If there is no such encoder.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    source = images.whole if isinstance(images, ChosenImages) else images
    counts = PixelCounts(images.shape[0])
    own = source.own_file() if isinstance(source, VideoImages) else None
    if own is not None:
        shutil.copyfile(own, path)
        for rows in counts.batches(AT_ONCE):
            counts.add(rows, np.asarray(images[rows]))
    else:
        _encode(path, images, counts, fps)
    return counts.statistics()


def _encode(path: Path, images: Images, counts: PixelCounts, fps: int) -> None:
    import av

    if layout.ENCODER not in av.codecs_available:
        raise PrimeError(
            f"this PyAV was built without the encoder {layout.ENCODER}: pip install av"
        )
    os.environ.setdefault("SVT_LOG", "1")  # else the encoder prints its settings
    options = {name: str(value) for name, value in layout.ENCODER_OPTIONS.items()}
    # One thread: workers are as many as there are cores.
    options["svtav1-params"] = "fast-decode=0:lp=1"
    with av.open(str(path), "w") as container:
        # Of this encoder it is a stream of pictures; type checkers do not know.
        stream: Any = container.add_stream(layout.ENCODER, rate=fps, options=options)
        stream.pix_fmt = layout.PIXEL_FORMAT
        stream.height, stream.width = images.shape[1:3]
        for rows in counts.batches(AT_ONCE):
            batch = np.asarray(images[rows])
            counts.add(rows, batch)
            for image in batch:
                frame = av.VideoFrame.from_ndarray(np.ascontiguousarray(image), format="rgb24")
                container.mux(stream.encode(frame))
        container.mux(stream.encode())


class VideoImages:
    """The images of one camera in one episode, decoded where they are indexed.

    Args:
        header: Of the data set.
        entry: The episode.
        camera: Whose images.
        clock: When each frame was taken, from the episode's start [s], ``(N,)``.

    Attributes:
        shape: ``(N, H, W, 3)``.
    """

    def __init__(self, header: Header, entry: EpisodeEntry, camera: Camera, clock: Floats) -> None:
        self.shape = (entry.length, *camera.shape)
        self._header, self._entry, self._key, self._clock = header, entry, camera.key, clock

    def __getitem__(self, rows: Indices) -> NDArray[np.uint8]:
        """Return images ``(n, H, W, 3)``.

        Raises:
            DemonstrationError: If there is no such frame, or one of another size.
        """
        path, start = self._found()
        times = start + self._clock[rows]
        found, end = self._decoded(path, times) if len(rows) else ({}, 0.0)
        for number, row in enumerate(rows):
            if number not in found:
                raise DemonstrationError(
                    f"{path}: {self._key!r}: frame {row} of episode {self._entry.index} should be "
                    f"{times[number]:.4g} s from the start, and the video has no frame then; the "
                    f"last that was found is at {end:.4g} s: take a whole copy"
                )
        images = [found[number] for number in range(len(rows))]
        return np.array(images, dtype=np.uint8).reshape(len(rows), *self.shape[1:])

    def own_file(self) -> Path | None:
        """Return the video if it holds this episode alone, encoded as it would be here.

        Raises:
            DemonstrationError: If it is not known where the images are.
        """
        import av

        path, start = self._found()
        try:
            with av.open(str(path)) as container:
                stream = container.streams.video[0]
                found = (stream.codec.canonical_name, stream.pix_fmt, stream.frames)
        except (av.FFmpegError, IndexError):
            return None  # told when it is decoded
        is_own = start == 0 and found == ("av1", layout.PIXEL_FORMAT, self.shape[0])
        return path if is_own else None

    def _found(self) -> tuple[Path, float]:
        try:
            return self._place
        except DatasetError as error:
            raise DemonstrationError(str(error)) from error

    @cached_property
    def _place(self) -> tuple[Path, float]:
        """The video, and when the episode begins in it [s]."""
        listed, names = self._entry.listed, ("chunk_index", "file_index", "from_timestamp")
        keys = [f"videos/{self._key}/{name}" for name in names]
        table = read_table(listed, ["episode_index", *keys], [self._entry.index])
        chunk, file = (int(whole_numbers(listed, table, key)[0]) for key in keys[:2])
        start = float(numbers(listed, table, keys[2], 1)[0, 0])
        path = file_in(self._header, "video_path", layout.VIDEO_FILE, chunk, file, self._key)
        if not path.is_file():
            raise DatasetError(
                f"{path} is missing: it should hold {self._key!r} of episode {self._entry.index}"
            )
        if not 0 <= start < LONGEST:
            raise DatasetError(
                f"{listed}: {keys[2]} is {start} in episode {self._entry.index}; it should be the "
                "seconds from the video's start"
            )
        return path, start

    def _decoded(self, path: Path, times: Floats) -> tuple[dict[int, NDArray[np.uint8]], float]:
        """Return the images at some times by their numbers, and when the last frame was [s]."""
        import av

        found: dict[int, NDArray[np.uint8]] = {}
        at = 0.0
        try:
            with av.open(str(path)) as container:
                # To the last frame before that stands alone: others are decoded from it on.
                first = min(times.min() - CLOCK_TOLERANCE, LONGEST)
                container.seek(round(first * av.time_base), backward=True)
                for frame in container.decode(container.streams.video[0]):
                    if frame.time is None:
                        continue
                    at = frame.time
                    for number in np.flatnonzero(np.abs(times - at) <= CLOCK_TOLERANCE):
                        found[int(number)] = self._pixels(path, frame)
                    if at >= times.max():
                        break
        except (av.FFmpegError, IndexError) as error:  # IndexError: it has no pictures
            reason = getattr(error, "strerror", None) or error
            raise DemonstrationError(
                f"{path}: {self._key!r}: the video cannot be decoded in episode "
                f"{self._entry.index} ({reason}): take a whole copy"
            ) from error
        return found, at

    def _pixels(self, path: Path, frame: Any) -> NDArray[np.uint8]:
        height, width = self.shape[1:3]
        if (frame.height, frame.width) != (height, width):
            raise DemonstrationError(
                f"{path}: {self._key!r}: frames are {frame.height} x {frame.width} pixels; they "
                f"should be {height} x {width}, as {layout.INFO_FILE} says"
            )
        pixels: NDArray[np.uint8] = frame.to_ndarray(format="rgb24")
        return pixels
