"""The contract of a parser: from pair scores to the best primitive sequence."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import model_validator

from prime_core.configuration import Config, Count


@dataclass(frozen=True, eq=False)
class PairScores:
    """Log probabilities of all pairs of a demonstration's frames, by length.

    Attributes:
        log_probability: ``(frames, lengths, classes)``: entry ``[t, k, p]`` is that of class
            ``p`` leading from frame ``t`` to frame ``t + minimum_steps + k``; the last class is
            `other`. Pairs that end after the last frame hold -inf.
        minimum_steps: Length of the shortest segment.
    """

    log_probability: NDArray[np.float64]
    minimum_steps: int


@dataclass(frozen=True)
class ParsedSegment:
    """A segment as a parser finds it; `label` is a class, the last class is `other`."""

    start: int
    end: int
    label: int
    log_probability: float


class Parser(ABC):
    """Cuts a demonstration into segments."""

    @abstractmethod
    def parse(self, scores: PairScores) -> list[ParsedSegment]:
        """Return the segments, in order.

        They cover the demonstration: the first starts at frame 0, each starts where the one
        before ends, the last ends at the last frame. A demonstration shorter than the shortest
        segment is one segment of `other` (with log probability 0); one frame is none.
        """


class ParserConfig(Config):
    """Settings that all parsers share; what packs register."""

    minimum_steps: Count = 5
    """Motor actions of the shortest segment."""
    maximum_steps: Count = 200
    """Motor actions of the longest segment."""
    score: Literal["type", "joint"] = "type"
    """``type`` scores a pair by IDM_prim(p | s, s') alone, as the authors' release does;
    ``joint`` by IDM_prim times IDM_param of the most likely parameters, as in paper equation 1.
    Pairs of `other` have no parameters."""

    @model_validator(mode="after")
    def _lengths_cover_everything(self) -> "ParserConfig":
        if self.maximum_steps < 2 * self.minimum_steps - 1:
            raise ValueError(
                f"maximum_steps is {self.maximum_steps}: it must be at least "
                f"{2 * self.minimum_steps - 1} (twice minimum_steps, less one), or some "
                "demonstrations could not be cut at all"
            )
        return self

    @abstractmethod
    def build(self) -> Parser:
        """Make the parser."""
