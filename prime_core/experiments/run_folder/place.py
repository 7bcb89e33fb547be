"""Trouble with the place where files lie: disks that are full, folders that cannot be written."""

import contextlib
import errno
import os
import re
from collections.abc import Iterator
from pathlib import Path

from prime_core.errors import PrimeError

_OF_THE_PLACE = {
    errno.EACCES,
    errno.EDQUOT,
    errno.EEXIST,
    errno.EFBIG,
    errno.EIO,
    errno.EISDIR,
    errno.ENAMETOOLONG,
    errno.ENOSPC,
    errno.ENOTDIR,
    errno.EPERM,
    errno.EROFS,
    errno.ESTALE,
}

_NUMBER = re.compile(
    r"\[Errno (?P<errno>\d+)\](?:[^\n]*?: '(?P<name>[^'\n]+)')?|\(os error (?P<other>\d+)\)"
)

_PROBE = 64 * 1024  # bytes; less than the least that a stage writes is of no use


class PlaceError(PrimeError):
    """Files cannot be written or read where they lie. The text names the place and the reason."""

    def __init__(self, place: Path | str, reason: str, *, keeps: bool = True) -> None:
        kept = ": what is finished is kept" if keeps else ""
        super().__init__(
            f"{place}: {reason}. Make it writable or make space, or choose another place; "
            f"then run again{kept}"
        )


def place_error(
    error: BaseException | str, folder: Path, *, keeps: bool = True
) -> PlaceError | None:
    """Return what an error says of the place where files lie, or None if it is of another kind.

    Args:
        error: Or its text, where it comes from another process.
        folder: Where the files are, if the error does not say.
        keeps: Whether what is finished is kept.
    """
    if isinstance(error, OSError) and error.errno in _OF_THE_PLACE:
        # Of a rename the second name is the one that was asked for.
        name = Path(os.fsdecode(error.filename2 or error.filename or folder))
        # Hidden files are our own: what is written aside, locks.
        place = name.parent if name.name.startswith(".") else name
        return PlaceError(place, os.strerror(error.errno), keeps=keeps)
    # Libraries that are not written in Python have errors of their own, and the same numbers.
    for found in reversed(list(_NUMBER.finditer(str(error)))):
        number = int(found["errno"] or found["other"])
        if number in _OF_THE_PLACE:
            return PlaceError(found["name"] or folder, os.strerror(number), keeps=keeps)
    return None


@contextlib.contextmanager
def place_told(folder: Path, *, keeps: bool = True) -> Iterator[None]:
    """Turn errors of the place where files lie into what a user can mend.

    Args:
        folder: Where the files are, if an error does not say.
        keeps: Whether what is finished is kept; else all is done anew.

    Raises:
        PlaceError: Instead of an ``OSError`` of that kind.
    """
    try:
        yield
    except OSError as error:
        raise place_error(error, folder, keeps=keeps) or error from None


def probed(folder: Path) -> PlaceError | None:
    """Try to write a little: on a full disk a process often dies before it can tell why."""
    path = folder / ".probe"
    try:
        path.write_bytes(bytes(_PROBE))
    except OSError as error:
        return PlaceError(folder, os.strerror(error.errno or errno.EIO))
    finally:
        with contextlib.suppress(OSError):
            path.unlink()
    return None
