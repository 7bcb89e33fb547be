"""Gathers the results of an experiment into one file."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from prime_core.experiments.experiment import Experiment
from prime_core.experiments.other_code import other_code_in
from prime_core.experiments.results.checksum import with_checksum
from prime_core.experiments.results.comparison import whole_results
from prime_core.experiments.results.costs import parameters_of, timing_of
from prime_core.experiments.results.provenance import commit, versions
from prime_core.experiments.results.summaries import summarise
from prime_core.experiments.stages.evaluation import Evaluation
from prime_core.experiments.stages.stage import Stage
from prime_core.files import new_file
from prime_core.registry.fields import dump_choice

_OF_STAGES = ("results", "variants", "timing", "other_code")
"""Keys of the results that change only where a stage was done."""

_OF_COMMAND = ("command", "commit", "versions", "seeds")
"""Keys that say what the stages were done by."""


def write_results(experiment: Experiment, command: Sequence[str]) -> dict[str, Any]:
    """Write ``results.json`` and, for each evaluated policy, ``trials-NAME.json``.

    Of a variant's policies it is ``trials-VARIANT.NAME.json``; no policy's name holds a dot. Files
    whose content would be the same are left alone; one that is damaged is written anew.

    Args:
        experiment: Whose stages may be done or not.
        command: What was typed.

    Returns:
        What ``results.json`` holds.
    """
    done = {name: stage for name, stage in experiment.stages.items() if not stage.missing()}
    results = {
        "name": experiment.config.name,
        "environment": dump_choice(experiment.config.environment),
        "command": list(command),
        "commit": commit(),
        "versions": versions(),
        "seeds": {
            "experiment": experiment.config.seed,
            "policies": list(experiment.config.seeds),
            "evaluation": experiment.config.evaluation.seed,
        },
        "results": _gather(experiment, experiment.own_stages, "trials-"),
        "variants": {
            name: _gather(variant, experiment.differing(name), f"trials-{name}.")
            for name, variant in experiment.variants.items()
        },
        "timing": {name: timing_of(stage) for name, stage in done.items()},
        "parameters": {
            name: count
            for name, count in ((name, parameters_of(stage)) for name, stage in done.items())
            if count is not None
        },
        "other_code": other_code_in(experiment),
    }
    path = experiment.folder / "results.json"
    before = whole_results(path)
    if before and all(before.get(key, {}) == results[key] for key in _OF_STAGES):
        # Nothing was done: the command that did it stays.
        results |= {key: before[key] for key in _OF_COMMAND if key in before}
    results = with_checksum(results)
    write_if_changed(path, json.dumps(results, indent=1))
    return results


def _gather(experiment: Experiment, stages: dict[str, Stage], trials: str) -> dict[str, Any]:
    """Summarise those of an experiment's stages that are done, and write the policies' trials.

    Args:
        experiment: Or a variant of one.
        stages: Those that count, by their own names.
        trials: What the names of the trials' files begin with.
    """
    found: dict[str, Any] = {}
    for name, stage in stages.items():
        summary = None if stage.missing() else summarise(stage)
        if summary is not None:
            found[name] = summary
        if summary is not None and isinstance(stage, Evaluation):
            text = json.dumps({"runner": stage.settings.get("runner"), **stage.trials()})
            path = experiment.folder / f"{trials}{name.removeprefix('evaluation.')}.json"
            write_if_changed(path, text)
    return found


def write_if_changed(path: Path, text: str) -> None:
    """Write a file, aside first, unless it holds the text already."""
    if path.exists() and path.read_bytes() == text.encode():
        return
    with new_file(path) as aside:
        aside.write_text(text, encoding="utf-8")
