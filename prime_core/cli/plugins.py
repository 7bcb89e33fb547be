"""``prime plugins``."""

from typing import Annotated

import typer

from prime_core.cli.options import OWN_COMMANDS
from prime_core.cli.output import console


def plugins(
    traceback: Annotated[
        bool, typer.Option("--traceback", help="Show why a plugin could not be loaded in full.")
    ] = False,
) -> None:
    """List plugins, what each registers, and what could not be loaded and why."""
    from rich.table import Table
    from rich.text import Text

    from prime_core.registry.loading import load_plugins

    screen = console()
    found = load_plugins()
    registry, commands = found.registry, found.commands(OWN_COMMANDS)
    table = Table()
    for column in ("distribution", "version", "registers"):
        table.add_column(column, overflow="fold")
    for plugin in found.found:
        names = {
            kind: [item.name for item in registry.registrations(kind) if item.plugin is plugin]
            for kind in registry.kinds
        }
        names["command"] = [name for name, item in commands.items() if item.plugin is plugin]
        what = Text("\n".join(f"{kind}: {', '.join(names[kind])}" for kind in names if names[kind]))
        if plugin.error:
            what = Text.assemble(("could not be loaded: ", "red"), plugin.error)
        # Text, for what packs say may look like rich's markup.
        table.add_row(Text(plugin.distribution), Text(plugin.version), what)
    screen.print(table)
    for plugin in found.found:
        if plugin.error and traceback:
            screen.print(Text.assemble((plugin.name, "red"), "\n", plugin.traceback))
