"""The command line: ``prime``.

Commands import what they need when they are called, so that ``prime --help`` answers at once.
"""

import functools
import os
import sys
import traceback
from collections.abc import Callable
from pathlib import Path
from typing import Any, TextIO

import typer

from prime_core.cli.annotate import annotate
from prime_core.cli.compare import compare
from prime_core.cli.convert import convert
from prime_core.cli.export import export
from prime_core.cli.export_policy import export_policy
from prime_core.cli.learn_primitives import learn_primitives
from prime_core.cli.options import OWN_COMMANDS
from prime_core.cli.output import answering, given_back, output_apart, tell
from prime_core.cli.parse import parse
from prime_core.cli.plugins import plugins
from prime_core.cli.run import run
from prime_core.cli.show import show
from prime_core.cli.validate import validate
from prime_core.errors import PrimeError
from prime_core.experiments.run_folder.place import place_error

INTERRUPTED = 130
KEPT = dict.fromkeys(
    (run, convert, learn_primitives),
    "; what is finished is kept, and the same command goes on from there",
)
"""What is told of commands that are interrupted."""


def build_app(stream: TextIO) -> typer.Typer:
    """Return the command line, plugins' commands included.

    Args:
        stream: Standard output, as `output_apart` gave it.
    """
    app = _empty_app()
    for command in (
        run,
        show,
        validate,
        parse,
        annotate,
        convert,
        learn_primitives,
        export,
        export_policy,
        compare,
        plugins,
    ):
        app.command()(_of_prime(command))
    from prime_core.registry.loading import load_plugins

    for name, claim in load_plugins().commands(OWN_COMMANDS).items():
        try:
            command = _of_pack(claim.what, stream)
            alone = _empty_app()
            alone.command(name)(command)
            typer.main.get_command(alone)  # else a function that is no command fails all of them
        except Exception as problem:  # a stranger's code
            claim.plugin.fail(problem)
        else:
            app.command(name)(command)
    return app


def _empty_app() -> typer.Typer:
    return typer.Typer(
        name="prime",
        help="Robot imitation learning with behaviour primitives.",
        no_args_is_help=True,
        add_completion=False,
        pretty_exceptions_enable=False,
        rich_markup_mode=None,  # rich renders Markdown: loading that takes longer than all else
    )


def _of_prime(command: Callable[..., None]) -> Callable[..., None]:
    """Keep what packs print out of a command's answer, and packs from ending it."""

    @functools.wraps(command)
    def answer(*arguments: Any, **options: Any) -> None:
        # Prime draws into files: what the user has may want a screen, or be no backend at all.
        os.environ["MPLBACKEND"] = "agg"
        try:
            with answering():
                command(*arguments, **options)
        except KeyboardInterrupt:
            tell(f"interrupted{KEPT.get(command, '')}")
            raise typer.Exit(INTERRUPTED) from None
        except SystemExit as end:  # none of prime's commands ends so
            place = traceback.extract_tb(end.__traceback__)[-1]
            raise PrimeError(
                f"{place.filename}, line {place.lineno}: calls sys.exit({end.code!r}), which ends "
                "prime: it must raise an error"
            ) from None

    return answer


def _of_pack(command: Callable[..., Any], stream: TextIO) -> Callable[..., Any]:
    """Let a command of a pack print what it likes."""

    @functools.wraps(command)
    def answer(*arguments: Any, **options: Any) -> Any:
        with given_back(stream):
            return command(*arguments, **options)

    return answer


def _of_place(error: OSError) -> PrimeError | None:
    try:
        os.getcwd()
    except FileNotFoundError:
        return PrimeError("the folder that prime was started in is gone: start it in another one")
    return place_error(error, Path()) if error.filename else None


def main() -> None:
    """Run the command line; what a user can mend is told without a traceback."""
    with output_apart() as stream:
        try:
            build_app(stream)()
        except PrimeError as error:
            tell(str(error))
            sys.exit(1)
        except OSError as error:
            tell(str(_of_place(error) or error))
            sys.exit(1)
        except KeyboardInterrupt:
            tell("interrupted")
            sys.exit(INTERRUPTED)
