"""``prime run``."""

import sys

from prime_core.cli.options import RUNS, ExperimentArgument, OutOption, SetOption, UntilOption
from prime_core.cli.output import console


def run(
    experiment: ExperimentArgument,
    set_: SetOption = None,
    until: UntilOption = None,
    out: OutOption = RUNS,
) -> None:
    """Run an experiment: what is done is kept, what depends on a change is done again."""
    from prime_core.experiments.experiment import Experiment
    from prime_core.experiments.reading import read_experiment
    from prime_core.experiments.results.gathering import write_results
    from prime_core.experiments.results.links import link_outputs
    from prime_core.experiments.results.table import summary_table
    from prime_core.experiments.running import run_experiment

    screen = console()
    config = read_experiment(experiment, set_ or ())
    job = Experiment(config, out / config.name)
    run_experiment(job, screen, until)
    command = ["prime", *sys.argv[1:]]
    screen.print(summary_table(write_results(job, command)))
    for path in link_outputs(job):
        screen.print(f"  {path}", highlight=False, markup=False)
