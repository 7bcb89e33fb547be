"""What the numbers of a primitive's parameters are: points, angles, or plain numbers."""

from dataclasses import dataclass

import numpy as np

from prime_core.arrays import Floats
from prime_core.contracts.calls import ParameterSpace
from prime_core.rotations import wrap_angle

POINTS = (("x", "y", "z"), ("dx", "dy", "dz"))
"""Names of coordinates: of a point, and of the displacement from it to a second point."""
YAW = "yaw"


@dataclass(frozen=True)
class Group:
    """Numbers that share a precision.

    Attributes:
        kind: ``plane`` (two coordinates of a point, in the plane), ``height`` (its third),
            ``angle``, or ``number``.
        places: Which numbers they are.
    """

    kind: str
    places: tuple[int, ...]


class ParameterLayout:
    """The groups of a primitive's parameters, and targets of networks made of them.

    A displacement is learnt as a point, so that all points are alike: the one where it ends, or
    one that lies a way ahead of that. Targets are in the parameters' units; ``scales`` bring them
    to about [-1, 1].

    Args:
        space: Parameters by the field's names (`POINTS`, `YAW`); others are plain numbers.
        ahead: How far ahead [m].

    Attributes:
        groups: Of the numbers.
        ends: Which numbers are learnt of a displacement.
        scales: Half of the range of each number, the same for both in a plane, ``(P,)``.
        periods: After which angles repeat [rad], ``(P,)``; 0 for other numbers.
        density_shift: What is added to a log density of targets over ``scales`` for the one of
            parameters normalised to [-1, 1].
    """

    def __init__(self, space: ParameterSpace, ahead: float = 0.0) -> None:
        self._space, self._ahead = space, ahead
        places = {item.name: place for place, item in enumerate(space.parameters)}
        groups: list[Group] = []
        for x, y, z in POINTS:
            if x in places and y in places:
                groups.append(Group("plane", (places[x], places[y])))
            if z in places:
                groups.append(Group("height", (places[z],)))
        taken = {place for group in groups for place in group.places}
        for place, item in enumerate(space.parameters):
            if place not in taken:
                angle = item.name == YAW and item.period is not None
                groups.append(Group("angle" if angle else "number", (place,)))
        self.groups = tuple(groups)
        pairs = list(zip(*POINTS, strict=True))
        whole = all(name in places for pair in pairs for name in pair)
        self._starts = [places[start] for start, _ in pairs if whole]
        self.ends = [places[move] for _, move in pairs if whole]
        self.periods = np.array([item.period or 0.0 for item in space.parameters])
        halves = np.maximum((space.high - space.low) / 2, 1e-6)
        self.scales = halves.copy()
        for group in self.groups:
            self.scales[list(group.places)] = halves[list(group.places)].max()
        self.density_shift = float(np.log(halves / self.scales).sum())

    def targets(self, parameters: Floats) -> Floats:
        """Return what networks learn for parameters ``(n, P)``."""
        result = np.array(parameters, dtype=np.float64)
        moves = _lengthened(result[:, self.ends], self._ahead)
        result[:, self.ends] = result[:, self._starts] + moves
        return result

    def parameters(self, targets: Floats) -> Floats:
        """Return the parameters of targets ``(n, P)``, brought within their bounds."""
        result = np.array(targets, dtype=np.float64)
        low, high = self._space.low, self._space.high
        for place, period in enumerate(self.periods):
            if period:
                middle = (low[place] + high[place]) / 2
                result[:, place] = middle + wrap_angle(result[:, place] - middle, period)
        moves = result[:, self.ends] - result[:, self._starts]
        result[:, self.ends] = _lengthened(moves, -self._ahead)
        return np.clip(result, low, high)


def _lengthened(moves: Floats, by: float) -> Floats:
    """Return displacements ``(n, 3)`` that are longer, or shorter down to nothing [m]."""
    lengths = np.linalg.norm(moves, axis=1, keepdims=True)
    result: Floats = moves * np.maximum(1.0 + by / np.maximum(lengths, 1e-6), 0.0)
    return result
