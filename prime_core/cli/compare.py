"""``prime compare``."""

from pathlib import Path
from typing import Annotated

import typer

from prime_core.cli.options import expanded
from prime_core.cli.output import console, say
from prime_core.errors import PrimeError
from prime_core.experiments.results.measured import Against


def compare(
    results: Annotated[
        list[Path],
        typer.Argument(help="Folders of runs, or their results files.", callback=expanded),
    ],
    markdown: Annotated[bool, typer.Option("--markdown", help="Print it as Markdown.")] = False,
    figure: Annotated[
        Path | None,
        typer.Option(
            "--figure",
            metavar="FILE",
            help="Draw the success rates as a bar chart, too: .png, .pdf or .svg.",
            callback=expanded,
        ),
    ] = None,
    against: Annotated[
        Against | None,
        typer.Option("--against", help="Draw lines against this instead of bars."),
    ] = None,
    method: Annotated[
        list[str] | None,
        typer.Option(
            "--method",
            metavar="NAME",
            help="What the figure shows, by the names in its legend and in this order; "
            "everything unless told. Repeatable.",
        ),
    ] = None,
) -> None:
    """Put the results of several experiments side by side."""
    from prime_core.experiments.results import comparison

    if figure is not None:
        from prime_core.experiments.results.chart import check_figure, draw_comparison

        check_figure(figure)
    elif against is not None or method:
        option = "--method" if against is None else "--against"
        raise PrimeError(f"{option}: it says what a figure shows; name the figure with --figure")
    files = [comparison.read_results(path) for path in results]
    rows = comparison.comparison_rows(files)
    if figure is not None:
        draw_comparison(figure, results, files, against=against, methods=method or ())
    if markdown:
        say(comparison.markdown(rows))
        return
    from rich.table import Table
    from rich.text import Text

    table = Table()
    for number, title in enumerate(rows[0]):
        # Text, for names may look like rich's markup.
        table.add_column(Text(title), justify="right" if number else "left", overflow="fold")
    for row in rows[1:]:
        table.add_row(*map(Text, row))
    console().print(table)
