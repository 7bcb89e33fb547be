"""Counts what became of parameter draws."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(eq=False)
class Draws:
    """How many parameter draws were tried and passed the success filter.

    Attributes:
        counts: ``(primitives, 2, 3)``: uniform draws, then draws from the prior; those drawn,
            those that were reachable and so tried, and those that succeeded.
    """

    counts: NDArray[np.int64]

    @classmethod
    def none(cls, primitives: int) -> "Draws":
        """Return counts of zero."""
        return cls(np.zeros((primitives, 2, 3), dtype=np.int64))

    def record(self, primitive: int, from_prior: bool, *, tried: bool, succeeded: bool) -> None:
        """Count one draw."""
        self.counts[primitive, int(from_prior)] += (1, int(tried), int(succeeded))
