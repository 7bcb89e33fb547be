"""Where all random draws come from: one stream for each purpose, so that no two share a draw."""

from enum import IntEnum

import numpy as np


class Stream(IntEnum):
    """What draws are for; the first number of every seed."""

    COLLECTION = 1
    IDM = 2
    POLICY = 3
    CHECKPOINT_TRIALS = 4
    FRESH_TRIALS = 5
    VIDEO = 6
    DEMONSTRATIONS = 7
    RANDOM_POSES = 8


def generator_of(stream: Stream, *numbers: int) -> np.random.Generator:
    """Return the generator of a stream, and of an item in it.

    Args:
        stream: What the draws are for.
        numbers: The seed, then what tells items apart, such as the episode's number.
    """
    # numpy takes [1, 0] for [1]: how many numbers there are tells them apart.
    return np.random.default_rng([int(stream), len(numbers), *numbers])
