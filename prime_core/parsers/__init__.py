"""The parsers of the paper: dynamic programming, and the greedy one to compare with."""

from prime_core.parsers.dynamic_programming import DynamicProgrammingConfig
from prime_core.parsers.greedy import GreedyConfig
from prime_core.parsers.scored import ScoredParserConfig

__all__ = ["DynamicProgrammingConfig", "GreedyConfig", "ScoredParserConfig"]
