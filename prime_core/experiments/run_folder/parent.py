"""Workers end when the process that they work for has gone."""

import os
from pathlib import Path

PARENT_VARIABLE = "PRIME_PARENT_PROCESS"
"""Holds the process that workers work for: they stop when it is gone."""


def stop_without_parent() -> None:
    """End a worker whose experiment was killed, so that a new run finds the cores free."""
    parent = os.environ.get(PARENT_VARIABLE)
    if parent is None or os.getpid() == int(parent):
        return
    if not _is_running(int(parent)):
        raise SystemExit(1)


def _is_running(process: int) -> bool:
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    # A killed process that nobody has asked after yet still has its number.
    status = Path(f"/proc/{process}/stat")
    return not status.exists() or status.read_text().rpartition(")")[2].split()[0] != "Z"
