"""The main job on a little data: what is done again after a change, a kill, with other workers."""

import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rich.console import Console

from prime_core.datasets.read import read_dataset
from prime_core.errors import PrimeError
from prime_core.experiments.experiment import Experiment
from prime_core.experiments.reading import read_experiment
from prime_core.experiments.running import run_experiment

ROOT = Path(__file__).parents[1]
QUICK = ROOT / "experiments" / "lift_quick.yaml"
TINY = (ROOT / "tests" / "tiny_experiment.txt").read_text().split()
"""Settings of the quick experiment for `--set`, with which it takes a minute."""
ALONE = [*TINY, "compute.workers=0"]
"""The same without workers, each of which takes seconds to start in every stage."""


def command(*arguments: str, out: Path, settings: list[str] = TINY) -> list[str]:
    """Return the command line of ``prime run`` on the tiny experiment."""
    options = [part for setting in settings for part in ("--set", setting)]
    prime = [sys.executable, "-c", "from prime_core.cli import main; main()"]
    return [*prime, "run", str(QUICK), "--out", str(out), *options, *arguments]


def prime(
    *arguments: str, out: Path, settings: list[str] = TINY
) -> subprocess.CompletedProcess[str]:
    """Run ``prime run`` on the tiny experiment."""
    return subprocess.run(
        command(*arguments, out=out, settings=settings),
        capture_output=True,
        text=True,
        cwd=ROOT,
        timeout=900,
    )


def experiment(out: Path, *settings: str) -> Experiment:
    config = read_experiment(QUICK, [*TINY, *settings])
    return Experiment(config, out / config.name)


def test_a_gpu_that_is_not_there_stops_a_run_before_it_begins(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("torch.cuda.is_available", lambda: False)
    with pytest.raises(PrimeError, match=r"compute\.device is cuda, but torch finds no GPU here"):
        run_experiment(experiment(tmp_path, "compute.device=cuda"), Console(quiet=True))
    assert not list(tmp_path.iterdir())


def done(job: Experiment) -> dict[str, bool]:
    return {name: not stage.missing() for name, stage in job.stages.items()}


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder of runs with the tiny experiment, done by one process."""
    out = tmp_path_factory.mktemp("runs")
    completed = prime(out=out, settings=ALONE)
    assert completed.returncode == 0, completed.stdout + completed.stderr
    return out


def results(out: Path) -> dict[str, Any]:
    return dict(json.loads((out / "lift-quick" / "results.json").read_text()))


def test_a_run_leaves_results_with_versions_seeds_and_timing(finished: Path) -> None:
    found = results(finished)
    assert {"collection", "idm", "parsing", "replay", "evaluation.prime"} <= set(found["results"])
    assert found["versions"]["mujoco"]
    assert found["seeds"]["policies"] == [1]
    assert "run" in found["command"]
    assert str(QUICK) in found["command"]
    assert found["environment"]["type"] == "robosuite/lift"
    assert found["parameters"]["policy.prime"] > 10_000
    for timing in found["timing"].values():
        assert timing["process_seconds"] > 0
        assert timing["peak_megabytes"] > 50
    trials = json.loads((finished / "lift-quick" / "trials-prime.json").read_text())
    assert [len(rows) for rows in trials["checkpoint"]["1"].values()] == [1, 1]
    assert {"success", "steps", "calls"} <= set(trials["fresh"]["1"]["1"][0])


def test_the_outputs_for_people_are_there(finished: Path) -> None:
    folder = finished / "lift-quick"
    dataset = read_dataset(folder / "dataset")
    assert len(dataset.demonstrations) == 2
    assert dataset.segments is not None
    assert (folder / "timelines" / "all.png").stat().st_size > 1000
    assert len(list((folder / "timelines").glob("0*.png"))) == 2


def test_running_again_does_nothing(finished: Path) -> None:
    before = {path: path.stat().st_mtime_ns for path in finished.rglob("*.json")}
    completed = prime(out=finished)
    assert completed.returncode == 0, completed.stderr
    assert " in " not in "".join(
        line for line in completed.stdout.splitlines() if line.startswith("✓")
    )
    assert {path: path.stat().st_mtime_ns for path in finished.rglob("*.json")} == before


def test_a_new_learning_rate_redoes_the_policy_and_what_depends_on_it_no_more(
    finished: Path,
) -> None:
    assert all(
        ok for name, ok in done(experiment(finished)).items() if not name.startswith("video")
    )
    changed = done(experiment(finished, "policies.prime.learning_rate=1e-5"))
    assert [name for name, ok in changed.items() if not ok] == [
        "policy.prime",
        "evaluation.prime",
        "video.prime",
    ]
    changed = done(experiment(finished, "parser.alpha=1e-2"))
    assert not changed["parsing"]
    assert changed["idm"]
    assert not any(done(experiment(finished, "seed=5")).values())
    assert done(experiment(finished, "compute.workers=1")) == done(experiment(finished))


def test_a_variant_adds_what_differs_and_redoes_nothing(finished: Path, tmp_path: Path) -> None:
    out = tmp_path / "runs"
    shutil.copytree(finished, out, symlinks=True)
    settings = [*ALONE, "variants.greedy={parser: {type: greedy}, policies: {prime: {}}}"]
    completed = prime("--until", "greedy/replay", out=out, settings=settings)
    assert completed.returncode == 0, completed.stderr
    worked = [line for line in completed.stdout.splitlines() if line.startswith("✓ greedy/")]
    assert [line.split()[1] for line in worked] == ["greedy/parsing", "greedy/replay"]
    made = [line for line in completed.stdout.splitlines() if re.match(r"✓ \S+ in ", line)]
    assert made == worked
    assert "greedy: replay success" in completed.stdout
    found, before = results(out), results(finished)
    assert found["results"] == before["results"]
    assert set(found["variants"]["greedy"]) == {"parsing", "replay"}
    assert set(found["timing"]) - set(before["timing"]) == {"greedy/parsing", "greedy/replay"}


def test_a_policy_over_motor_actions_learns_from_rollouts_and_demonstrations(
    finished: Path, tmp_path: Path
) -> None:
    out = tmp_path / "runs"
    shutil.copytree(finished, out, symlinks=True)
    brief = "hidden: 8, epochs: 2, pretraining_epochs: 1, steps_per_epoch: 5"
    job = experiment(
        out,
        f"policies.motor={{type: bc-rnn, pretrain: true, {brief}}}",
        "compute.workers=0",
    )
    assert not job.demonstrations.missing() and not job.collection.missing()
    rows = job.evaluations["motor"].trials()
    for kind, checkpoints in (("checkpoint", ["0", "1"]), ("fresh", ["1"])):
        assert list(rows[kind]["1"]) == checkpoints
        for (trial,) in rows[kind]["1"].values():
            assert trial["steps"] == 40 or trial["success"]


def assert_same(first: Any, second: Any) -> None:
    if isinstance(first, dict):
        assert set(first) == set(second)
        for key in set(first) - {"timing"}:
            assert_same(first[key], second[key])
    elif isinstance(first, list):
        assert len(first) == len(second)
        for one, other in zip(first, second, strict=True):
            assert_same(one, other)
    elif isinstance(first, np.ndarray):
        np.testing.assert_array_equal(first, second)
    else:
        assert first == second


@pytest.mark.slow
def test_two_workers_make_the_same_data_and_results_as_none(finished: Path, tmp_path: Path) -> None:
    variant = "variants.greedy={parser: {type: greedy}}"
    completed = prime(out=tmp_path, settings=[*TINY, "compute.workers=2", variant])
    assert completed.returncode == 0, completed.stderr
    first, second = experiment(finished), experiment(tmp_path)
    for name in ("demonstrations", "collection", "parsing", "replay", "evaluation.prime"):
        assert_same(first.stages[name].results(), second.stages[name].results())
    found = results(tmp_path)
    assert found["results"] == results(finished)["results"]
    assert list(found["variants"]["greedy"]) == ["parsing", "replay", "evaluation.prime"]
    assert found["timing"]["greedy/evaluation.prime"]["items"] > 0
    trials = json.loads((tmp_path / "lift-quick" / "trials-greedy.prime.json").read_text())
    assert [len(rows) for rows in trials["checkpoint"]["1"].values()] == [1, 1]


@pytest.mark.slow
def test_after_a_kill_the_run_goes_on_with_what_is_missing(tmp_path: Path) -> None:
    settings = [*TINY, "collection.episodes=12"]
    job = Experiment(read_experiment(QUICK, settings), tmp_path / "lift-quick")
    running = subprocess.Popen(
        command("--until", "collection", out=tmp_path, settings=settings),
        cwd=ROOT,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    deadline = time.monotonic() + 300
    while time.monotonic() < deadline and len(job.collection.missing()) > 9:
        time.sleep(0.2)
    running.send_signal(signal.SIGKILL)
    running.wait()
    kept = set(job.collection.items()) - set(job.collection.missing())
    assert 3 <= len(kept) < 12
    before = {item: next(iter(job.collection.compute([item]))) for item in kept}
    completed = prime("--until", "collection", out=tmp_path, settings=settings)
    assert completed.returncode == 0, completed.stderr
    assert not job.collection.missing()
    after = {item: next(iter(job.collection.compute([item]))) for item in kept}
    for item in kept:  # the time it took tells that it was not done again
        assert before[item]["timing"] == after[item]["timing"]


@pytest.mark.slow
@pytest.mark.campaign
def test_after_a_kill_a_training_goes_on_after_its_last_epoch(
    finished: Path, tmp_path: Path
) -> None:
    longer = ["idm.classifier_epochs=40", "idm.steps_per_epoch=60"]
    settings = [*TINY, *longer]
    for out in ("killed", "whole"):
        shutil.copytree(finished, tmp_path / out, symlinks=True)
    idm = experiment(tmp_path / "killed", *longer).idm
    arguments = command("--until", "idm", out=tmp_path / "killed", settings=settings)
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}

    def epoch(before: int = 0) -> int:
        """Return the last finished epoch, or the one before while the file is being written."""
        try:
            return int((idm.folder / "progress-model.txt").read_text().split()[0])
        except (OSError, IndexError):
            return before

    running = subprocess.Popen(arguments, cwd=ROOT, **quiet)
    deadline = time.monotonic() + 240
    while time.monotonic() < deadline and epoch() < 12:
        time.sleep(0.02)
    running.send_signal(signal.SIGKILL)
    running.wait()
    time.sleep(3)  # the worker stops after the epoch in hand
    before = epoch()
    assert 12 <= before < 40
    running = subprocess.Popen(arguments, cwd=ROOT, **quiet)
    seen = {before}
    while running.poll() is None:
        seen.add(epoch(before))
        time.sleep(0.02)
    assert running.returncode == 0
    assert min(seen) == before
    assert max(seen) > before

    completed = prime("--until", "idm", out=tmp_path / "whole", settings=settings)
    assert completed.returncode == 0, completed.stderr
    files = sorted((idm.folder / "model").glob("*.safetensors"))
    assert files
    for file in files:
        whole = experiment(tmp_path / "whole", *longer).idm.folder / "model" / file.name
        assert file.read_bytes() == whole.read_bytes()


def test_a_mistake_is_told_without_a_traceback(tmp_path: Path) -> None:
    completed = prime(out=tmp_path, settings=["parser.alhpa=1"])
    assert completed.returncode == 1
    assert "unknown key 'alhpa': did you mean 'alpha'?" in completed.stderr
    assert "Traceback" not in completed.stderr
    completed = prime("--until", "idem", out=tmp_path)
    assert "--until idem: there is no such stage. There are: demonstrations" in completed.stderr


def test_demonstrations_from_elsewhere_are_parsed_with_a_run(
    finished: Path, tmp_path: Path
) -> None:
    source = tmp_path / "mine"
    shutil.copytree(os.path.realpath(finished / "lift-quick" / "dataset"), source)
    parse = [sys.executable, "-c", "from prime_core.cli import main; main()", "parse"]
    options = [str(source), "--run", str(finished / "lift-quick")]
    completed = subprocess.run([*parse, *options], capture_output=True, text=True, cwd=ROOT)
    assert completed.returncode == 0, completed.stderr
    parsed = read_dataset(tmp_path / "mine-parsed")
    again = read_dataset(finished / "lift-quick" / "dataset")
    assert parsed.segments is not None
    assert again.segments is not None
    for one, other in zip(parsed.segments, again.segments, strict=True):
        assert [(s.start, s.end) for s in one] == [(s.start, s.end) for s in other]
    refused = subprocess.run([*parse, *options], capture_output=True, text=True, cwd=ROOT)
    assert refused.returncode == 1
    assert "is there already: choose another folder with --out" in refused.stderr
