"""``prime parse``."""

from pathlib import Path
from typing import Annotated

import typer

from prime_core.cli.options import expanded
from prime_core.cli.output import console


def parse(
    dataset: Annotated[
        Path,
        typer.Argument(
            help="A LeRobot data set, or an HDF5 file of robosuite or robomimic.",
            callback=expanded,
        ),
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
    strict: Annotated[
        bool, typer.Option("--strict", help="Stop if a demonstration cannot be used.")
    ] = False,
) -> None:
    """Parse demonstrations from elsewhere with the IDM of a run."""
    from prime_core.experiments.parse_dataset import beside, parse_foreign
    from prime_core.experiments.results.summaries import parsing_summary

    screen = console()
    target = out or beside(dataset, "parsed")
    found = parse_foreign(dataset, run, target, strict)
    summary = parsing_summary([*found.parsed.values()])
    screen.print(
        f"{summary['demonstrations']} demonstrations, {summary['mean_primitives']:.1f} primitives "
        f"for {summary['mean_steps']:.0f} steps, {summary['other_share']:.1%} of the steps "
        f"unexplained; {len(found.left_out)} left out.\nWritten to {target}",
        highlight=False,
        markup=False,
        soft_wrap=True,
    )
    for number, names in zip(found.parsed, summary["sequences"], strict=True):
        screen.print(f"  {number}: {' '.join(names)}", highlight=False, markup=False)
    for number, reason in found.left_out.items():
        screen.print(
            f"  {number} left out: {reason}", highlight=False, markup=False, soft_wrap=True
        )
