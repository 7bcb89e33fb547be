"""Primitive calls, and the parameters they have."""

from dataclasses import dataclass

import numpy as np

from prime_core.arrays import Array

OTHER = "other"
"""Category of segments that no primitive explains."""


@dataclass(frozen=True)
class Parameter:
    """One number of a primitive.

    Attributes:
        name: For example ``"x"``.
        unit: ``"m"`` or ``"rad"``.
        low: Least value, in the unit.
        high: Greatest value, in the unit.
        period: What an angle repeats after [rad], or None for other numbers.
    """

    name: str
    unit: str
    low: float
    high: float
    period: float | None = None


@dataclass(frozen=True)
class ParameterSpace:
    """The parameters of a primitive, in order."""

    parameters: tuple[Parameter, ...]

    def __len__(self) -> int:
        return len(self.parameters)

    @property
    def low(self) -> Array:
        """Least values, ``(P,)``."""
        return np.array([item.low for item in self.parameters])

    @property
    def high(self) -> Array:
        """Greatest values, ``(P,)``."""
        return np.array([item.high for item in self.parameters])

    def contains(self, values: Array) -> bool:
        """Whether parameters ``(P,)`` lie within their bounds."""
        slack = 1e-9
        return bool(np.all(values >= self.low - slack) and np.all(values <= self.high + slack))

    def difference(self, left: Array, right: Array) -> Array:
        """Return ``left - right``, angles the short way round.

        Args:
            left: ``(..., P)``.
            right: ``(..., P)``.

        Returns:
            ``(..., P)``, in the parameters' units.
        """
        result = np.asarray(left - right, dtype=np.float64)
        for index, item in enumerate(self.parameters):
            if item.period is not None:
                angle = result[..., index]
                result[..., index] = (angle + item.period / 2) % item.period - item.period / 2
        return result

    def sample(self, generator: np.random.Generator) -> Array:
        """Draw parameters ``(P,)`` uniformly within their bounds."""
        return generator.uniform(self.low, self.high)


@dataclass(frozen=True, eq=False)
class PrimitiveCall:
    """A primitive to run, and with what.

    Attributes:
        primitive: Its name, such as ``"grasp"``.
        parameters: ``(P,)``, in the units of its parameter space, world frame.
    """

    primitive: str
    parameters: Array


@dataclass(frozen=True)
class PrimitiveSpace:
    """The primitives that a model tells apart.

    Class ``i`` is ``names[i]``; class ``len(names)`` is `other`.
    """

    names: tuple[str, ...]
    parameter_spaces: tuple[ParameterSpace, ...]

    @property
    def width(self) -> int:
        """Length of the longest parameter vector; shorter ones are padded with zeros."""
        return max((len(space) for space in self.parameter_spaces), default=0)
