"""Digests of files that lie outside a run's folder, such as recordings, and of results in it."""

import hashlib
import math
import os
import struct
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import BaseModel

Stamp = tuple[str, int, int, int, int]
"""Path, size, inode and times of a file: as long as they are the same, so is its content."""

_known: dict[Stamp, str] = {}


def content_of(settings: Iterable[BaseModel]) -> str:
    """Return a digest of all files and folders that settings name; empty where they name none.

    A setting names a file if its value is a `Path`. Of a folder all files count, by their names
    in it, but for hidden ones.

    Args:
        settings: Such as those of a demonstrator.
    """
    named = [path for item in settings for path in _paths(item)]
    if not named:
        return ""
    total = hashlib.blake2b(digest_size=8)
    for path in named:
        for file in _files(path):
            relative = file.relative_to(path).as_posix()
            total.update(f"{relative}\0{file_digest(file)}\n".encode())
        total.update(b"\n")
    return total.hexdigest()


def file_digest(path: Path) -> str:
    """Return the digest of a file's content, or a word if there is no such file."""
    try:
        state = path.stat()
        stamp = (str(path), state.st_size, state.st_ino, state.st_mtime_ns, state.st_ctime_ns)
        if stamp not in _known:
            with path.open("rb") as file:
                _known[stamp] = hashlib.file_digest(file, "sha256").hexdigest()[:16]
        return _known[stamp]
    except FileNotFoundError:
        return "missing"


def result_digest(result: Mapping[str, Any]) -> str:
    """Return the digest of what an item gives, the same before it is kept and after."""
    total = hashlib.sha256()
    for part in _plain(result):
        total.update(part)
    return total.hexdigest()[:16]


def _paths(value: Any) -> Iterator[Path]:
    if isinstance(value, Path):
        yield value
    elif isinstance(value, BaseModel):
        for name in type(value).model_fields:
            yield from _paths(getattr(value, name))
    elif isinstance(value, Mapping):
        for item in value.values():
            yield from _paths(item)
    elif isinstance(value, list | tuple | set | frozenset):
        for item in value:
            yield from _paths(item)


def _files(path: Path) -> list[Path]:
    """Return a file, or those in a folder and in what links in it lead to."""
    if not path.is_dir():
        return [path]
    found: list[Path] = []
    seen: set[str] = set()
    for place, folders, files in os.walk(path, followlinks=True):
        seen.add(os.path.realpath(place))
        folders[:] = [
            name
            for name in folders
            if not name.startswith(".") and os.path.realpath(Path(place, name)) not in seen
        ]
        found += [Path(place, name) for name in files if not name.startswith(".")]
    return sorted(found)


def _plain(value: Any) -> Iterator[Any]:
    """Yield a value as bytes, no two values alike; exca gives lists for tuples, None for NaN."""
    if isinstance(value, np.ndarray):
        yield f"a{value.dtype.str}{value.shape}".encode()
        yield np.ascontiguousarray(value).data
    elif isinstance(value, Mapping):
        yield f"d{len(value)}".encode()
        for name in sorted(value):
            yield from _plain(name)
            yield from _plain(value[name])
    elif isinstance(value, list | tuple):
        yield f"l{len(value)}".encode()
        for item in value:
            yield from _plain(item)
    elif isinstance(value, float) and math.isfinite(value):
        yield b"f" + struct.pack("<d", value)
    elif value is None or isinstance(value, float):
        yield b"n"
    else:
        yield f"{type(value).__name__}{value}\0".encode()
