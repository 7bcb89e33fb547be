"""The contract of a parser."""

import numpy as np

from prime_core.checks.requirement import require
from prime_core.contracts.parser import PairScores, ParsedSegment, Parser

CLASSES = 4


def check_parser(
    parser: Parser, minimum_steps: int = 5, maximum_steps: int = 200, seed: int = 0
) -> None:
    """Check on random scores that a parser keeps its contract; see `prime_core.contracts.parser`.

    Args:
        parser: What to check.
        minimum_steps: Motor actions of the shortest segment; as in its settings.
        maximum_steps: Motor actions of the longest segment; as in its settings.
        seed: Of the scores.

    Raises:
        CheckError: If it breaks the contract.
    """
    generator = np.random.default_rng(seed)
    near = {minimum_steps - 1, minimum_steps, minimum_steps + 1, 2 * minimum_steps - 1}
    far = {2 * minimum_steps, maximum_steps, maximum_steps + 1, maximum_steps + minimum_steps}
    for steps in sorted({0, 1, 40, *near, *far}):
        _check_demonstration(parser, steps, minimum_steps, maximum_steps, generator)


def _check_demonstration(
    parser: Parser, steps: int, shortest: int, longest: int, generator: np.random.Generator
) -> None:
    shape = (steps + 1, longest - shortest + 1)
    values = np.log(generator.dirichlet(np.ones(CLASSES), shape))
    starts, lengths = np.indices(shape)
    values[starts + lengths + shortest > steps] = -np.inf
    given = values.copy()
    found = parser.parse(PairScores(given, shortest))
    subject = f"parse() of a demonstration of {steps} steps"
    require(
        np.array_equal(given, values), f"{subject} changed the scores: it must leave them alone"
    )
    require(
        isinstance(found, list) and all(isinstance(item, ParsedSegment) for item in found),
        f"{subject} returned {found!r}: it must return a list of ParsedSegment",
    )
    if steps < shortest:
        expected = [ParsedSegment(0, steps, CLASSES - 1, 0.0)] if steps else []
        require(
            found == expected,
            f"{subject}, shorter than the shortest segment, returned {found}: it must return "
            f"{expected}",
        )
        return
    _check_segments(found, steps, shortest, longest, subject)
    again = parser.parse(PairScores(values, shortest))
    require(found == again, f"{subject} returned other segments the second time: it must not draw")


def _check_segments(
    found: list[ParsedSegment], steps: int, shortest: int, longest: int, subject: str
) -> None:
    edges = [(item.start, item.end) for item in found]
    ends = [0, *(end for _, end in edges)]
    require(
        ends[-1] == steps and [start for start, _ in edges] == ends[:-1],
        f"{subject} returned segments {edges}: the first must start at frame 0, each where the "
        f"one before ends, and the last must end at frame {steps}",
    )
    require(
        all(shortest <= end - start <= longest for start, end in edges),
        f"{subject} returned segments {edges}: each must have {shortest} to {longest} steps",
    )
    labels = [item.label for item in found]
    require(
        all(0 <= label < CLASSES for label in labels),
        f"{subject} returned classes {labels}: with {CLASSES} classes in the scores they must be "
        f"0 to {CLASSES - 1}, the last of them `other`",
    )
    require(
        not any(np.isnan(item.log_probability) for item in found),
        f"{subject} returned a log probability that is not a number",
    )
