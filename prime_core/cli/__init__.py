"""The command line: ``prime``.

Commands import what they need when they are called, so that ``prime --help`` answers at once.
"""

import sys
from pathlib import Path

import typer

from prime_core.cli.compare import compare
from prime_core.cli.parse import parse
from prime_core.cli.plugins import plugins
from prime_core.cli.run import run
from prime_core.cli.show import show
from prime_core.cli.validate import validate
from prime_core.errors import PrimeError
from prime_core.experiments.run_folder.place import place_error

INTERRUPTED = 130


def build_app() -> typer.Typer:
    """Return the command line, plugins' commands included."""
    app = typer.Typer(
        name="prime",
        help="Robot imitation learning with behaviour primitives.",
        no_args_is_help=True,
        add_completion=False,
        pretty_exceptions_enable=False,
        rich_markup_mode=None,  # rich renders Markdown: loading that takes longer than all else
    )
    for command in (run, show, validate, parse, compare, plugins):
        app.command()(command)
    from prime_core.registry.loading import load_plugins

    for name, function in load_plugins().commands.items():
        app.command(name)(function)
    return app


def main() -> None:
    """Run the command line; what a user can mend is told without a traceback."""
    try:
        build_app()()
    except PrimeError as error:
        print(f"prime: {error}", file=sys.stderr)
        sys.exit(1)
    except OSError as error:
        told = place_error(error, Path())
        if told is None:
            raise
        print(f"prime: {told}", file=sys.stderr)
        sys.exit(1)
    except KeyboardInterrupt:
        print("prime: interrupted; what is finished is kept", file=sys.stderr)
        sys.exit(INTERRUPTED)
