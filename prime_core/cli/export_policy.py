"""``prime export-policy``."""

from pathlib import Path
from typing import Annotated

import typer

from prime_core.cli.options import expanded
from prime_core.cli.output import say


def export_policy(
    run: Annotated[
        Path,
        typer.Argument(help="The folder of a run with a trained policy.", callback=expanded),
    ],
    out: Annotated[
        Path,
        typer.Option("--out", help="The folder to write; it must not exist.", callback=expanded),
    ],
    policy: Annotated[
        str | None,
        typer.Option(
            "--policy", help="Its name, or VARIANT/NAME; the only one there is if not given."
        ),
    ] = None,
    seed: Annotated[
        int | None,
        typer.Option("--seed", help="Of its training; the first if not given."),
    ] = None,
    checkpoint: Annotated[
        int | None,
        typer.Option("--checkpoint", help="Its number from 0, the oldest; the last if not given."),
    ] = None,
) -> None:
    """Export a trained policy of a run: a folder with all that a robot's loop needs."""
    from prime_core.experiments.exporting import policy as exporting

    choice = exporting.Choice(policy, seed, checkpoint)
    manifest = exporting.export_policy(run, choice, out)
    origin = manifest.origin
    say(
        f"Policy {origin.policy!r} of {origin.run}, seed {origin.seed}, checkpoint "
        f"{origin.checkpoint}, written to {out}"
    )
    if manifest.idm is None:
        say("The run had no trained IDM: the folder holds none.")
