"""What makes a training, and a network's answers, the same each time: seeds and threads."""

import zlib
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
import torch


def seeded(seed: int, name: str, number: int) -> np.random.Generator:
    """Return the generator of a named and numbered part of a training."""
    return np.random.default_rng([seed, zlib.crc32(name.encode()), number])


@contextmanager
def first_weights(seed: int, name: str) -> Iterator[None]:
    """Give the networks that are built meanwhile weights that depend on a seed and a name only."""
    with torch.random.fork_rng(devices=[]):
        torch.manual_seed(int(seeded(seed, name, 0).integers(2**62)))
        yield


@contextmanager
def threads(count: int = 1) -> Iterator[None]:
    """Use a number of threads: small matrices are no faster on more, and sums keep their order."""
    before = torch.get_num_threads()
    torch.set_num_threads(count)
    try:
        yield
    finally:
        torch.set_num_threads(before)
