"""What is reported of each kind of stage."""

import itertools
from collections.abc import Sequence
from functools import singledispatch
from typing import Any

import numpy as np

from prime_core.contracts.demonstration import ParsedDemonstration
from prime_core.experiments.results.rates import mean_of_best, wilson_interval
from prime_core.experiments.run_folder.seal import BESIDE, TIMING
from prime_core.experiments.stages.collection import Collection
from prime_core.experiments.stages.demonstrations import LEFT_OUT, Demonstrations
from prime_core.experiments.stages.evaluation import Evaluation
from prime_core.experiments.stages.idm import IdmTraining
from prime_core.experiments.stages.images import ImageStage
from prime_core.experiments.stages.parsing import Parsing
from prime_core.experiments.stages.perception import PerceptionTraining
from prime_core.experiments.stages.replay import Replaying
from prime_core.experiments.stages.stage import Result, Stage

Summary = dict[str, Any]


@singledispatch
def summarise(stage: Stage) -> Summary | None:
    """Return the figures of a stage that is done, or None where there is nothing to report."""
    return None


@summarise.register
def _(stage: Collection) -> Summary:
    """Return how much was collected, and which draws passed the filter."""
    shards = stage.compute(stage.items())
    names: list[str] = []
    counts = np.zeros((1, 2, 3), dtype=np.int64)
    for shard in shards:
        names, counts = list(shard["primitives"]), counts + np.asarray(shard["draws"])
    transitions, rollouts = 0, np.zeros(len(names), dtype=np.int64)
    for episode in stage.episodes():
        transitions += len(episode.state) - 1
        rollouts += np.bincount(episode.rollouts[:, 2], minlength=len(names))
    draws: dict[str, Any] = {}
    for index, name in enumerate(names):
        rows = {"uniform": counts[index, 0], "prior": counts[index, 1]}
        draws[name] = {
            source: {
                "drawn": int(drawn),
                "reachable": int(tried),
                "succeeded": int(passed),
                "share": round(float(passed / drawn), 4) if drawn else None,
            }
            for source, (drawn, tried, passed) in rows.items()
        }
    return {
        "transitions": transitions,
        "rollouts": {name: int(count) for name, count in zip(names, rollouts, strict=True)},
        "draws": draws,
    }


@summarise.register
def _(stage: ImageStage) -> Summary:
    """Return how many images there are, how large, and how fast they were made and written."""
    results = [each for each in stage.results() if "images" in each]
    images = sum(each["images"] for each in results)
    seconds = sum(each[TIMING]["seconds"] for each in results)
    return {
        "images": images,
        "bytes_per_image": round(sum(each["bytes"] for each in results) / max(images, 1)),
        "images_per_process_second": round(images / seconds, 1),
    }


@summarise.register
def _(stage: PerceptionTraining) -> Summary:
    """Return how many frames it was taught on, and its held-out errors."""
    return {name: value for name, value in stage.results()[0].items() if name not in BESIDE}


@summarise.register
def _(stage: IdmTraining) -> Summary:
    """Return the held-out accuracy and errors."""
    return {name: value for name, value in stage.results()[0].items() if name not in BESIDE}


@summarise.register
def _(stage: Demonstrations) -> Summary:
    """Return how many there are, and which of them cannot be used and why."""
    left_out = stage.left_out()
    return {"demonstrations": len(stage.items()) - len(left_out), "left_out": left_out}


@summarise.register
def _(stage: Parsing) -> Summary:
    """Return how long the sequences are, and what is left to `other`."""
    return parsing_summary([*stage.load().values()])


def parsing_summary(parsed: Sequence[ParsedDemonstration]) -> Summary:
    """Return how long primitive sequences are, and what is left to `other`."""
    steps = [item.demonstration.steps for item in parsed]
    return {
        "demonstrations": len(parsed),
        "mean_steps": float(np.mean(steps)),
        "mean_primitives": float(np.mean([item.primitives for item in parsed])),
        "other_share": float(sum(item.other_steps for item in parsed) / max(sum(steps), 1)),
        "sequences": [[segment.call.primitive for segment in item.segments] for item in parsed],
    }


@summarise.register
def _(stage: Replaying) -> Summary:
    """Return success rates and steps."""
    pairs = zip(stage.items(), stage.results(), strict=True)
    results = {int(item): result for item, result in pairs if LEFT_OUT not in result}
    return {
        name: {
            "success": float(np.mean([item[name]["success"] for item in results.values()])),
            "mean_steps": float(np.mean([item[name]["steps"] for item in results.values()])),
            "failed": [number for number, one in results.items() if not one[name]["success"]],
        }
        for name in ("with_other", "without_other")
    }


@summarise.register
def _(stage: Evaluation) -> Summary:
    """Return success rates as the paper reports them, and of the fresh trials."""
    config, trials = stage.config, stage.trials()
    rates = {
        seed: [_rate(rows) for rows in numbered.values()]
        for seed, numbered in trials["checkpoint"].items()
    }
    best = {seed: mean_of_best(values, config.top_checkpoints) for seed, values in rates.items()}
    summary: Summary = {
        "runner": stage.settings.get("runner"),  # none where a policy makes no calls
        "success": {
            "mean": float(np.mean(list(best.values()))),
            "standard_deviation": float(np.std(list(best.values()))),
            "seeds": best,
            "checkpoints": rates,
        },
    }
    fresh = {
        seed: list(itertools.chain.from_iterable(numbered.values()))
        for seed, numbered in trials.get("fresh", {}).items()
    }
    if fresh:
        rows = list(itertools.chain.from_iterable(fresh.values()))
        summary["fresh"] = {
            "trials": len(rows),
            "mean": _rate(rows),
            "interval_95": list(wilson_interval(sum(r["success"] for r in rows), len(rows))),
            "seeds": {seed: _rate(values) for seed, values in fresh.items()},
            "mean_steps": float(np.mean([row["steps"] for row in rows])),
        }
    return summary


def _rate(trials: Sequence[Result]) -> float:
    return float(np.mean([trial["success"] for trial in trials]))
