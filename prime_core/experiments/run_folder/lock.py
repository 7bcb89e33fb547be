"""One run at a time in a folder."""

import contextlib
import errno
import os
import socket
import time
from collections.abc import Callable, Iterator
from pathlib import Path

NAME = ".lock"

_UNKNOWN = (errno.ENOLCK, errno.ENOSYS, errno.EOPNOTSUPP)
"""Of file systems that have no locks."""


@contextlib.contextmanager
def alone_in(folder: Path, say: Callable[[str], None]) -> Iterator[None]:
    """Wait until no other run is at work in a folder, and keep others waiting.

    The system takes the lock away from a process that ends, however it ends.

    Args:
        folder: Of the run. It is made if need be.
        say: Called with a line if there is another run.
    """
    import fcntl  # where there is none, prime can still be imported

    folder.mkdir(parents=True, exist_ok=True)
    with (folder / NAME).open("a+b", buffering=0) as file:
        try:
            try:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                file.seek(0)
                other = file.read().decode(errors="replace").strip() or "another process"
                say(f"another run is at work in {folder} ({other}): waiting until it has ended")
                fcntl.flock(file, fcntl.LOCK_EX)
        except OSError as error:
            if error.errno not in _UNKNOWN:
                raise
        with contextlib.suppress(OSError):  # a full disk takes locks, but no text
            file.truncate(0)
            now = time.strftime("%Y-%m-%d %H:%M:%S")
            file.write(f"process {os.getpid()} on {socket.gethostname()} since {now}\n".encode())
        yield
