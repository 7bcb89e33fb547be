"""Shows the results of an experiment as a table."""

from collections.abc import Mapping
from typing import Any

from rich.table import Table

from prime_core.experiments.experiment import Experiment
from prime_core.experiments.other_code import describe, other_code_in
from prime_core.experiments.results.figures import figures_of


def summary_table(results: dict[str, Any]) -> Table:
    """Return the figures that a reader looks for first.

    Args:
        results: What ``results.json`` holds.
    """
    table = Table(title=results["name"], title_justify="left")
    table.add_column("what")
    table.add_column("result", justify="right")
    for what, figure in figures_of(results).items():
        table.add_row(what, figure)
    return table


def stage_table(experiment: Experiment, trainings: Mapping[str, str]) -> Table:
    """Return which stages are done, and where they keep what they made.

    Args:
        experiment: Whose stages.
        trainings: What trainings of policies cost, as far as it is known; see `trainings_of`.
    """
    table = Table(title="stages", title_justify="left")
    table.add_column("stage")
    table.add_column("done", justify="right")
    table.add_column("where", overflow="fold")
    other = other_code_in(experiment)
    if other:
        table.add_column("made by other code", overflow="fold")
    for name, stage in experiment.stages.items():
        total, missing = len(stage.items()), len(stage.missing())
        mark = "[green]✓[/] " if not missing else ""
        where = stage.folder.relative_to(experiment.folder)
        done = [f"{mark}{total - missing}/{total} {stage.unit}", trainings.get(name, "")]
        cells = [name, "\n".join(filter(None, done)), str(where)]
        table.add_row(*cells, *([describe(other.get(name, []))] if other else []))
    return table
