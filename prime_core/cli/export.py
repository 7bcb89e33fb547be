"""``prime export``."""

from pathlib import Path
from typing import Annotated

import typer

from prime_core.cli.options import SetOption, expanded
from prime_core.cli.output import console


def export(
    run: Annotated[
        Path, typer.Argument(help="The folder of a run with demonstrations.", callback=expanded)
    ],
    to: Annotated[str, typer.Option("--to", metavar="FORMAT", help="Such as robomimic.")],
    out: Annotated[
        Path | None,
        typer.Option(
            "--out", help="Where to write; beside the run if not given.", callback=expanded
        ),
    ] = None,
    set_: SetOption = None,
) -> None:
    """Write the demonstrations of a run in a format of other programs."""
    from rich.progress import track

    from prime_core.experiments.exporting.demonstrations import export_run, read_exporter

    screen = console()
    exporter = read_exporter(to, set_ or ())
    done = export_run(
        run,
        exporter,
        out,
        lambda each, count: track(each, "export", total=count, console=screen, transient=True),
    )
    screen.print(
        f"{done.demonstrations} demonstrations, {done.actions} motor actions.\n"
        f"Written to {done.target}",
        highlight=False,
        markup=False,
        soft_wrap=True,
    )
