"""``prime run``."""

import sys
from typing import Annotated

import typer

from prime_core.cli.options import RUNS, ExperimentArgument, OutOption, SetOption, UntilOption
from prime_core.cli.output import console


def run(
    experiment: ExperimentArgument,
    set_: SetOption = None,
    until: UntilOption = None,
    out: OutOption = RUNS,
    keep: Annotated[bool, typer.Option("--keep", help="Keep stages that other code made.")] = False,
    remake: Annotated[
        bool, typer.Option("--remake", help="Make stages anew that other code made.")
    ] = False,
) -> None:
    """Run an experiment: what is done is kept, what depends on a change is done again."""
    from rich.markup import escape

    from prime_core.errors import PrimeError
    from prime_core.experiments.experiment import Experiment
    from prime_core.experiments.other_code import OtherCode, open_experiment
    from prime_core.experiments.reading import read_experiment
    from prime_core.experiments.results.gathering import write_results
    from prime_core.experiments.results.links import link_outputs
    from prime_core.experiments.results.table import summary_table
    from prime_core.experiments.run_folder.lock import alone_in
    from prime_core.experiments.run_folder.place import place_told
    from prime_core.experiments.running import run_experiment

    if keep and remake:
        raise PrimeError("--keep and --remake: say one of them")
    screen = console()
    config = read_experiment(experiment, set_ or ())
    folder = out / config.name
    if until is not None:
        Experiment(config, folder).until(until)  # before anything is written

    def say(text: str) -> None:
        screen.print(f"[yellow]![/] {escape(text)}", highlight=False, soft_wrap=True)

    with place_told(folder), alone_in(folder, say):
        word = OtherCode.KEEP if keep else OtherCode.REMAKE if remake else OtherCode.ASK
        job = open_experiment(config, folder, screen, word)
        run_experiment(job, screen, until)
        results = write_results(job, ["prime", *sys.argv[1:]])
        links = link_outputs(job)
    screen.print(summary_table(results))
    for path in links:
        screen.print(f"  {path}", highlight=False, markup=False)
