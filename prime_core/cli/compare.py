"""``prime compare``."""

from pathlib import Path
from typing import Annotated

import typer

from prime_core.cli.options import expanded
from prime_core.cli.output import console, say


def compare(
    results: Annotated[
        list[Path],
        typer.Argument(help="Folders of runs, or their results files.", callback=expanded),
    ],
    markdown: Annotated[bool, typer.Option("--markdown", help="Print it as Markdown.")] = False,
) -> None:
    """Put the results of several experiments side by side."""
    from prime_core.experiments.results import comparison

    rows = comparison.comparison_rows([comparison.read_results(path) for path in results])
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
