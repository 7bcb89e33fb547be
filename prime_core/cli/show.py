"""``prime show``."""

from prime_core.cli.options import RUNS, ExperimentArgument, OutOption, SetOption
from prime_core.cli.output import console


def show(experiment: ExperimentArgument, set_: SetOption = None, out: OutOption = RUNS) -> None:
    """Show an experiment with all defaults, which of its stages are done, and where."""
    from rich.syntax import Syntax

    from prime_core.experiments.experiment import Experiment
    from prime_core.experiments.reading import dump_experiment, read_experiment
    from prime_core.experiments.results.comparison import whole_results
    from prime_core.experiments.results.figures import trainings_of
    from prime_core.experiments.results.table import stage_table
    from prime_core.experiments.running import holds_others

    screen = console()
    config = read_experiment(experiment, set_ or ())
    screen.print(Syntax(dump_experiment(config), "yaml", background_color="default"))
    job = Experiment(config, out / config.name)
    screen.print(f"in {job.folder}:", highlight=False, markup=False)
    others = holds_others(job)
    trainings = {} if others else trainings_of(whole_results(job.folder))
    screen.print(stage_table(job, trainings))
    if others:
        screen.print(
            f"The results in {job.folder} are those of other settings, data or code: 'prime run' "
            "sets them aside.",
            highlight=False,
            markup=False,
            soft_wrap=True,
        )
