"""How often a policy over motor actions solves the task, trained and evaluated alone.

Of an experiment it makes what this policy depends on and no more; with a seed of its own
(``--set seed=101 --set evaluation.seed=5``) nothing is looked at that results are told of.

    python benchmarks/motor_policy.py EXPERIMENT POLICY --out FOLDER [--set KEY=VALUE ...]
"""

import argparse
import time
from pathlib import Path

from prime_core.experiments.experiment import Experiment
from prime_core.experiments.reading import read_experiment

LIMITS = (400, 800)
"""Motor actions within which the task is to be solved: the paper's, and twice that."""


def main() -> None:
    """Print the share of trials that are solved, of the last checkpoint of each seed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("experiment", type=Path)
    parser.add_argument("policy")
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--trials", type=int, default=30)
    parser.add_argument("--set", action="append", default=[], dest="settings")
    options = parser.parse_args()
    evaluation = f"evaluation.fresh_trials={options.trials}", "evaluation.trials=1"
    limit = f"evaluation.maximum_steps={max(LIMITS)}"
    settings = [*options.settings, *evaluation, limit, "compute.workers=0"]
    job = Experiment(read_experiment(options.experiment, settings), options.out)
    stage = job.evaluations[options.policy]
    stage.training.demonstrations.results()
    begin = time.process_time()
    stage.training.results()
    print(f"trained in {(time.process_time() - begin) / 60:.1f} minutes of one core", flush=True)
    for seed, checkpoints in stage.trials()["fresh"].items():
        (trials,) = checkpoints.values()
        for steps in LIMITS:
            solved = sum(trial["success"] and trial["steps"] <= steps for trial in trials)
            print(f"seed {seed}: {solved} of {len(trials)} within {steps} steps", flush=True)


if __name__ == "__main__":
    main()
