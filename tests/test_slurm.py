"""Runs on a real Slurm: the same results, and what is left after jobs and nodes are gone.

Skipped where no Slurm with two idle nodes answers; tests/start_slurm.sh starts one.
"""

import shutil
import subprocess
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from prime_core.experiments.experiment import Experiment
from prime_core.experiments.reading import read_experiment
from prime_core.experiments.slurm import QueueWatcher

from .test_pipeline import QUICK, TINY, assert_same, command, prime


def _has_two_nodes() -> bool:
    if shutil.which("sinfo") is None:
        return False
    arguments = ["sinfo", "--noheader", "--Node", "--states=idle", "--format=%N"]
    try:
        asked = subprocess.run(arguments, capture_output=True, text=True, timeout=20)
    except subprocess.TimeoutExpired:
        return False
    return asked.returncode == 0 and len(asked.stdout.split()) >= 2


needs_slurm = pytest.mark.skipif(
    not _has_two_nodes(), reason="no Slurm with two idle nodes: tests/start_slurm.sh starts one"
)
SLURM = ["compute.cluster=slurm", "compute.memory_gb=2"]
LONG = [*TINY, *SLURM, "collection.episodes=240", "collection.draws_per_episode=12"]


def slurm(*arguments: str) -> str:
    return subprocess.run(arguments, check=True, capture_output=True, text=True).stdout


def jobs() -> list[list[str]]:
    """Return number, state and node of each element of this user's job arrays."""
    lines = slurm("squeue", "--me", "--noheader", "--array", "--format=%i %T %N").splitlines()
    return [line.split() for line in lines]


def wait_for(condition: Callable[[], bool], seconds: float) -> None:
    deadline = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < deadline, "what was waited for did not come"
        time.sleep(0.2)


@pytest.fixture
def nodes_up() -> Iterator[None]:
    yield
    down = slurm("sinfo", "--noheader", "--Node", "--states=down", "--format=%N").split()
    for node in down:
        slurm("scontrol", "update", f"nodename={node}", "state=resume")


class Running:
    """A run whose collection is under way on two nodes."""

    def __init__(self, out: Path) -> None:
        config = read_experiment(QUICK, LONG)
        self.collection = Experiment(config, out / config.name).collection
        arguments = command("--until", "collection", out=out, settings=LONG)
        self.process = subprocess.Popen(
            arguments, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
        )
        wait_for(lambda: len(self.kept()) >= 6, 240)
        assert len([job for job in jobs() if job[1] == "RUNNING"]) == 2

    def kept(self) -> set[str]:
        return set(self.collection.items()) - set(self.collection.missing())

    def timings(self, items: set[str]) -> dict[str, object]:
        return {item: next(iter(self.collection.compute([item])))["timing"] for item in items}


@pytest.mark.slow
@needs_slurm
def test_slurm_makes_the_same_data_and_results_as_this_machine(tmp_path: Path) -> None:
    outs = tmp_path / "local", tmp_path / "slurm"
    for out, settings in zip(outs, (TINY, [*TINY, *SLURM]), strict=True):
        completed = prime(out=out, settings=settings)
        assert completed.returncode == 0, completed.stderr
    first, second = (
        Experiment(read_experiment(QUICK, TINY), out / "lift-quick").stages for out in outs
    )
    for name in ("demonstrations", "collection", "parsing", "replay", "evaluation.prime"):
        assert_same(first[name].results(), second[name].results())
    weights = [
        sorted(path.read_bytes() for path in (out / "lift-quick").rglob("*.safetensors"))
        for out in outs
    ]
    assert weights[0]
    assert weights[0] == weights[1]


@pytest.mark.slow
@pytest.mark.campaign
@needs_slurm
def test_what_a_cancelled_job_had_finished_is_kept(tmp_path: Path) -> None:
    running = Running(tmp_path)
    slurm("scancel", jobs()[0][0])
    _, complaint = running.process.communicate(timeout=240)
    assert running.process.returncode == 1
    assert "a worker of stage 'collection' stopped" in complaint
    assert "CANCELLED" in complaint
    assert "Traceback" not in complaint
    before = running.timings(running.kept())
    completed = prime("--until", "collection", out=tmp_path, settings=LONG)
    assert completed.returncode == 0, completed.stderr
    assert not running.collection.missing()
    assert running.timings(set(before)) == before


@pytest.mark.slow
@pytest.mark.campaign
@needs_slurm
def test_the_jobs_of_a_node_that_goes_down_are_done_on_another(
    tmp_path: Path, nodes_up: None
) -> None:
    running = Running(tmp_path)
    before = running.timings(running.kept())
    slurm("scontrol", "update", f"nodename={jobs()[0][2]}", "state=down", "reason=test")
    _, complaint = running.process.communicate(timeout=400)
    assert running.process.returncode == 0, complaint
    assert not running.collection.missing()
    assert running.timings(set(before)) == before


def test_a_job_that_slurm_has_forgotten_is_done() -> None:
    watcher = QueueWatcher()
    for job in ("7_0", "7_1", "7_2", "8"):
        watcher.register_job(job)
    text = "7_0|RUNNING|node1\n7_2|CONFIGURING|\n8|CANCELLED|node2\n9|PENDING|\n"
    watcher._info_dict = watcher.read_info(text)
    done = {job: watcher.is_done(job, mode="cache") for job in ("7_0", "7_1", "7_2", "8")}
    assert done == {"7_0": False, "7_1": True, "7_2": False, "8": True}
