"""Streams of random draws: no two share a draw."""

import itertools

import numpy as np
import pytest

from prime_core.seeds import Stream, generator_of

# Zeros at the end, numbers of a digit more, and the same numbers in another order or split.
NUMBERS = [
    (),
    *itertools.product((0, 1, 2, 10), repeat=1),
    *itertools.product((0, 1, 2, 10), repeat=2),
    *itertools.product((0, 1, 2, 10), repeat=3),
    *[(2**32,), (0, 2**32), (2**32 + 1, 0), (1, 2**64), (12, 3), (1, 23), (1, 2, 3, 0), (1, 2, 3)],
]


def draws_of(stream: Stream, *numbers: int) -> bytes:
    return generator_of(stream, *numbers).integers(2**63, size=4).tobytes()


def test_no_two_items_of_any_streams_share_their_draws() -> None:
    items = {(stream, numbers) for stream in Stream for numbers in NUMBERS}
    found = {draws_of(stream, *numbers) for stream, numbers in items}
    assert len(items) > 500
    assert len(found) == len(items)


def test_numpy_alone_would_take_zeros_at_the_end_for_nothing() -> None:
    # Why the streams say how many numbers there are.
    alike = [np.random.default_rng(seed).random() for seed in ([1], [1, 0], [1, 0, 0])]
    assert len(set(alike)) == 1
    apart = [draws_of(Stream.POLICY, *numbers) for numbers in ((), (0,), (0, 0))]
    assert len(set(apart)) == 3


@pytest.mark.parametrize("stream", Stream)
def test_the_same_item_has_the_same_draws(stream: Stream) -> None:
    assert draws_of(stream, 3, 0) == draws_of(stream, 3, 0)


def test_streams_keep_their_numbers() -> None:
    # Caches and results depend on them.
    assert {stream.name: int(stream) for stream in Stream} == {
        "COLLECTION": 1,
        "IDM": 2,
        "POLICY": 3,
        "CHECKPOINT_TRIALS": 4,
        "FRESH_TRIALS": 5,
        "VIDEO": 6,
        "DEMONSTRATIONS": 7,
        "RANDOM_POSES": 8,
    }
