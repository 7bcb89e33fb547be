"""``prime annotate``."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from prime_core.cli.options import expanded
from prime_core.cli.output import console

if TYPE_CHECKING:
    from prime_core.experiments.annotate_dataset import AnnotatedDataset


def annotate(
    dataset: Annotated[
        Path, typer.Argument(help="A LeRobot v3 data set's folder.", callback=expanded)
    ],
    run: Annotated[
        Path,
        typer.Option(
            "--run",
            help="The folder of a run with a trained IDM, or one that export-policy wrote.",
            callback=expanded,
        ),
    ],
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            help="Where to write the annotated copy; beside the data set if not given.",
            callback=expanded,
        ),
    ] = None,
    in_place: Annotated[
        bool, typer.Option("--in-place", help="Annotate the data set itself, no copy.")
    ] = False,
    columns: Annotated[
        Path | None,
        typer.Option(
            "--columns",
            metavar="MAPPING.yaml",
            help="Which columns hold what, of a data set that prime did not record.",
            callback=expanded,
        ),
    ] = None,
    strict: Annotated[
        bool, typer.Option("--strict", help="Stop if an episode cannot be used.")
    ] = False,
) -> None:
    """Write segments, parameters and confidences into a LeRobot data set."""
    from prime_core.experiments.annotate_dataset import annotate_dataset
    from prime_core.experiments.parse_dataset import beside

    if in_place and out is not None:
        raise typer.BadParameter("--in-place writes into the data set itself: leave out --out")
    target = dataset if in_place else out or beside(dataset, "annotated")
    _say(annotate_dataset(dataset, run, target, columns, strict), target)


def _say(found: "AnnotatedDataset", target: Path) -> None:
    """Print what was written."""
    from prime_core.experiments.results.summaries import parsing_summary

    screen = console()
    summary = parsing_summary([*found.parsed.values()])
    screen.print(
        f"{summary['demonstrations']} demonstrations, {summary['mean_primitives']:.1f} primitives "
        f"for {summary['mean_steps']:.0f} steps, {summary['other_share']:.1%} of the steps "
        f"unexplained; {len(found.left_out)} left out.\nWritten to {target}. Primitives with their "
        "confidences:",
        highlight=False,
        markup=False,
        soft_wrap=True,
    )
    for number, parsed in found.parsed.items():
        words = [f"{item.call.primitive} {item.confidence:.2f}" for item in parsed.segments]
        screen.print(f"  {number}: {', '.join(words)}", highlight=False, markup=False)
    for number, reason in found.left_out.items():
        screen.print(
            f"  {number} left out: {reason}", highlight=False, markup=False, soft_wrap=True
        )
