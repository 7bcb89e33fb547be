"""Images of one camera and episode as frames of a video, which LeRobot joins of many episodes."""

from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from prime_core.arrays import Floats, Indices
from prime_core.datasets import layout
from prime_core.datasets.episodes import CLOCK_TOLERANCE, EpisodeEntry, file_in
from prime_core.datasets.header import Camera, Header
from prime_core.datasets.parquet_reader import numbers, read_table, whole_numbers
from prime_core.errors import DatasetError, DemonstrationError

LONGEST = 1e7  # [s], four months: what is later is no time in a video


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
        try:
            path, start = self._place
        except DatasetError as error:
            raise DemonstrationError(str(error)) from error
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
