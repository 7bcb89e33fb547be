"""What exca keeps of a stage: which items are there, and what is mended before a run goes on."""

import contextlib
import os
import socket
import sqlite3
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import exca
import orjson
from exca.cachedict import CacheDict, DumpContext
from exca.cachedict.inflight import InflightRegistry, Pid

from prime_core.files import new_file

_INFO = "*-info.jsonl"
"""Files of exca with a line for each item; each process writes its own."""


_HANDLERS = ("Auto", "Json", "MemmapArray")
"""exca's, that results of stages are kept by. Others unpickle what an index names, or remove it."""


class _OwnFiles(DumpContext):
    """Reads and removes nothing but what stages keep, whatever an index that was changed says."""

    def _resolve_type(self, info: dict[str, Any]) -> tuple[Any, dict[str, Any]]:
        kind, place = info.get("#type"), info.get("filename", f"{self.DATA_DIR}/")
        if kind not in _HANDLERS or os.path.dirname(place) != self.DATA_DIR:
            raise LookupError(f"its index names {kind!r} of {place!r}")
        return super()._resolve_type(info)

    def delete(self, info: Any) -> None:
        """Leave files alone: each holds several items."""


class StageInfra(exca.MapInfra):
    """exca's, which does not ask for a folder before there is something to keep."""

    @property
    def cache_dict(self) -> CacheDict[Any]:
        """exca's, which reads by handlers that run no code."""
        cache = super().cache_dict
        if cache.folder is not None and not isinstance(cache._dumper, _OwnFiles):
            cache._dumper = _OwnFiles(cache.folder)
        return cache

    def model_post_init(self, log__: Any) -> None:
        """Set up as exca does, but for its look at the folder: questions write nothing."""
        super(exca.MapInfra, self).model_post_init(log__)

    def forget(self, items: Iterable[str]) -> None:
        """Forget what is kept of items; it may be unreadable."""
        with self.cache_dict.write() as cache:
            for item in items:
                with contextlib.suppress(LookupError, TypeError, ValueError):
                    del cache[item]
        # It would go on with what it has read of files that are written anew under the same names.
        self._state.cache_dict = None

    def _check_configs(self, write: bool = True) -> None:
        try:
            super()._check_configs(write)
        except RuntimeError:
            # A folder is named after the settings: copies that differ from them are damaged.
            for name in ("uid", "full-uid", "config"):
                (Path(str(self.uid_folder())) / f"{name}.yaml").unlink(missing_ok=True)
            super()._check_configs(write)


@dataclass
class _Index:
    """What was read of a file with a line for each item."""

    stamp: tuple[int, int, int] = (0, 0, 0)  # inode, size, time of the last change
    end: int = 0  # of the last whole line
    keys: set[str] = field(default_factory=set)


_indices: dict[Path, _Index] = {}


def kept_items(folder: Path) -> set[str]:
    """Return the items that are kept in the folder of a stage; nothing is written."""
    found: set[str] = set()
    for path in folder.glob(_INFO):
        with contextlib.suppress(FileNotFoundError):
            found |= _keys_of(path)
    return found


def _keys_of(path: Path) -> set[str]:
    """Return the items of a file, of which only what is new is read: runs ask twice a second."""
    state = path.stat()
    stamp = (state.st_ino, state.st_size, state.st_mtime_ns)
    index = _indices.setdefault(path, _Index())
    if stamp == index.stamp:
        return index.keys
    if stamp[0] != index.stamp[0] or state.st_size <= index.end:
        index = _indices[path] = _Index()  # lines are blanked in place, without growth
    with path.open("rb") as file:
        file.seek(index.end)
        lines = file.read().splitlines(keepends=True)
    for line in lines:
        item = _parsed(line)
        if item is not None:
            index.keys.add(str(item["#key"]))
        if line.endswith(b"\n"):
            index.end += len(line)
    index.stamp = stamp
    return index.keys


def mend(folder: Path) -> None:
    """Clear away what a killed process, a full disk or damage left of exca's own files.

    No other run may be at work in the folder. Workers of a killed one may still be.
    """
    if not folder.is_dir():
        return
    for path in folder.glob(_INFO):
        lines = _lines(path)
        whole = [line for line in lines if line.isspace() or _parsed(line)]
        if len(whole) < len(lines) and not _may_grow(path, only_end=whole == lines[:-1]):
            with new_file(path) as aside:
                aside.write_bytes(b"".join(whole))
    _mend_claims(folder)


def _lines(path: Path) -> list[bytes]:
    return path.read_bytes().splitlines(keepends=True)


def _parsed(line: bytes) -> dict[str, Any] | None:
    """Return a line's content, or None if it is not whole."""
    if not line.endswith(b"\n"):
        return None
    try:
        found = orjson.loads(line)
    except ValueError:
        return None
    return found if isinstance(found, dict) and "#key" in found else None


def _may_grow(path: Path, *, only_end: bool) -> bool:
    """Whether the thread that a file is named after may live: HOST-THREAD-info.jsonl.

    Args:
        path: The file.
        only_end: Whether nothing but its last line is broken: elsewhere somebody may write it now.
    """
    host, _, thread = path.name.removesuffix("-info.jsonl").rpartition("-")
    if host != socket.gethostname():
        return only_end
    return thread.isdigit() and _is_worker(int(thread), path.parent)


def _is_worker(process: int, folder: Path) -> bool:
    """Whether a process works for a stage: numbers of processes come again."""
    try:
        command = Path(f"/proc/{process}/cmdline").read_bytes()
    except OSError:
        return False
    return os.fsencode(folder) in command


def _mend_claims(folder: Path) -> None:
    """Drop claims on items by processes that have gone, and a file of claims that is broken.

    exca would wait for another process of the same number for ever, and ten minutes for one of
    another host; but the run that it worked for has gone, and its workers with it.
    """
    path = folder / InflightRegistry._DB_NAME
    if not path.exists():
        return
    try:
        with contextlib.closing(sqlite3.connect(path)) as claims:
            claims.execute("SELECT COUNT(*) FROM inflight").fetchone()
    except sqlite3.OperationalError:
        return  # somebody writes it now, or it is empty
    except sqlite3.DatabaseError:
        path.unlink()
        return
    with InflightRegistry(folder) as registry:
        for item, worker in registry.get().items():
            living = worker.liveness
            if not isinstance(living, Pid):
                continue  # Slurm knows of its jobs
            if living.host != socket.gethostname() or not _is_worker(living.pid, folder):
                with InflightRegistry(folder, worker=worker) as gone:
                    gone.release([item])
