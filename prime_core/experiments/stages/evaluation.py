"""The stage that evaluates a policy's checkpoints."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import ClassVar

from prime_core.configuration import ConfigDump
from prime_core.contracts.policy import MotorPolicy
from prime_core.execution.settings import EvaluationConfig
from prime_core.execution.trial import Trial, run_trial
from prime_core.experiments.stages.motor_policy import AnyPolicyTraining
from prime_core.experiments.stages.stage import Result, Stage
from prime_core.seeds import Stream, generator_of

STREAMS = {"checkpoint": Stream.CHECKPOINT_TRIALS, "fresh": Stream.FRESH_TRIALS}
"""Trials of all checkpoints, and fresh trials of the last one, never share a first state."""

BATCH = 10
"""Trials of an item: one loading of a checkpoint serves them all."""


class Evaluation(Stage):
    """Trials of a policy: ``KIND/SEED/CHECKPOINT/BATCH`` an item, each trial recorded."""

    title: ClassVar[str] = "evaluation"
    unit: ClassVar[str] = "batches of trials"

    training: AnyPolicyTraining
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
        loaded: tuple[Path, MotorPolicy] | None = None
        for item in items:
            kind, seed, number, batch = item.split("/")
            total = config.trials if kind == "checkpoint" else config.fresh_trials
            first = int(batch) * BATCH
            path = self.training.checkpoints(seed)[int(number)]
            if loaded is None or loaded[0] != path:
                loaded = path, self.training.load(path, world, config.runner)
            trials = []
            for number_of_trial in range(first, min(first + BATCH, total)):
                # All checkpoints of a seed meet the same first states, other seeds other ones.
                generator = generator_of(STREAMS[kind], config.seed, int(seed), number_of_trial)
                trial = run_trial(
                    world.environment, world.primitives, loaded[1], generator, config.maximum_steps
                )
                trials.append(_record(trial))
            yield {"trials": trials}

    def trials(self) -> dict[str, dict[str, dict[str, list[Result]]]]:
        """Return all trials by kind, seed and checkpoint."""
        found: dict[str, dict[str, dict[str, list[Result]]]] = {}
        for item, result in zip(self.items(), self.results(), strict=True):
            kind, seed, number, _ = item.split("/")
            rows = found.setdefault(kind, {}).setdefault(seed, {}).setdefault(number, [])
            rows.extend(result["trials"])
        return found


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
