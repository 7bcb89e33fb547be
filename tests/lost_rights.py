"""Files that the process that reads them has no right to."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

NOBODY = 65534


@contextmanager
def without_rights(path: Path) -> Iterator[None]:
    """Take all rights to a file or folder away; root, who needs none, becomes another user."""
    mode, is_root = path.stat().st_mode, os.geteuid() == 0
    path.chmod(0o000)
    if is_root:
        os.seteuid(NOBODY)
    try:
        yield
    finally:
        if is_root:
            os.seteuid(0)
        path.chmod(mode)
