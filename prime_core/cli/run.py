"""``prime run``."""

import sys

from prime_core.cli.options import RUNS, ExperimentArgument, OutOption, SetOption, UntilOption


def run(
    experiment: ExperimentArgument,
    set_: SetOption = None,
    until: UntilOption = None,
    out: OutOption = RUNS,
) -> None:
    """Run an experiment: what is done is kept, what depends on a change is done again."""
    from rich.console import Console

    from prime_core.experiments.experiment import Experiment
    from prime_core.experiments.reading import read_experiment
    from prime_core.experiments.results.gathering import write_results
    from prime_core.experiments.results.links import link_outputs
    from prime_core.experiments.results.table import summary_table
    from prime_core.experiments.running import run_experiment

    console = Console()
    config = read_experiment(experiment, set_ or ())
    job = Experiment(config, out / config.name)
    run_experiment(job, console, until)
    command = ["prime", *sys.argv[1:]]
    console.print(summary_table(write_results(job, command)))
    for path in link_outputs(job):
        console.print(f"  {path}", highlight=False)
