"""Gathers the results of an experiment into one file."""

import importlib.metadata
import json
import platform
import subprocess
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from prime_core.atomic import new_file
from prime_core.experiment import Experiment
from prime_core.running import wall_seconds
from prime_core.stages.stage import TIMING, Result, Stage

_PACKAGES = ("robosuite", "mujoco", "mink", "torch", "lerobot", "numpy", "exca")


def write_results(experiment: Experiment, command: Sequence[str]) -> dict[str, Any]:
    """Write ``results.json`` and, for each evaluated policy, ``trials-NAME.json``.

    Of a variant's policies it is ``trials-VARIANT.NAME.json``; no policy's name holds a dot. Files
    whose content would be the same are left alone.

    Args:
        experiment: Whose stages may be done or not.
        command: What was typed.

    Returns:
        What ``results.json`` holds.
    """
    done = {name: stage for name, stage in experiment.stages.items() if not stage.missing()}
    results = {
        "name": experiment.config.name,
        "command": list(command),
        "commit": _commit(),
        "versions": versions(),
        "seeds": {
            "experiment": experiment.config.seed,
            "policies": list(experiment.config.seeds),
            "evaluation": experiment.config.evaluation.seed,
        },
        "results": _gather(experiment, done, "trials-"),
        "variants": {
            name: _gather(variant, experiment.differing(name), f"trials-{name}.")
            for name, variant in experiment.variants.items()
        },
        "timing": {name: _timing(stage) for name, stage in done.items()},
    }
    path = experiment.folder / "results.json"
    if path.exists():
        before = json.loads(path.read_text(encoding="utf-8"))
        if all(before.get(key, {}) == results[key] for key in ("results", "variants", "timing")):
            return dict(before)  # nothing was done: the command that did it stays
    write_if_changed(path, json.dumps(results, indent=1))
    return results


def _gather(experiment: Experiment, stages: dict[str, Stage], trials: str) -> dict[str, Any]:
    """Summarise those of an experiment's stages that are done, and write the policies' trials.

    Args:
        experiment: Or a variant of one.
        stages: Those that count, by their own names.
        trials: What the names of the trials' files begin with.
    """
    summaries: dict[str, Callable[[], Any]] = {
        "collection": lambda: experiment.collection.summary(_primitive_names(experiment)),
        "idm": lambda: _without_timing(experiment.idm.results()[0]),
        "parsing": experiment.parsing.summary,
        "replay": experiment.replay.summary,
    }
    done = {name for name, stage in stages.items() if not stage.missing()}
    for name, evaluation in experiment.evaluations.items():
        summaries[f"evaluation.{name}"] = evaluation.summary
        if f"evaluation.{name}" in done:
            text = json.dumps(evaluation.trials())
            write_if_changed(experiment.folder / f"{trials}{name}.json", text)
    return {name: make() for name, make in summaries.items() if name in done}


def _primitive_names(experiment: Experiment) -> list[str]:
    return list(experiment.collection.build_world().space.names)


def _without_timing(result: Result) -> Result:
    return {name: value for name, value in result.items() if name != TIMING}


def _timing(stage: Stage) -> dict[str, Any]:
    timings = [item[TIMING] for item in stage.results()]
    return {
        "items": len(timings),
        "wall_seconds": round(wall_seconds(stage), 2),
        "process_seconds": round(sum(item["seconds"] for item in timings), 2),
        "peak_megabytes": round(max(item["peak_bytes"] for item in timings) / 2**20),
    }


def versions() -> dict[str, str]:
    """Return the versions of Python, of prime's distributions and of what they stand on."""
    found = {"python": platform.python_version()}
    ours = [
        item.name
        for item in importlib.metadata.distributions()
        if item.name and item.name.startswith("prime-")
    ]
    for name in sorted({*ours, *_PACKAGES}):
        try:
            found[name] = importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:
            continue
    return found


def _commit() -> str | None:
    """Return the commit of the checkout that runs, with ``+changes`` where it has any."""
    here = Path(__file__).parent
    try:
        head = subprocess.run(
            ["git", "-C", str(here), "rev-parse", "HEAD"],
            capture_output=True,
            text=True,
            check=True,
        )
        changes = subprocess.run(
            ["git", "-C", str(here), "status", "--porcelain", "--untracked-files=no"],
            capture_output=True,
            text=True,
            check=True,
        )
    except (OSError, subprocess.CalledProcessError):
        return None  # an installed wheel has no commit
    return head.stdout.strip() + ("+changes" if changes.stdout.strip() else "")


def write_if_changed(path: Path, text: str) -> None:
    """Write a file, aside first, unless it holds the text already."""
    if path.exists() and path.read_text(encoding="utf-8") == text:
        return
    with new_file(path) as aside:
        aside.write_text(text, encoding="utf-8")
