"""Places that cannot be written, disks that are full: one line, and the run goes on later."""

import errno
import json
import os
import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
import submitit.local.local
from submitit.core.utils import FailedJobError, UncompletedJobError

from prime_core.cli import main
from prime_core.errors import PrimeError
from prime_core.experiments.experiment import Experiment
from prime_core.experiments.run_folder.place import PlaceError, place_error, place_told
from prime_core.experiments.running import _told

Run = Callable[..., None]
Start = Callable[..., "subprocess.Popen[str]"]
ADVICE = "or choose another place; then run again: what is finished is kept"


@contextmanager
def mounted(folder: Path, *options: str) -> Iterator[None]:
    """Mount something on a folder, or skip the test where that is not allowed."""
    folder.mkdir(exist_ok=True)
    done = subprocess.run(["mount", *options, str(folder)], capture_output=True, check=False)
    if done.returncode:
        pytest.skip("only root may mount")
    try:
        yield
    finally:
        subprocess.run(["umount", "--lazy", str(folder)], check=True)


needs_mount = pytest.mark.skipif(
    os.name != "posix" or os.geteuid() != 0 or not shutil.which("mount"),
    reason="only root may mount",
)


@needs_mount
@pytest.mark.parametrize("kilobytes", [0, 40, 120, 260])
def test_a_full_disk_is_told_and_the_run_goes_on_when_there_is_space(
    prime_run: Run, finished: Path, tmp_path: Path, kilobytes: int
) -> None:
    disk = tmp_path / "disk"
    with mounted(disk, "-t", "tmpfs", "-o", "size=2m", "tmpfs"):
        with (disk / "filler").open("wb") as filler:
            filler.write(bytes(2 * 2**20 - kilobytes * 1024))
        with pytest.raises(PrimeError) as caught:
            prime_run(out=disk)
        told = caught.value
        assert "No space left on device" in str(told)
        assert str(told).startswith(str(disk))
        (disk / "filler").unlink()
        prime_run(out=disk)
        found = json.loads((disk / "toy" / "results.json").read_text())
        expected = json.loads((finished / "results.json").read_text())
        assert found["results"] == expected["results"]


@needs_mount
@pytest.mark.slow
def test_a_worker_that_meets_a_full_disk_says_so(prime_command: Start, tmp_path: Path) -> None:
    disk = tmp_path / "disk"
    arguments = ["run", "toy.yaml", "--out", str(disk), "--set", "compute.workers=2"]
    with mounted(disk, "-t", "tmpfs", "-o", "size=3m", "tmpfs"):
        for kilobytes in (60, 150, 300, 500):
            free = os.statvfs(disk)
            with (disk / "filler").open("wb") as filler:
                filler.write(bytes(max(free.f_bavail * free.f_frsize - kilobytes * 1024, 0)))
            full = prime_command(*arguments)
            _, told = full.communicate(timeout=300)
            (disk / "filler").unlink()
            if full.returncode == 0:
                break
            assert full.returncode == 1
            assert told.count("\n") == 1, told
            assert told.startswith(f"prime: {disk}")
            assert told.endswith(
                f"No space left on device. Make it writable or make space, {ADVICE}\n"
            )
        else:
            done = prime_command(*arguments)
            done.communicate(timeout=600)
            assert done.returncode == 0
        assert (disk / "toy" / "results.json").exists()


def test_a_worker_may_begin_before_its_start_is_noted(
    prime_run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    start = submitit.local.local.start_controller

    def slowly(*given: Any, **named: Any) -> Any:
        process = start(*given, **named)
        time.sleep(2)
        return process

    monkeypatch.setattr(submitit.local.local, "start_controller", slowly)
    # It has begun if it tells what it misses: the toy pack is installed in this process alone.
    with pytest.raises(PrimeError, match="no demonstrator is registered as 'toy/climber'"):
        prime_run("compute.workers=1", until="demonstrations")


@pytest.mark.parametrize(
    ("keeps", "end"), [(True, "again: what is finished is kept"), (False, "again")]
)
def test_only_what_is_kept_is_said_to_be(tmp_path: Path, keeps: bool, end: str) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(PlaceError) as raised, place_told(tmp_path, keeps=keeps):
        (tmp_path / "file" / "below").mkdir()
    assert str(raised.value).endswith(f"or choose another place; then run {end}")


def test_a_place_that_is_a_file_or_below_one_is_told(prime_run: Run, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    for place in (tmp_path / "file", tmp_path / "file" / "below"):
        with pytest.raises(PlaceError, match=rf"^{tmp_path}/file.*: Not a directory. Make it"):
            prime_run(out=place)


def test_other_commands_tell_of_places_too(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def command() -> None:
        raise OSError(errno.ENOSPC, "No space left on device", "/x/parsed")

    monkeypatch.setattr("prime_core.cli.build_app", lambda stream: command)
    with pytest.raises(SystemExit) as ended:
        main()
    assert ended.value.code == 1
    assert capsys.readouterr().err.startswith("prime: /x/parsed: No space left on device. Make")


@needs_mount
def test_a_read_only_place_can_be_asked_but_not_run_in(
    prime_run: Run, finished: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    from prime_core.cli.show import show
    from prime_core.experiments.parse_dataset import open_run

    folder = tmp_path / "toy"
    shutil.copytree(finished, folder, symlinks=True)
    with mounted(folder, "--bind", "-o", "ro", str(folder)):
        show(tmp_path / "toy.yaml", [], tmp_path)
        assert "1/1 models" in capsys.readouterr().out
        open_run(folder).idm.load()
        with pytest.raises(PlaceError) as caught:
            prime_run("seed=3")
        assert str(caught.value) == (
            f"{folder}: Read-only file system. Make it writable or make space, {ADVICE}"
        )


@pytest.mark.parametrize(
    ("text", "start"),
    [
        ("OSError: [Errno 28] No space left on device: '/x/y'", "/x/y: No space left"),
        ("x\nPermissionError: [Errno 13] Permission denied: 'a' -> 'b'\n", "a: Permission denied"),
        ("SafetensorError: I/O error: No space left on device (os error 28)", "/run: No space"),
        ("OSError: [Errno 122] Disk quota exceeded", "/run: Disk quota exceeded"),
    ],
)
def test_what_other_libraries_say_of_a_place_is_understood(text: str, start: str) -> None:
    assert str(place_error(text, Path("/run"))).startswith(start)


@pytest.mark.parametrize("text", ["ValueError: 28", "OSError: [Errno 2] No such file: 'x'", ""])
def test_other_errors_are_none_of_the_place(text: str) -> None:
    assert place_error(text, Path("/run")) is None


@pytest.mark.slow
def test_two_runs_at_once_give_the_same_results(
    prime_command: Start, finished: Path, tmp_path: Path
) -> None:
    assert sys.platform != "win32"
    arguments = ["run", "toy.yaml", "--out", "runs", "--set", "compute.workers=2"]
    both = [prime_command(*arguments) for _ in range(2)]
    told = [one.communicate(timeout=600) for one in both]
    assert [one.returncode for one in both] == [0, 0], told
    waited = [out for out, _ in told if "another run is at work in" in out]
    assert len(waited) == 1
    assert waited[0].count("was done before") >= 9
    found = json.loads((tmp_path / "runs" / "toy" / "results.json").read_text())
    assert found["results"] == json.loads((finished / "results.json").read_text())["results"]


TRACE = """Job (task=0) failed during processing with trace:
----------------------
Traceback (most recent call last):
  File "a.py", line 3, in fit
    raise ValueError("x")
my_pack.OddError: rows: 3, must be 4

----------------------
You can check full logs with 'job.stderr(0)' and 'job.stdout(0)'or at paths:
  - /x/1_log.err
"""


@pytest.mark.parametrize(
    ("error", "text"),
    [
        (
            FailedJobError(TRACE),
            "stopped: my_pack.OddError: rows: 3, must be 4. Its logs are under ",
        ),
        (
            UncompletedJobError("Job 3 has no output (state: CANCELLED)"),
            "stopped (CANCELLED): some",
        ),
        (FailedJobError(""), "stopped: for an unknown reason. Its logs are under "),
    ],
)
def test_what_stopped_a_worker_is_told_without_its_traceback(
    toy: Callable[..., Experiment], error: Exception, text: str
) -> None:
    stage = toy().collection
    stage.folder.mkdir(parents=True)
    told = str(_told(stage, error))
    assert told.startswith(f"a worker of stage 'collection' {text}")
    assert "Traceback" not in told
    stage.error_file.write_text("no cube is left")
    assert str(_told(stage, error)) == "no cube is left"
