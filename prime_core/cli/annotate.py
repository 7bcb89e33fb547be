"""``prime annotate``."""

from pathlib import Path
from typing import Annotated

import typer

from prime_core.cli.options import expanded
from prime_core.cli.parse import say_parsed


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
    found = annotate_dataset(dataset, run, target, columns, strict)
    say_parsed(
        found.parsed,
        found.left_out,
        target,
        lambda item: f"{item.call.primitive} ({item.confidence:.2f})",
    )
