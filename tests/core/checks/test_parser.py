"""Every way to break the contract of a parser is found, and named."""

import itertools
from collections.abc import Callable

import numpy as np
import pytest

from prime_core.checks import CheckError, check_parser
from prime_core.contracts.parser import PairScores, ParsedSegment, Parser
from prime_core.parsing.dynamic_programming import DynamicProgrammingConfig
from prime_core.parsing.greedy import GreedyConfig


class Equal(Parser):
    """Cuts into pieces of the shortest length, the last one longer; `change` then spoils them."""

    def __init__(self, change: Callable[[list[ParsedSegment]], object] = lambda found: None):
        self.change = change

    def parse(self, scores: PairScores) -> list[ParsedSegment]:
        steps, shortest = len(scores.log_probability) - 1, scores.minimum_steps
        other = scores.log_probability.shape[2] - 1
        if steps < shortest:
            return [ParsedSegment(0, steps, other, 0.0)] if steps else []
        edges = [*range(0, steps - shortest + 1, shortest), steps]
        found = [ParsedSegment(start, end, 0, -1.0) for start, end in itertools.pairwise(edges)]
        return self.change(found) or found  # type: ignore[return-value]


class Draws(Equal):
    def parse(self, scores: PairScores) -> list[ParsedSegment]:
        found = super().parse(scores)
        if len(scores.log_probability) > scores.minimum_steps:
            found[0] = ParsedSegment(0, found[0].end, 0, float(np.random.default_rng().random()))
        return found


class Spoils(Equal):
    def parse(self, scores: PairScores) -> list[ParsedSegment]:
        scores.log_probability[...] = 0.0
        return super().parse(scores)


class IgnoresShort(Equal):
    def parse(self, scores: PairScores) -> list[ParsedSegment]:
        short = len(scores.log_probability) <= scores.minimum_steps
        return [] if short else super().parse(scores)


def label_nine(found: list[ParsedSegment]) -> list[ParsedSegment]:
    return [ParsedSegment(item.start, item.end, 9, 0.0) for item in found]


def not_a_number(found: list[ParsedSegment]) -> list[ParsedSegment]:
    return [ParsedSegment(item.start, item.end, 0, np.nan) for item in found]


def one_long(found: list[ParsedSegment]) -> list[ParsedSegment]:
    return [ParsedSegment(0, found[-1].end, 0, 0.0)]


def test_parsers_that_keep_the_contract_pass() -> None:
    check_parser(Equal())
    check_parser(GreedyConfig().build())
    check_parser(DynamicProgrammingConfig(rule="argmax").build(), seed=3)
    check_parser(DynamicProgrammingConfig().build(), minimum_steps=3, maximum_steps=9)


@pytest.mark.parametrize(
    ("parser", "text"),
    [
        (IgnoresShort(), r"of 1 steps, shorter than the shortest segment, returned \[\]: it must"),
        (Equal(list.pop), r"must return a list of ParsedSegment"),
        (Equal(lambda found: found[1:]), r"first must start at frame 0, each where the one before"),
        (Equal(one_long), r"each must have 5 to 200 steps"),
        (Equal(label_nine), r"classes \[9\].*0 to 3, the last of them `other`"),
        (Equal(not_a_number), r"log probability that is not a number"),
        (Draws(), r"other segments the second time: it must not draw"),
        (Spoils(), r"changed the scores"),
    ],
)
def test_a_broken_parser_is_told_what_would_be_right(parser: Parser, text: str) -> None:
    with pytest.raises(CheckError, match=text):
        check_parser(parser)
