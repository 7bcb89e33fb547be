"""``prime convert``."""

import os
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from prime_core.cli.options import SetOption, expanded
from prime_core.cli.output import console

if TYPE_CHECKING:
    from rich.console import Console

    from prime_core.experiments.conversion.convert import Converted


def convert(
    source: Annotated[
        Path,
        typer.Argument(help="An HDF5 file of robosuite or robomimic.", callback=expanded),
    ],
    target: Annotated[
        Path, typer.Argument(help="Folder of the data set to write.", callback=expanded)
    ],
    camera: Annotated[
        list[str] | None,
        typer.Option("--camera", help="Whose images to render; none if not given. Repeatable."),
    ] = None,
    size: Annotated[
        str, typer.Option("--size", help="Of images: 84, or HEIGHTxWIDTH such as 240x320.")
    ] = "84",
    images: Annotated[
        Literal["png", "video"], typer.Option("--images", help="How images are kept.")
    ] = "png",
    workers: Annotated[
        int | None,
        typer.Option("--workers", min=0, max=1000, help="Processes; one a core if not given."),
    ] = None,
    environment: Annotated[
        str | None,
        typer.Option(
            "--environment",
            metavar="TYPE",
            help="Such as robosuite/lift, where the source does not say.",
        ),
    ] = None,
    set_: SetOption = None,
    strict: Annotated[
        bool, typer.Option("--strict", help="Stop if a demonstration cannot be used.")
    ] = False,
) -> None:
    """Convert recordings into a LeRobot data set, with images rendered from their states."""
    from prime_core.experiments.conversion import convert as conversion
    from prime_core.experiments.conversion.asked import read_pictures

    screen = console()
    pictures = read_pictures(camera or (), size, images)
    found = conversion.convert(
        source,
        target,
        pictures,
        screen,
        environment=environment,
        settings=set_ or (),
        workers=(os.cpu_count() or 1) if workers is None else workers,
        strict=strict,
    )
    _tell(screen, found, target, len(pictures.cameras))


def _tell(screen: "Console", found: "Converted", target: Path, cameras: int) -> None:
    """Print what there is now, with images of so many cameras, and what was left out."""
    new = found.new_frames * cameras
    rate = f"{new} images in {found.seconds:.0f} s, {new / found.seconds:.0f} a second.\n"
    screen.print(
        f"{found.demonstrations} demonstrations, {found.frames} frames, {found.frames * cameras} "
        f"images; {len(found.left_out)} left out.\n{rate if new else ''}Written to {target}",
        highlight=False,
        markup=False,
        soft_wrap=True,
    )
    for number, reason in found.left_out.items():
        screen.print(
            f"  {number} left out: {reason}", highlight=False, markup=False, soft_wrap=True
        )
