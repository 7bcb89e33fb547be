"""The stage that evaluates a policy's checkpoints."""

import itertools
from collections.abc import Iterator, Sequence
from typing import Any, ClassVar

import numpy as np

from prime_core.configuration import ConfigDump
from prime_core.evaluation import EvaluationConfig, Trial, run_trial
from prime_core.policy import Policy
from prime_core.stages.policy import PolicyTraining
from prime_core.stages.stage import Result, Stage
from prime_core.stages.world import World
from prime_core.statistics import mean_of_best, wilson_interval

_STREAMS = {"checkpoint": 4, "fresh": 5}
"""Trials of all checkpoints, and fresh trials of the last one, never share a first state."""

BATCH = 10
"""Trials of an item: one loading of a checkpoint serves them all."""


class Evaluation(Stage):
    """Trials of a policy: ``KIND/SEED/CHECKPOINT/BATCH`` an item, each trial recorded."""

    title: ClassVar[str] = "evaluation"
    unit: ClassVar[str] = "batches of trials"

    training: PolicyTraining
    settings: ConfigDump

    @property
    def config(self) -> EvaluationConfig:
        """How many trials."""
        return EvaluationConfig.model_validate(self.settings)

    def items(self) -> list[str]:
        """Return the batches of trials."""
        config, items = self.config, []
        checkpoints = self.training.config.count_checkpoints()
        for seed in self.training.items():
            for number in range(checkpoints):
                batches = -(-config.trials // BATCH)
                items += [f"checkpoint/{seed}/{number}/{batch}" for batch in range(batches)]
            batches = -(-config.fresh_trials // BATCH)
            items += [f"fresh/{seed}/{checkpoints - 1}/{batch}" for batch in range(batches)]
        return items

    def process(self, items: Sequence[str]) -> Iterator[Result]:
        """Run trials."""
        config, world = self.config, self.training.build_world()
        loaded: tuple[str, Policy] | None = None
        for item in items:
            kind, seed, number, batch = item.split("/")
            total = config.trials if kind == "checkpoint" else config.fresh_trials
            first = int(batch) * BATCH
            path = self.training.checkpoints(seed)[int(number)]
            if loaded is None or loaded[0] != str(path):
                policy = self.training.config.load(path, world.description, world.space)
                loaded = str(path), policy
            trials = []
            for trial in range(first, min(first + BATCH, total)):
                # All checkpoints of a seed meet the same first states, other seeds other ones.
                generator = np.random.default_rng([config.seed, _STREAMS[kind], int(seed), trial])
                trials.append(_record(self._run(world, loaded[1], generator)))
            yield {"trials": trials}

    def _run(self, world: World, policy: Policy, generator: np.random.Generator) -> Trial:
        return run_trial(
            world.environment, world.primitives, policy, generator, self.config.maximum_steps
        )

    def trials(self) -> dict[str, dict[str, dict[str, list[Result]]]]:
        """Return all trials by kind, seed and checkpoint."""
        found: dict[str, dict[str, dict[str, list[Result]]]] = {}
        for item, result in zip(self.items(), self.results(), strict=True):
            kind, seed, number, _ = item.split("/")
            rows = found.setdefault(kind, {}).setdefault(seed, {}).setdefault(number, [])
            rows.extend(result["trials"])
        return found

    def summary(self) -> dict[str, Any]:
        """Return success rates as the paper reports them, and of the fresh trials."""
        config, trials = self.config, self.trials()
        rates = {
            seed: [_rate(rows) for rows in numbered.values()]
            for seed, numbered in trials["checkpoint"].items()
        }
        best = {
            seed: mean_of_best(values, config.top_checkpoints) for seed, values in rates.items()
        }
        summary: dict[str, Any] = {
            "success": {
                "mean": float(np.mean(list(best.values()))),
                "standard_deviation": float(np.std(list(best.values()))),
                "seeds": best,
                "checkpoints": rates,
            }
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


def _record(trial: Trial) -> Result:
    return {
        "success": trial.success,
        "steps": trial.steps,
        "calls": [
            {
                "primitive": call.primitive,
                "parameters": [float(value) for value in call.parameters],
                "completed": completed,
            }
            for call, completed in zip(trial.calls, trial.completed, strict=True)
        ],
    }
