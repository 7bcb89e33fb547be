"""``prime annotate`` in a process of its own: without a simulator, and killed."""

import os
import shutil
import signal
import subprocess
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from prime_core.cli.annotate import annotate
from prime_core.datasets.read import read_dataset

from ..datasets.samples import fingerprint

NO_SIMULATOR = """
import sys

class Absent:
    def find_spec(self, name, path=None, target=None):
        if name.split(".")[0] in ("mujoco", "robosuite", "mink", "torch", "lerobot"):
            raise ImportError(f"{name} is not installed here")

sys.meta_path.insert(0, Absent())
"""


def test_neither_a_simulator_nor_torch_is_asked_for(
    trained: Path, climbs: Path, tmp_path: Path, prime_command: Callable[..., Any]
) -> None:
    (tmp_path / "installed" / "sitecustomize.py").write_text(NO_SIMULATOR)
    job = prime_command("annotate", str(climbs), "--run", str(trained), "--in-place")
    said, errors = job.communicate(timeout=60)
    assert job.returncode == 0, errors
    assert f"Written to {climbs}\n" in said
    assert "0: rise (0.90)" in said


SLOW_DISK = """
import shutil, time
copied = shutil.copymode

def slowly(*arguments, **options):
    copied(*arguments, **options)
    open("reached", "a").close()
    time.sleep(30)  # until it is killed, however late that is

shutil.copymode = slowly
"""


def test_killed_at_any_time_it_leaves_the_data_set_as_it_was(
    trained: Path, climbs: Path, tmp_path: Path, prime_command: Callable[..., Any]
) -> None:
    before = fingerprint(climbs)
    (tmp_path / "installed" / "sitecustomize.py").write_text(SLOW_DISK)
    for end in (signal.SIGKILL, signal.SIGINT):
        (tmp_path / "reached").unlink(missing_ok=True)
        job: subprocess.Popen[str] = prime_command(
            "annotate", str(climbs), "--run", str(trained), "--in-place"
        )
        deadline = time.monotonic() + 60
        while not (tmp_path / "reached").exists() and time.monotonic() < deadline:
            time.sleep(0.01)
        os.kill(job.pid, end)
        job.communicate(timeout=60)
        assert job.returncode not in (0, 1)
        assert fingerprint(climbs) == before
    # A killed process cannot clear away what it wrote aside; one that is interrupted does.
    assert len([*tmp_path.glob(".climbs*")]) == 1
    (tmp_path / "installed" / "sitecustomize.py").unlink()
    for left in tmp_path.glob(".climbs*"):
        shutil.rmtree(left)
    assert fingerprint(climbs) == before
    annotate(climbs, trained, in_place=True)
    assert read_dataset(climbs, episodes=[0]).segments is not None
