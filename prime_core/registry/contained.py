"""Runs packs' code while packs are loaded, so that none can spoil it for prime or for another pack.

What it prints goes to stderr. What it changes for the whole process is put back. What it raises is
an error of the pack, be it ``sys.exit()``; only the user's Ctrl-C ends prime. It is no wall: a pack
that wants to do harm, or that ends the process by ``os._exit()``, cannot be stopped.
"""

import builtins
import logging
import os
import signal
import sys
import threading
import warnings
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from typing import Any, TextIO

from prime_core.errors import PluginError

_depth = 0
_stream: TextIO | None = None


def contained[Result](call: Callable[[], Result]) -> Result:
    """Call a pack's function.

    Returns:
        What it returns.

    Raises:
        PluginError: If it would have ended prime.
        KeyboardInterrupt: If the user pressed Ctrl-C.
        Exception: What else it raises.
    """
    with ExitStack() as stack:
        interrupted = stack.enter_context(_interrupts_noted())
        for kept in _KEPT:
            stack.enter_context(kept())
        stack.enter_context(warnings.catch_warnings())
        try:
            result = call()
        except Exception:
            if not interrupted:
                raise
        except BaseException as problem:
            if not interrupted:
                raise PluginError(
                    f"it raises {type(problem).__name__}({_text(problem)}), which would end prime"
                ) from problem
        if interrupted:
            raise KeyboardInterrupt
        return result


def is_contained() -> bool:
    """Whether a pack's code is running that is not to end or change anything."""
    return _depth > 0


def described(problem: BaseException) -> str:
    """Return an error in one line."""
    return f"{type(problem).__name__}: {_text(problem)}".removesuffix(": ")


def _text(problem: BaseException) -> str:
    try:
        return next(iter(str(problem).strip().splitlines()), "")
    except Exception:  # of its own __str__
        return "no text"


@contextmanager
def _told_to_be_inside() -> Iterator[None]:
    global _depth
    _depth += 1
    try:
        yield
    finally:
        _depth -= 1


@contextmanager
def _interrupts_noted() -> Iterator[list[int]]:
    """Tell Ctrl-C from a KeyboardInterrupt that a pack raises; put all signal handlers back."""
    noted: list[int] = []
    if threading.current_thread() is not threading.main_thread():
        yield noted
        return

    def note(number: int, _: Any) -> None:
        noted.append(number)
        raise KeyboardInterrupt

    before = {number: signal.getsignal(number) for number in signal.valid_signals()}
    if callable(before[signal.SIGINT]):  # else it is ignored
        signal.signal(signal.SIGINT, note)
    try:
        yield noted
    finally:
        for number, handler in before.items():
            if handler is not None and signal.getsignal(number) is not handler:
                signal.signal(number, handler)


@contextmanager
def _streams_kept() -> Iterator[None]:
    before = sys.stdin, sys.stdout, sys.stderr
    # A stream of its own, for a pack may close it, or keep it for its messages.
    sys.stdout = _aside()
    try:
        yield
    finally:
        sys.stdin, sys.stdout, sys.stderr = before


def _aside() -> TextIO:
    global _stream
    if _stream is None or _stream.closed:
        try:
            _stream = os.fdopen(os.dup(2), "w", buffering=1, errors="backslashreplace")
        except OSError:  # there is no stderr
            _stream = open(os.devnull, "w", encoding="utf-8")  # noqa: SIM115
    return _stream


@contextmanager
def _logging_kept() -> Iterator[None]:
    root = logging.getLogger()
    named = [item for item in root.manager.loggerDict.values() if isinstance(item, logging.Logger)]
    loggers = (root, *named)
    before = [(item.level, item.disabled, item.propagate, list(item.handlers)) for item in loggers]
    disabled = root.manager.disable
    try:
        yield
    finally:
        logging.disable(disabled)
        for item, (level, off, propagate, handlers) in zip(loggers, before, strict=True):
            item.setLevel(level)
            item.disabled, item.propagate, item.handlers = off, propagate, handlers


@contextmanager
def _imports_kept() -> Iterator[None]:
    """Let a pack add places to import from behind those that there are, and take away none."""
    searched: list[list[Any]] = [sys.path, sys.meta_path, sys.path_hooks]
    before, names = [list(places) for places in searched], dict(vars(builtins))
    try:
        yield
    finally:
        vars(builtins).update(names)
        sys.path, sys.meta_path, sys.path_hooks = searched  # a pack may have put others there
        for places, old in zip(searched, before, strict=True):
            places[:] = [*old, *(place for place in places if place not in old)]


@contextmanager
def _process_kept() -> Iterator[None]:
    folder = None
    with suppress(OSError):
        folder = os.getcwd()
    arguments, hook, limit = list(sys.argv), sys.excepthook, sys.getrecursionlimit()
    variables, mask = dict(os.environ), os.umask(0)
    os.umask(mask)
    try:
        yield
    finally:
        os.umask(mask)
        for name, value in variables.items():
            os.environ.setdefault(name, value)  # a pack may set some, such as MUJOCO_GL
        sys.argv[:], sys.excepthook = arguments, hook
        sys.setrecursionlimit(limit)
        if folder is not None:
            with suppress(OSError):
                os.chdir(folder)


_KEPT = (_told_to_be_inside, _streams_kept, _logging_kept, _imports_kept, _process_kept)
