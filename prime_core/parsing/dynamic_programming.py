"""The paper's parser: the segmentation of the greatest probability, found exactly."""

import numpy as np

from prime_core.arrays import Floats
from prime_core.parsing.scored import ScoredParser, ScoredParserConfig


class DynamicProgrammingConfig(ScoredParserConfig):
    """Settings of the parser that finds the best segmentation of all (``dp``)."""

    def build(self) -> "DynamicProgrammingParser":
        """Make the parser."""
        return DynamicProgrammingParser(self)


class DynamicProgrammingParser(ScoredParser):
    """Finds the segmentation of the greatest product of probabilities.

    With f(i) the probability of the best segmentation of frames 0 to i (paper, section III-C),

        f(i) = max over p, x, t < i of f(t) * alpha_p * IDM(p, x | s_t, s_i),    f(0) = 1,

    on logarithms, where alpha_p is alpha for `other` and 1 for primitives. Of equally good
    segmentations the one with the longest last segment is taken, then with the longest
    segment before it, and so on.
    """

    def cut(self, values: Floats, shortest: int) -> list[int]:
        """Choose where segments end; see `ScoredParser.cut`."""
        frames, lengths = values.shape
        best = np.full(frames, -np.inf)
        best[0] = 0.0
        previous = np.zeros(frames, dtype=np.int64)
        for end in range(shortest, frames):
            # Starts in rising order: argmax takes the first of equals, the longest segment.
            starts = np.arange(max(0, end - shortest - lengths + 1), end - shortest + 1)
            candidates = best[starts] + values[starts, end - shortest - starts]
            choice = int(np.argmax(candidates))
            best[end] = candidates[choice]
            previous[end] = starts[choice]
        ends = [frames - 1]
        while previous[ends[-1]] > 0:
            ends.append(int(previous[ends[-1]]))
        return ends[::-1]
