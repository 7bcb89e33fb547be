"""``prime parse``."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from prime_core.cli.options import expanded
from prime_core.cli.output import console

if TYPE_CHECKING:
    from prime_core.contracts.demonstration import ParsedDemonstration, Segment


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

    target = out or beside(dataset, "parsed")
    found = parse_foreign(dataset, run, target, strict)
    say_parsed(found.parsed, found.left_out, target, lambda item: item.call.primitive)


def say_parsed(
    parsed: "Mapping[str, ParsedDemonstration]",
    left_out: Mapping[str, str],
    target: Path,
    word: "Callable[[Segment], str]",
) -> None:
    """Print what demonstrations were cut into.

    Args:
        parsed: Demonstrations, by their numbers.
        left_out: Why others cannot be used, by theirs.
        target: Where they were written.
        word: Says what a segment is.
    """
    from prime_core.experiments.results.summaries import parsing_summary

    screen = console()
    summary = parsing_summary([*parsed.values()])
    screen.print(
        f"{summary['demonstrations']} demonstrations, {summary['mean_primitives']:.1f} primitives "
        f"for {summary['mean_steps']:.0f} steps, {summary['other_share']:.1%} of the steps "
        f"unexplained; {len(left_out)} left out.\nWritten to {target}",
        highlight=False,
        markup=False,
        soft_wrap=True,
    )
    for number, item in parsed.items():
        words = " ".join(map(word, item.segments))
        screen.print(f"  {number}: {words}", highlight=False, markup=False)
    for number, reason in left_out.items():
        screen.print(
            f"  {number} left out: {reason}", highlight=False, markup=False, soft_wrap=True
        )
