"""What exca keeps: which items are there, and what is mended of its files."""

import os
import socket
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

from exca.cachedict.inflight import InflightRegistry, Pid, WorkerInfo

from prime_core.experiments.experiment import Experiment
from prime_core.experiments.run_folder.cache import kept_items, mend

LINE = b'{"content":{"x":1},"#type":"Auto","#key":"%d"}\n'


def a_worker_of(folder: Path) -> "subprocess.Popen[bytes]":
    """Start a process that names a folder as workers do, and wait until that can be seen."""
    sleeper = [sys.executable, "-c", "import time; time.sleep(60)", str(folder)]
    worker = subprocess.Popen(sleeper)
    while os.fsencode(folder) not in Path(f"/proc/{worker.pid}/cmdline").read_bytes():
        time.sleep(0.01)  # it has just been started
    return worker


def test_items_are_seen_as_they_come_and_go(tmp_path: Path) -> None:
    path = tmp_path / "host-7-info.jsonl"
    assert kept_items(tmp_path) == set()
    path.write_bytes(LINE % 1 + LINE % 2)
    assert kept_items(tmp_path) == {"1", "2"}
    with path.open("ab") as file:
        file.write((LINE % 3)[:20])
    assert kept_items(tmp_path) == {"1", "2"}  # half a line is no item
    with path.open("ab") as file:
        file.write((LINE % 3)[20:])
    assert kept_items(tmp_path) == {"1", "2", "3"}
    with path.open("rb+") as file:  # as exca forgets an item
        file.write(b" " * (len(LINE % 1) - 1))
    assert kept_items(tmp_path) == {"2", "3"}
    path.unlink()
    assert kept_items(tmp_path) == set()


def test_half_lines_are_cut_off_unless_somebody_may_write_them(tmp_path: Path) -> None:
    half = LINE % 1 + (LINE % 2)[:20]
    # Another process wrote on after the half line of one that had its number.
    torn = half + LINE % 3 + LINE % 4
    folder = tmp_path / "stage"
    folder.mkdir()
    with a_worker_of(folder) as worker:
        here = socket.gethostname()
        files = {
            f"{here}-{worker.pid}": (half, half),
            f"{here}-{os.getpid()}": (half, LINE % 1),  # no worker of this stage
            "elsewhere-1": (half, half),
            "elsewhere-2": (torn, LINE % 1 + LINE % 4),
        }
        for name, (before, _) in files.items():
            (folder / f"{name}-info.jsonl").write_bytes(before)
        mend(folder)
        found = {name: (folder / f"{name}-info.jsonl").read_bytes() for name in files}
        worker.kill()
    assert found == {name: after for name, (_, after) in files.items()}


def test_claims_of_others_than_workers_of_the_stage_are_dropped(
    toy: Callable[..., Experiment], tmp_path: Path
) -> None:
    job = toy()
    folder = job.collection.folder
    folder.mkdir(parents=True)
    with a_worker_of(folder) as worker:
        claims = {
            "0": Pid(host=socket.gethostname(), pid=worker.pid),
            "1": Pid(host=socket.gethostname(), pid=os.getpid()),  # lives, but is another process
            "2": Pid(host="elsewhere", pid=1),
        }
        for item, living in claims.items():
            with InflightRegistry(folder, worker=WorkerInfo(item, living)) as registry:
                assert registry.claim([item]) == [item]
        mend(folder)
        with InflightRegistry(folder) as registry:
            assert set(registry.get()) == {"0"}
        worker.kill()
    mend(folder)
    assert len(job.collection.results()) == len(job.collection.items())  # nobody is waited for


def test_a_broken_file_of_claims_is_removed(tmp_path: Path) -> None:
    path = tmp_path / "inflight.db"
    path.write_bytes(b"no data base" * 100)
    mend(tmp_path)
    assert not path.exists()
    with InflightRegistry(tmp_path) as registry:
        registry.claim(["0"])
    mend(tmp_path)
    assert path.exists()
