"""Where prime's answers go, and where everything else that is printed goes.

Standard output holds what was asked for alone, so that it can be read by another program. Packs and
libraries print what they like; while prime works, that goes to stderr.
"""

import atexit
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stdout
from typing import TYPE_CHECKING, TextIO

if TYPE_CHECKING:
    from rich.console import Console

_MOST_LINES, _LONGEST = 10, 1000
"""Of what is told of an error: files may hold any amount of what should not be there."""

_answers: TextIO | None = None


def say(text: str) -> None:
    """Print a line of what was asked for."""
    print(text, file=_answers or sys.stdout)


def console() -> "Console":
    """Return a console that prints what was asked for."""
    from rich.console import Console

    return Console(file=_answers or sys.stdout)


def tell(text: str) -> None:
    """Print what went wrong, without what moves a terminal's cursor and in a few lines."""
    lines = [_readable(line) for line in text.split("\n")]
    more = len(lines) - _MOST_LINES
    if more > 0:
        lines[_MOST_LINES:] = [f"... and {more} more"]
    print("prime: " + "\n".join(lines), file=sys.stderr)


def _readable(line: str) -> str:
    if len(line) > _LONGEST:
        half = _LONGEST // 2
        line = f"{line[:half]} ... {line[-half:]}"
    return "".join(char if char.isprintable() else repr(char)[1:-1] for char in line)


@contextmanager
def answering() -> Iterator[None]:
    """Let `say` and `console` alone write to standard output."""
    global _answers
    before, _answers = _answers, sys.stdout
    try:
        with redirect_stdout(sys.stderr):
            yield
    finally:
        _answers = before


@contextmanager
def output_apart() -> Iterator[TextIO]:
    """Give this process's descriptor 1 to stderr; ``sys.stdout`` goes on to standard output.

    Libraries of C and processes that packs start print to the descriptor. What standard output
    cannot encode, it is given as a question mark.

    Yields:
        What ``sys.stdout`` is now.
    """
    _open_what_is_closed()
    before = sys.stdout
    before.flush()
    descriptor = os.dup(1)
    os.dup2(2, 1)
    # Line by line, for a run takes hours.
    sys.stdout = stream = open(  # noqa: SIM115
        descriptor, "w", encoding=before.encoding, errors="replace", buffering=1
    )
    try:
        yield stream
    finally:
        before.flush()  # what packs wrote to it, past all others
        sys.stdout = before
        _end(stream)
        # It runs before what packs have registered so.
        atexit.register(_last_words_aside)


@contextmanager
def given_back(stream: TextIO) -> Iterator[None]:
    """Give descriptor 1 to standard output again, for a command of a pack.

    Args:
        stream: What `output_apart` gave.
    """
    aside = os.dup(1)
    os.dup2(stream.fileno(), 1)
    try:
        yield
    finally:
        stream.flush()
        os.dup2(aside, 1)
        os.close(aside)


def _open_what_is_closed() -> None:
    for name, descriptor in (("stdout", 1), ("stderr", 2)):
        if getattr(sys, name) is None:
            os.dup2(os.open(os.devnull, os.O_WRONLY), descriptor)
            setattr(sys, name, open(os.devnull, "w", encoding="utf-8"))  # noqa: SIM115


def _end(stream: TextIO) -> None:
    try:
        stream.flush()
    except OSError:  # it was told, and must not be told once more when the stream is closed
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
    os.dup2(stream.fileno(), 1)
    stream.close()


def _last_words_aside() -> None:
    sys.stdout.flush()
    os.dup2(2, 1)
    sys.stdout = sys.stderr
