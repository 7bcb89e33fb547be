"""The paper's greedy parser, to compare with: the best next segment, one after another."""

import numpy as np

from prime_core.arrays import Floats
from prime_core.parsing.scored import ScoredParser, ScoredParserConfig


class GreedyConfig(ScoredParserConfig):
    """Settings of the parser that takes the best next segment (``greedy``)."""

    def build(self) -> "GreedyParser":
        """Make the parser."""
        return GreedyParser(self)


class GreedyParser(ScoredParser):
    """From the current state, takes the later state of the greatest probability, and goes on.

    A state is left out if it would leave fewer motor actions than the shortest segment has:
    they could not be covered. A choice always remains, as the longest segment has at least
    twice the shortest one's motor actions, less one. Of equally good states the latest is
    taken, so the longest segment.
    """

    def cut(self, values: Floats, shortest: int) -> list[int]:
        """Choose where segments end; see `ScoredParser.cut`."""
        last, lengths = len(values) - 1, values.shape[1]
        start = 0
        ends: list[int] = []
        while start < last:
            # Longest first: argmax takes the first of equals.
            steps = np.arange(min(shortest + lengths - 1, last - start), shortest - 1, -1)
            left = last - start - steps
            steps = steps[(left == 0) | (left >= shortest)]
            start += int(steps[np.argmax(values[start, steps - shortest])])
            ends.append(start)
        return ends
