"""``prime parse``."""

from pathlib import Path
from typing import Annotated

import typer

from prime_core.cli.options import expanded
from prime_core.cli.output import console


def parse(
    dataset: Annotated[
        Path,
        typer.Argument(help="A LeRobot data set, or a robosuite HDF5 file.", callback=expanded),
    ],
    run: Annotated[
        Path,
        typer.Option("--run", help="The folder of a run with a trained IDM.", callback=expanded),
    ],
    out: Annotated[
        Path | None,
        typer.Option(
            "--out", help="Where to write; beside the data set if not given.", callback=expanded
        ),
    ] = None,
) -> None:
    """Parse demonstrations from elsewhere with the IDM of a run."""
    from prime_core.experiments.parse_dataset import beside, parse_foreign
    from prime_core.experiments.results.summaries import parsing_summary

    screen = console()
    target = out or beside(dataset)
    summary = parsing_summary(parse_foreign(dataset, run, target))
    screen.print(
        f"{summary['demonstrations']} demonstrations, {summary['mean_primitives']:.1f} primitives "
        f"for {summary['mean_steps']:.0f} steps, {summary['other_share']:.1%} of the steps "
        f"unexplained.\nWritten to {target}",
        highlight=False,
        markup=False,
    )
    for index, names in enumerate(summary["sequences"]):
        screen.print(f"  {index}: {' '.join(names)}", highlight=False, markup=False)
