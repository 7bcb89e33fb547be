"""Counts the parameters of trained networks from the heads of their files, without loading them."""

import json
import math
import struct
from pathlib import Path

_LONGEST_HEAD = 100_000_000  # bytes; no safetensors file has a longer one


def count_parameters(checkpoint: Path) -> int | None:
    """Return how many numbers the networks of a checkpoint hold.

    The few that are not learnt, such as those that inputs are scaled with, are among them.

    Args:
        checkpoint: A safetensors file, or a folder with some.

    Returns:
        None if there is no such file: what other files hold is not known here.
    """
    files = [checkpoint] if checkpoint.is_file() else sorted(checkpoint.rglob("*.safetensors"))
    counts = [_numbers_in(file) for file in files]
    return sum(count or 0 for count in counts) if any(counts) else None


def _numbers_in(file: Path) -> int | None:
    """Return how many numbers a safetensors file holds, or None if it is none.

    Eight bytes say how long the JSON is that follows, which has the shape of each tensor.
    """
    try:
        with file.open("rb") as stream:
            (length,) = struct.unpack("<Q", stream.read(8))
            if length > _LONGEST_HEAD:
                return None
            head = json.loads(stream.read(length))
        return sum(
            math.prod(map(int, tensor["shape"]))
            for name, tensor in head.items()
            if name != "__metadata__"
        )
    except (AttributeError, KeyError, TypeError, ValueError, struct.error):
        return None
