"""How sure the scores are of each segment of a parsed demonstration: two doubts, multiplied.

Does the primitive lead from where the segment begins to where it ends? That is the inverse dynamics
model's own probability for the two frames, `other` among the classes.

Could another primitive have been at work? Of each primitive the best segmentation into primitives
is looked for in which it covers a motor action, by dynamic programming from both ends
(max-marginals; Wainwright and Jordan, "Graphical models, exponential families, and variational
inference", 2008). The probabilities of these, over their sum, are the primitives' shares of the
action. `other` has none: of two frames with several primitives between them it is always true, so
that a demonstration which is all `other` is never an unlikely one.
"""

from collections.abc import Sequence

import numpy as np

from prime_core.arrays import Floats
from prime_core.contracts.parser import PairScores, ParsedSegment
from prime_core.parsing.scored import IMPOSSIBLE


def segment_confidences(scores: PairScores, segments: Sequence[ParsedSegment]) -> list[float]:
    """Return a confidence for each segment.

    Of a primitive it is its probability for the segment's two ends, times its share of the
    segment's motor actions, on average; of `other` the probability alone.

    Args:
        scores: Of all pairs of the demonstration.
        segments: As a parser cut it.

    Returns:
        Of each, in [0, 1]; 0 where nothing was scored, as in a demonstration shorter than the
        shortest segment.
    """
    other = scores.log_probability.shape[2] - 1
    shares = primitive_shares(scores)
    found = []
    for item in segments:
        length = item.end - item.start - scores.minimum_steps
        if length < 0:
            found.append(0.0)
            continue
        # With the densities of parameters in them, scores do not sum to 1.
        values = np.maximum(scores.log_probability[item.start, length], IMPOSSIBLE)
        weights = np.exp(values - values.max())
        probability = weights[item.label] / weights.sum()
        share = 1.0 if item.label == other else shares[item.start : item.end, item.label].mean()
        found.append(float(probability * share))
    return found


def primitive_shares(scores: PairScores) -> Floats:
    """Return how likely each primitive is at each motor action, as above.

    Args:
        scores: Of all pairs of a demonstration.

    Returns:
        ``(frames - 1, primitives)``; rows sum to 1.
    """
    given = np.maximum(scores.log_probability[..., :-1], IMPOSSIBLE)
    frames, lengths, primitives = given.shape
    shortest = scores.minimum_steps
    best = np.full((frames - 1, primitives), -np.inf)
    if not primitives:
        return best
    before, after = _best_ends(given.max(axis=2), shortest)
    for start in range(frames - shortest):
        count = min(lengths, frames - start - shortest)
        ends = start + shortest + np.arange(count)
        whole = before[start] + given[start, :count] + after[ends, None]
        # Of the segments from here, those that cover an action end after it.
        longer = np.maximum.accumulate(whole[::-1])[::-1]
        actions = np.arange(shortest + count - 1)
        covered = best[start : start + len(actions)]
        np.maximum(covered, longer[np.maximum(0, actions + 1 - shortest)], out=covered)
    best[np.isneginf(best).all(axis=1)] = 0.0  # in no segment that is scored
    shares = np.exp(best - best.max(axis=1, keepdims=True))
    result: Floats = shares / shares.sum(axis=1, keepdims=True)
    return result


def _best_ends(values: Floats, shortest: int) -> tuple[Floats, Floats]:
    """Return log values of the best segmentations up to and from each frame, ``(frames,)`` each.

    Args:
        values: Of the best primitive of each pair, ``(frames, lengths)``.
        shortest: Motor actions of the shortest segment.
    """
    frames, lengths = values.shape
    before, after = np.full(frames, -np.inf), np.full(frames, -np.inf)
    before[0] = after[-1] = 0.0
    for end in range(shortest, frames):
        starts = np.arange(max(0, end - shortest - lengths + 1), end - shortest + 1)
        before[end] = np.max(before[starts] + values[starts, end - shortest - starts])
    for start in range(frames - 1 - shortest, -1, -1):
        count = min(lengths, frames - start - shortest)
        after[start] = np.max(values[start, :count] + after[start + shortest + np.arange(count)])
    return before, after
