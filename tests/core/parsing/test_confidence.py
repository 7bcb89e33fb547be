"""Confidences of segments, against every segmentation there is and on what is ambiguous."""

import itertools

import numpy as np
import pytest

from prime_core.arrays import Floats
from prime_core.contracts.parser import PairScores, ParsedSegment
from prime_core.parsing.confidence import primitive_shares, segment_confidences
from prime_core.parsing.dynamic_programming import DynamicProgrammingConfig

from .test_parsers import random_scores, segmentations


def shares_by_hand(scores: PairScores) -> Floats:
    """Return the shares of primitives, all labelled segmentations tried one after another."""
    frames, lengths, classes = scores.log_probability.shape
    shortest, primitives = scores.minimum_steps, classes - 1
    best = np.zeros((frames - 1, primitives))
    for ends in segmentations(frames - 1, shortest, shortest + lengths - 1):
        pieces = list(zip([0, *ends], ends, strict=False))
        for labels in itertools.product(range(primitives), repeat=len(pieces)):
            value = sum(
                scores.log_probability[start, end - start - shortest, label]
                for (start, end), label in zip(pieces, labels, strict=True)
            )
            for (start, end), label in zip(pieces, labels, strict=True):
                best[start:end, label] = np.maximum(best[start:end, label], np.exp(value))
    shares: Floats = best / best.sum(axis=1, keepdims=True)
    return shares


@pytest.mark.parametrize("frames", [3, 6, 9])
@pytest.mark.parametrize("seed", range(4))
def test_shares_are_those_of_the_best_segmentations(frames: int, seed: int) -> None:
    scores = random_scores(frames, seed=seed)
    np.testing.assert_allclose(primitive_shares(scores), shares_by_hand(scores), rtol=1e-9)


def two_primitives(second: float, other: float = 0.01) -> PairScores:
    """Return scores of 12 steps: one primitive for six, then another, as sure as is said.

    What crosses the boundary is `other`.
    """
    values = np.full((13, 11, 3), -np.inf)
    for start in range(13):
        for end in range(start + 2, 13):
            row = [0.005, 0.005, 0.99]
            if end <= 6:
                row = [0.98, 0.01, 0.01]
            elif start >= 6:
                row = [1.0 - second - other, second, other]
            values[start, end - start - 2] = np.log(row)
    return PairScores(values, 2)


def confidences(scores: PairScores) -> list[float]:
    parsed = DynamicProgrammingConfig(minimum_steps=2).build().parse(scores)
    assert [(item.start, item.end, item.label) for item in parsed] == [(0, 6, 0), (6, 12, 1)]
    return segment_confidences(scores, parsed)


def test_what_is_ambiguous_has_a_lower_confidence_than_what_is_clear() -> None:
    clear, certain = confidences(two_primitives(0.95))
    assert clear > 0.9
    assert certain > 0.85
    beside, ambiguous = confidences(two_primitives(0.5))  # the first primitive is 0.49
    assert beside == pytest.approx(clear, abs=0.01)
    assert 0.2 < ambiguous < 0.3  # half a chance at its ends, half of its actions
    beside, unexplained = confidences(two_primitives(0.35, other=0.6))
    assert beside == pytest.approx(clear, abs=0.01)
    assert 0.25 < unexplained < 0.35


def test_a_wrong_label_has_less_than_the_right_one() -> None:
    scores = two_primitives(0.95)
    labels = [
        segment_confidences(scores, [ParsedSegment(0, 6, label, 0.0)])[0] for label in range(3)
    ]
    assert labels[0] > 0.9
    assert labels[1] < 0.01
    assert labels[2] == pytest.approx(0.01)


def test_what_was_not_scored_has_none() -> None:
    short = PairScores(np.full((3, 196, 4), -np.inf), 5)
    assert segment_confidences(short, [ParsedSegment(0, 2, 3, 0.0)]) == [0.0]
    assert segment_confidences(PairScores(np.full((1, 1, 3), -np.inf), 5), []) == []
    impossible = PairScores(np.full((6, 4, 3), -np.inf), 2)
    assert segment_confidences(impossible, [ParsedSegment(0, 5, 0, 0.0)]) == [
        pytest.approx(1 / 6)  # of three classes, of two primitives
    ]
    alone = PairScores(np.zeros((6, 4, 1)), 2)
    assert segment_confidences(alone, [ParsedSegment(0, 5, 0, 0.0)]) == [1.0]


def test_densities_of_parameters_do_not_lead_beyond_one() -> None:
    scores = two_primitives(0.95)
    scores.log_probability[..., :2] += 7.0
    parsed = DynamicProgrammingConfig(minimum_steps=2).build().parse(scores)
    assert len(parsed) > 2  # a density above 1 is a gain of each cut
    assert all(0.9 < value <= 1.0 for value in segment_confidences(scores, parsed))
