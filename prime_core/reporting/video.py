"""Videos of what a camera saw."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from prime_core.contracts.environment import CONTROL_FREQUENCY
from prime_core.errors import PrimeError
from prime_core.files import new_file

Picture = NDArray[np.uint8]


ENCODERS = ("libx264", "h264")
"""Of H.264, which plays in browsers and in slides; the first that PyAV was built with."""


QUALITY = "20"
"""Constant rate factor: 0 is lossless, 51 is worst; 20 shows no artefacts at small sizes."""


def write_video(
    path: Path | str, frames: Picture | Sequence[Picture], fps: int = CONTROL_FREQUENCY
) -> None:
    """Write an mp4 file, whole or not at all; one that is there gives way.

    Args:
        path: The file.
        frames: ``(T, H, W, 3)`` uint8, red, green, blue; or as many pictures of one size.
        fps: Frames a second.

    Raises:
        PrimeError: If PyAV is not installed or cannot encode.
        ValueError: If the frames are not such pictures.
    """
    _check(frames)
    try:
        import av
    except ImportError as error:
        raise PrimeError(
            "videos are written with PyAV, which is not installed: pip install av"
        ) from error
    try:
        with new_file(Path(path)) as partial:
            _encode(av, partial, frames, fps)
    except av.FFmpegError as error:
        raise PrimeError(f"{path} cannot be encoded as H.264: {error}") from error


def _check(frames: Picture | Sequence[Picture]) -> None:
    if len(frames) == 0:
        raise ValueError("a video has at least one frame")
    first = frames[0].shape
    for frame in frames:
        if frame.dtype != np.uint8 or frame.shape != first or frame.ndim != 3 or first[2] != 3:
            raise ValueError(
                f"a frame is {frame.dtype} of shape {frame.shape}; all should be uint8 of one "
                "shape (height, width, 3)"
            )


def _encode(av: Any, path: Path, frames: Picture | Sequence[Picture], fps: int) -> None:
    height, width = frames[0].shape[:2]
    # The codec halves the resolution of colour, so both sizes must be even: repeat the edge.
    padding = ((0, height % 2), (0, width % 2), (0, 0))
    encoder = next((name for name in ENCODERS if name in av.codecs_available), None)
    if encoder is None:
        raise PrimeError("this PyAV was built without an encoder of H.264: pip install av")
    with av.open(str(path), mode="w", format="mp4", options={"movflags": "faststart"}) as container:
        stream = container.add_stream(encoder, rate=fps, options={"crf": QUALITY})
        stream.height, stream.width = height + height % 2, width + width % 2
        stream.pix_fmt = "yuv420p"
        for frame in frames:
            picture = np.ascontiguousarray(np.pad(frame, padding, mode="edge"))
            for packet in stream.encode(av.VideoFrame.from_ndarray(picture, format="rgb24")):
                container.mux(packet)
        for packet in stream.encode():
            container.mux(packet)
