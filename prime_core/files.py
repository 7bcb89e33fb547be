"""Files and folders that are there whole or not at all: made aside, then renamed."""

import ctypes
import os
import shutil
import sys
import uuid
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


def _sibling(path: Path, purpose: str) -> Path:
    # Beside it, so that the rename stays within one file system; hidden, and no two alike.
    return path.with_name(f".{path.stem}.{uuid.uuid4().hex[:8]}.{purpose}{path.suffix}")


@contextmanager
def new_file(path: Path) -> Iterator[Path]:
    """Give a path to write to; what is there at the end takes the place of ``path``.

    Args:
        path: The file, which may exist. Its folder is made if need be.

    Yields:
        Where to write, with the same suffix. It is removed if the body raises.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = _sibling(path, "partial")
    try:
        yield partial
        partial.replace(path)
    finally:
        partial.unlink(missing_ok=True)


def exchange(left: Path, right: Path) -> bool:
    """Give two files or folders each other's names, in one step.

    Returns:
        Whether it was done: only Linux can, and not on every file system.
    """
    if not sys.platform.startswith("linux"):
        return False
    rename = getattr(ctypes.CDLL(None, use_errno=True), "renameat2", None)
    if rename is None:
        return False
    here, both = -100, 2  # AT_FDCWD, RENAME_EXCHANGE
    return bool(rename(here, os.fsencode(left), here, os.fsencode(right), both) == 0)


@contextmanager
def new_folder(path: Path) -> Iterator[Path]:
    """Give an empty folder to fill; at the end it takes the place of ``path``.

    One that is there is exchanged for the new one in a single step where the system can do that;
    elsewhere it is moved aside first. It is removed last, so that one of the two is whole at any
    time.

    Args:
        path: The folder. Its parent is made if need be.

    Yields:
        The folder to fill. It is removed if the body raises.

    Raises:
        OSError: If the folder cannot take its place; what was there is there still.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    partial, old = _sibling(path, "partial"), _sibling(path, "replaced")
    partial.mkdir()
    try:
        yield partial
        if path.exists() and exchange(partial, path):
            return
        if path.exists():
            path.rename(old)
        try:
            partial.rename(path)
        except OSError:
            if old.exists():
                old.rename(path)
            raise
    finally:
        shutil.rmtree(partial, ignore_errors=True)
    shutil.rmtree(old, ignore_errors=True)
