"""Primitive parameters as the networks see them."""

import numpy as np

from prime_core.arrays import Floats, Indices
from prime_core.contracts.calls import Parameter, PrimitiveSpace
from prime_core.rotations import wrap_angle


class ParameterCodec:
    """Converts between parameters in their units and targets of about [-1, 1].

    A number without period becomes its place between its bounds, -1 at the lower and 1 at the
    upper one. An angle becomes its difference, the short way round, from the gripper's yaw: a
    target just across the wrap is then near zero like its neighbours. Both are divided by half
    the distance of the bounds, so that densities are those of parameters normalised to [-1, 1].

    Arrays of parameters and targets are ``(n, width)``, padded with zeros.

    Args:
        space: The primitives that have the parameters.

    Attributes:
        mask: Which parameters a primitive has, ``(primitives, width)`` bool.
        units: How much a target changes where its parameter changes by one unit,
            ``(primitives, width)``.
        periods: By which targets may differ and mean the same, ``(primitives, width)``; 0 for none.
    """

    def __init__(self, space: PrimitiveSpace) -> None:
        shape = (len(space.names), space.width)
        self.mask = np.zeros(shape, dtype=bool)
        self._low, self._high = np.zeros(shape), np.zeros(shape)
        self._half, self._period = np.ones(shape), np.full(shape, np.inf)
        for primitive, parameters in enumerate(space.parameter_spaces):
            for place, item in enumerate(parameters.parameters):
                self._add(primitive, place, item)
        self.units = 1 / self._half
        self.periods = np.where(np.isfinite(self._period), self._period, 0.0) / self._half

    def _add(self, primitive: int, place: int, item: Parameter) -> None:
        entry = (primitive, place)
        self.mask[entry] = True
        self._low[entry], self._high[entry] = item.low, item.high
        # A parameter whose bounds coincide is a constant: any scale does.
        self._half[entry] = (item.high - item.low) / 2 or 1.0
        if item.period is not None:
            self._period[entry] = item.period

    def targets(self, parameters: Floats, labels: Indices, yaws: Floats) -> Floats:
        """Return the targets of parameters.

        Args:
            parameters: ``(n, width)``.
            labels: The primitive of each, ``(n,)``.
            yaws: The gripper's yaw at the frame that angles are taken from [rad], ``(n,)``.
        """
        period = self._period[labels]
        periodic = np.isfinite(period)
        middle = (self._low[labels] + self._high[labels]) / 2
        offsets = parameters - np.where(periodic, yaws[:, None], middle)
        offsets[periodic] = wrap_angle(offsets[periodic], 1.0 * period[periodic])
        return np.where(self.mask[labels], offsets / self._half[labels], 0.0)

    def parameters(self, targets: Floats, labels: Indices, yaws: Floats) -> Floats:
        """Return the parameters of targets, brought within their bounds."""
        low, high, period = self._low[labels], self._high[labels], self._period[labels]
        periodic = np.isfinite(period)
        values = targets * self._half[labels]
        values += np.where(periodic, yaws[:, None], (low + high) / 2)
        # Of the angles that mean the same, the one nearest to the middle of the bounds: if that
        # is out of bounds, clipping it moves the direction least.
        middle = ((low + high) / 2)[periodic]
        values[periodic] = middle + wrap_angle(values[periodic] - middle, period[periodic])
        return np.where(self.mask[labels], np.clip(values, low, high), 0.0)
