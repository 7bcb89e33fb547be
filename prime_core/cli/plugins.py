"""``prime plugins``."""

from typing import Annotated

import typer


def plugins(
    traceback: Annotated[
        bool, typer.Option("--traceback", help="Show why a plugin could not be loaded in full.")
    ] = False,
) -> None:
    """List plugins, what each registers, and what could not be loaded and why."""
    from rich.console import Console
    from rich.table import Table

    from prime_core.registry.loading import load_plugins

    console = Console()
    found = load_plugins()
    table = Table()
    for column in ("distribution", "version", "registers"):
        table.add_column(column, overflow="fold")
    registry = found.registry
    for plugin in found.found:
        if plugin.error:
            what = f"[red]could not be loaded:[/] {plugin.error}"
        else:
            what = "\n".join(
                f"{kind}: " + ", ".join(names)
                for kind in registry.kinds
                if (
                    names := [
                        entry.name
                        for entry in registry.registrations(kind)
                        if entry.plugin == plugin.name
                    ]
                )
            )
        table.add_row(plugin.distribution, plugin.version, what)
    console.print(table)
    for plugin in found.found:
        if plugin.error and traceback:
            console.print(f"[red]{plugin.name}[/]\n{plugin.traceback}", highlight=False)
