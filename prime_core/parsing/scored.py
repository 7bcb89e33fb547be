"""What parsers by probability share: everything but where they cut."""

from abc import ABC, abstractmethod
from typing import Literal

import numpy as np
from pydantic import Field

from prime_core.arrays import Floats, Indices
from prime_core.contracts.parser import PairScores, ParsedSegment, Parser, ParserConfig
from prime_core.errors import PrimeError

IMPOSSIBLE = -1e9
"""Log value that a segment of probability zero counts as.

Finite, so that a demonstration with an impossible stretch is still cut, and far below any
sum that a model's probabilities can come to, so that such stretches are kept few.
"""


Rule = Literal["max", "argmax"]


class ScoredParserConfig(ParserConfig, ABC):
    """Settings of parsers that weigh a segment by ``alpha * IDM(p, x | s, s')``."""

    alpha: float = Field(1e-4, gt=0.0, le=1.0)
    """Factor on the probability of `other`: the less, the more is explained by primitives."""
    rule: Rule = "max"
    """How a pair's class is chosen. ``max``: the class of the greatest probability after alpha,
    as in the paper's equation. ``argmax``: the most likely class, and alpha applied to that, as
    in the paper's release; a pair that the model calls `other` then stays `other`."""


class ScoredParser(Parser, ABC):
    """Chooses each pair's class, then cuts by the values of those choices.

    A segment's log probability is its value: alpha is included.

    Args:
        config: Its settings. The lengths of segments are those that the scores come with.
    """

    def __init__(self, config: ScoredParserConfig) -> None:
        self.config = config

    @abstractmethod
    def cut(self, values: Floats, shortest: int) -> list[int]:
        """Choose where segments end.

        Args:
            values: Log value of each pair by start frame and length, finite,
                ``(frames, lengths)``; index 0 is the length `shortest`.
            shortest: Motor actions of the shortest segment, at most ``frames - 1``.

        Returns:
            The frames where segments end, in order; the last is the last frame.
        """

    def parse(self, scores: PairScores) -> list[ParsedSegment]:
        """Return the segments; see `Parser.parse`.

        Raises:
            PrimeError: If a score is not a number or too few lengths are scored.
        """
        steps = len(scores.log_probability) - 1
        shortest = scores.minimum_steps
        if steps < 1:
            return []
        if steps < shortest:
            other = scores.log_probability.shape[2] - 1
            return [ParsedSegment(0, steps, other, 0.0)]
        _check_lengths(steps, shortest, scores.log_probability.shape[1])
        labels, values = choose_classes(scores, self.config.alpha, self.config.rule)
        ends = self.cut(np.maximum(values, IMPOSSIBLE), shortest)
        return [
            ParsedSegment(
                start,
                end,
                int(labels[start, end - start - shortest]),
                float(values[start, end - start - shortest]),
            )
            for start, end in zip([0, *ends], ends, strict=False)
        ]


def choose_classes(scores: PairScores, alpha: float, rule: Rule) -> tuple[Indices, Floats]:
    """Choose the class of each pair.

    Args:
        scores: Of all pairs.
        alpha: Factor on the probability of `other`.
        rule: See `ScoredParserConfig`. Of equally good classes the lowest is taken, so a
            primitive before `other`.

    Returns:
        The class of each pair and its log value, alpha included, both ``(frames, lengths)``.

    Raises:
        PrimeError: If a score is not a number.
    """
    given = scores.log_probability
    bad = np.isnan(given).any(axis=(1, 2))
    if bad.any():
        raise PrimeError(
            f"the pair scores from frame {int(np.argmax(bad))} hold NaN, where log probabilities "
            "should be: did the training of the inverse dynamics model diverge?"
        )
    weighted = given.astype(np.float64)
    weighted[..., -1] += np.log(alpha)
    labels = np.argmax(weighted if rule == "max" else given, axis=-1)
    values = np.take_along_axis(weighted, labels[..., None], axis=-1)[..., 0]
    return labels, values


def _check_lengths(steps: int, shortest: int, lengths: int) -> None:
    """Make sure that segments of the scored lengths can cover a demonstration."""
    longest = shortest + lengths - 1
    needed = min(steps, 2 * shortest - 1)
    if longest < needed:
        raise PrimeError(
            f"segments of {shortest} to {longest} steps are scored: to cover a demonstration of "
            f"{steps} steps for sure, score those of up to {needed} steps too"
        )
