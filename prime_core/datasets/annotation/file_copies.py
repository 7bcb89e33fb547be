"""Copies of a data set's files, and whether somebody changes them meanwhile."""

import os
import shutil
from collections.abc import Collection
from pathlib import Path


def copy_all_but(source: Path, target: Path, left_out: Collection[Path], *, link: bool) -> None:
    """Copy a folder's files into another folder.

    Args:
        source: The folder.
        target: An empty folder.
        left_out: Files, seen from the folder, that are not copied; their folders are made.
        link: Whether the files are to be the same ones, where the file system can do that: for a
            folder that takes the other's place. Links stay links then, and are followed else.
    """
    skipped = {source / path for path in left_out}

    def ignored(folder: str, names: list[str]) -> list[str]:
        return [name for name in names if Path(folder) / name in skipped]

    shutil.copytree(
        source,
        target,
        symlinks=link,
        ignore=ignored,
        copy_function=_linked if link else shutil.copy2,
        dirs_exist_ok=True,
    )


def _linked(source: str, target: str) -> None:
    try:
        os.link(source, target, follow_symlinks=False)
    except OSError:  # a file system without hard links
        shutil.copy2(source, target)


def state_of(folder: Path) -> dict[str, tuple[int, int, int]]:
    """Return number, size and time of change [ns] of each file in a folder."""
    found = {}
    for parent, _, names in os.walk(folder):
        for name in names:
            path = os.path.join(parent, name)
            state = os.stat(path)
            found[path] = (state.st_ino, state.st_size, state.st_mtime_ns)
    return found
