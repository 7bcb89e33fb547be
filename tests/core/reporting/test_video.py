"""Videos play back as what was written."""

import builtins
from pathlib import Path
from typing import Any

import av
import numpy as np
import pytest

from prime_core.errors import PrimeError
from prime_core.reporting.video import write_video


def pictures(count: int = 30, height: int = 84, width: int = 96) -> Any:
    rows, columns = np.mgrid[0:height, 0:width]
    frames = [np.dstack((rows * 2, columns * 2, np.full_like(rows, 6 * t))) for t in range(count)]
    return np.stack(frames).astype(np.uint8)


def play(path: Path) -> tuple[Any, Any]:
    container = av.open(str(path))
    stream = container.streams.video[0]
    frames = [frame.to_ndarray(format="rgb24") for frame in container.decode(video=0)]
    kind = (stream.codec_context.name, stream.average_rate)
    container.close()
    return np.stack(frames), kind


def test_a_video_plays_back(tmp_path: Path) -> None:
    frames = pictures()
    write_video(tmp_path / "new" / "episode.mp4", frames, fps=20)
    found, (codec, rate) = play(tmp_path / "new" / "episode.mp4")
    assert (codec, rate) == ("h264", 20)
    assert found.shape == frames.shape
    assert np.abs(found.astype(int) - frames).mean() < 4
    assert [path.name for path in (tmp_path / "new").iterdir()] == ["episode.mp4"]


def test_odd_sizes_grow_by_a_row_and_a_column(tmp_path: Path) -> None:
    frames = pictures(5, 65, 81)
    write_video(tmp_path / "odd.mp4", list(frames))
    found, _ = play(tmp_path / "odd.mp4")
    assert found.shape == (5, 66, 82, 3)
    assert np.abs(found[:, :65, :81].astype(int) - frames).mean() < 4


def test_one_frame_is_a_video(tmp_path: Path) -> None:
    write_video(tmp_path / "one.mp4", pictures(1))
    assert len(play(tmp_path / "one.mp4")[0]) == 1


def test_what_is_no_picture_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "episode.mp4"
    write_video(path, pictures(3))
    before = path.read_bytes()
    with pytest.raises(ValueError, match="at least one frame"):
        write_video(path, pictures(3)[:0])
    with pytest.raises(ValueError, match=r"float64 of shape \(84, 96, 3\)"):
        write_video(path, pictures(3).astype(np.float64))
    with pytest.raises(ValueError, match="uint8 of one shape"):
        write_video(path, [*pictures(1), *pictures(1, 90)])
    assert path.read_bytes() == before


def test_a_failure_leaves_the_old_video(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "episode.mp4"
    write_video(path, pictures(3))
    before = path.read_bytes()

    def fail(_av: object, partial: Path, *_: object) -> None:
        partial.write_bytes(b"half")
        raise av.FFmpegError(1, "encoder gave up")

    monkeypatch.setattr("prime_core.reporting.video._encode", fail)
    with pytest.raises(PrimeError, match="cannot be encoded"):
        write_video(path, pictures(3))
    assert path.read_bytes() == before
    assert list(tmp_path.iterdir()) == [path]


def test_a_missing_library_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    true_import = builtins.__import__

    def without_av(name: str, *arguments: Any, **options: Any) -> Any:
        if name == "av":
            raise ImportError(name)
        return true_import(name, *arguments, **options)

    monkeypatch.setattr(builtins, "__import__", without_av)
    with pytest.raises(PrimeError, match="pip install av"):
        write_video(tmp_path / "episode.mp4", pictures(1))
