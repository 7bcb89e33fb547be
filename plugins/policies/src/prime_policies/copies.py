"""Lines that copy the features of one object each, for targets that are chosen."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import pi
from typing import Self

import torch
from torch import Tensor

from prime_policies.linear import MAXIMUM_ROWS, LinearFit, regress, thin
from prime_policies.mixture import wrapped
from prime_policies.scene_features import FeatureEncoder
from prime_policies.threads import one_thread

NEAR = 0.2  # standard deviations of an output: what is further from a line is far from it
LEAST_SURPLUS = 1.1  # times as many outputs that must gather about a copy as about a constant
LEAST_SAVING = 0.3  # share of the constant's error that a copy must save: a small one is chance
LEAST_GAIN = 0.5  # outputs of a row that must come near a further line for the row to be its own
LEAST_SHARE = 0.05  # of the rows that must be a further line's own
MAXIMUM_START_ROWS = 2_000  # enough to see which features outputs gather about


@dataclass(frozen=True, eq=False)
class CopiedFeatures:
    """Which features lines may copy, and what they are about.

    Attributes:
        shared: Which any line may copy, ``(inputs,)`` bool.
        objects: Of each object, which others a line about it may copy, ``(inputs,)`` bool.
        held: The numbers of those that say whether an object is held.
    """

    shared: Tensor
    objects: Sequence[Tensor]
    held: Tensor

    @classmethod
    def of(cls, encoder: FeatureEncoder) -> Self:
        """Return those of a frame: where objects are, and angles from the gripper's yaw.

        Not where the gripper is. Inside a segment it comes ever nearer to the target, and a policy
        that copies it stays where it is.
        """

        def mask(numbers: Sequence[int]) -> Tensor:
            chosen = torch.zeros(encoder.width, dtype=torch.bool)
            chosen[list(numbers)] = True
            return chosen

        objects = [
            mask([*item.position, *([] if item.turn is None else [item.turn])])
            for item in encoder.objects
        ]
        held = torch.tensor([item.held for item in encoder.objects], dtype=torch.int64)
        return cls(mask([encoder.gripper_yaw]), objects, held)


def fit_copies(
    inputs: Tensor,
    outputs: Tensor,
    units: Tensor,
    periods: Tensor,
    features: CopiedFeatures,
    maximum: int,
) -> list[LinearFit]:
    """Fit outputs that are chosen, and do not follow from the inputs: copies and no more.

    A grasp goes to one box or to another: no one feature tells where. So there are lines for
    several objects, as far as outputs gather about their features. An object has several where it
    is gripped now this way, now that. Each thing that may be held has its own lines too, which are
    for where it is held and nowhere else: where a thing is put depends on what it is.

    A line gives each output as one feature (or less one feature) plus a constant, or as the
    constant alone, whichever has the smallest mean error over the rows that the line is nearest
    to. The median would hide that a copy is far off in a part of them. The few features that some
    output of a line copies may then correct all of its outputs: a push starts the further aside,
    the further an object is from where it has to go. A regression on all features finds
    coincidences among few demonstrations, such as a tilt of the object by a hundredth of a degree,
    and takes them far outside of what was demonstrated.

    Args:
        inputs: ``(n, inputs)`` float64, in their units.
        outputs: ``(n, outputs)`` float64.
        units: How much an output changes where an input that is copied changes by one,
            ``(outputs,)``.
        periods: By which outputs may differ and mean the same, ``(outputs,)``; 0 for none.
        features: What the inputs mean.
        maximum: Lines at most.

    Returns:
        First the line that most outputs are near, then those that outputs far from the ones
        before gather about; so for each thing that may be held, the most frequent one first.
    """
    with one_thread():
        inputs, outputs = thin(inputs, MAXIMUM_ROWS), thin(outputs, MAXIMUM_ROWS)
        gate = inputs.new_zeros(inputs.shape[1])
        gate[features.held] = torch.arange(1, len(features.held) + 1, dtype=gate.dtype)
        what = inputs @ gate
        often = _often(what)
        lines = []
        for value in often[:maximum]:
            rows = what == value
            copies = _Copies(inputs[rows], outputs[rows], units, periods)
            found = _gather(copies, features, max(1, maximum // len(often)))
            lines += [replace(line, gate=gate, gate_value=value) for line in found]
        return lines


def _often(values: Tensor) -> Tensor:
    """Return which values ``(n,)`` are frequent, the most frequent one always, and first."""
    different, counts = values.unique(return_counts=True)
    order = counts.argsort(descending=True, stable=True)
    frequent = counts[order] >= LEAST_SHARE * len(values)
    frequent[:1] = True
    return different[order[frequent]]


def _gather(copies: "_Copies", features: CopiedFeatures, maximum: int) -> list[LinearFit]:
    """Return the lines that outputs gather about, the one with the most first."""
    objects = features.objects or [torch.zeros_like(features.shared)]
    chosen: list[Tensor] = []
    errors: list[Tensor] = []
    least, far = copies.nothing_near()
    while len(chosen) < maximum:
        starts = [copies.gathered(features.shared | item, far) for item in objects]
        found = [copies.errors(start) for start in starts]
        gains = [item.sum(dim=1) < least - LEAST_GAIN for item in found]
        counts = [
            int(gain.sum()) if not chosen or _is_about(start, item) else 0
            for gain, start, item in zip(gains, starts, objects, strict=True)
        ]
        best = max(range(len(starts)), key=lambda index: counts[index])
        if chosen and counts[best] < LEAST_SHARE * len(least):
            break
        chosen.append(objects[best])
        errors.append(found[best])
        least = torch.minimum(least, errors[-1].sum(dim=1))
        far &= errors[-1].amax(dim=1) >= 1.0
    return _refitted(copies, features, chosen, errors)


def _is_about(fit: LinearFit, item: Tensor) -> bool:
    """Whether a line copies an object's features ``(inputs,)`` bool.

    A further line that does not would only cut noise in pieces.
    """
    return bool(fit.weight[:, item].any())


def _refitted(
    copies: "_Copies", features: CopiedFeatures, chosen: list[Tensor], errors: list[Tensor]
) -> list[LinearFit]:
    """Return the lines of chosen objects, fitted to the rows nearest to each.

    Args:
        copies: Fits them.
        features: What the inputs mean.
        chosen: Features of each line's object.
        errors: Of each line before, ``(n, outputs)``.
    """
    nearest = torch.stack(errors).sum(dim=2).argmin(dim=0)
    lines = [
        copies.fitted(features.shared | item, nearest == index) for index, item in enumerate(chosen)
    ]
    kept = [
        index
        for index, (line, item) in enumerate(zip(lines, chosen, strict=True))
        if bool((nearest == index).any()) and (index == 0 or _is_about(line, item))
    ]
    if len(kept) == len(chosen):
        return lines
    kept = kept or [0]
    return _refitted(copies, features, [chosen[i] for i in kept], [errors[i] for i in kept])


class _Copies:
    """Lines of some inputs and outputs.

    Args:
        inputs: ``(n, inputs)``.
        outputs: ``(n, outputs)``.
        units: ``(outputs,)``.
        periods: ``(outputs,)``.
    """

    def __init__(self, inputs: Tensor, outputs: Tensor, units: Tensor, periods: Tensor) -> None:
        self._inputs, self._outputs = inputs, outputs
        self._units, self._periods = units, periods
        self._near = NEAR * outputs.std(dim=0, correction=0).clamp_min(1e-9)

    def nothing_near(self) -> tuple[Tensor, Tensor]:
        """Return the sum of errors where no line is near, and that all rows are far, ``(n,)``."""
        count, width = self._outputs.shape
        return self._outputs.new_full((count,), float(width)), torch.ones(count, dtype=torch.bool)

    def errors(self, fit: LinearFit) -> Tensor:
        """Return how far outputs are from a line, from 0 to 1: far, ``(n, outputs)``."""
        errors = wrapped(self._outputs - self._inputs @ fit.weight.T - fit.bias, self._periods)
        return (errors.abs() / self._near).clamp_max(1.0)

    def gathered(self, group: Tensor, rows: Tensor) -> LinearFit:
        """Return the line that has the most outputs, each for itself, near it.

        Args:
            group: Which inputs may be copied, ``(inputs,)`` bool.
            rows: Which rows count, ``(n,)`` bool.
        """
        fit = LinearFit.zero(self._inputs, self._outputs)
        if not rows.any():
            return fit
        choices = _choices(group)
        outputs = thin(self._outputs[rows], MAXIMUM_START_ROWS)
        copied = thin(self._inputs[rows], MAXIMUM_START_ROWS) @ choices.T
        for row, near in enumerate(self._near):
            rest = outputs[:, row, None] - self._units[row] * copied
            count, period = len(rest), float(self._periods[row])
            rest = wrapped(rest, self._periods[row]).sort(dim=0).values
            if period:  # What gathers about the wrap gathers about one value.
                rest = torch.cat((rest, rest + period))
            ends = torch.searchsorted(rest.T.contiguous(), (rest + 2 * near).T.contiguous())
            counts = ends.T - torch.arange(len(rest))[:, None]
            most, first = counts[:count].max(dim=0)
            best = int(most.argmax()) if most.max() > LEAST_SURPLUS * most[0] else 0
            fit.weight[row] = self._units[row] * choices[best]
            fit.bias[row] = rest[first[best] : first[best] + most[best], best].median()
        return fit

    def fitted(self, group: Tensor, rows: Tensor) -> LinearFit:
        """Return the line with the smallest mean error; see `gathered`."""
        fit = LinearFit.zero(self._inputs, self._outputs)
        if not rows.any():
            return fit
        choices = _choices(group)
        inputs, outputs = self._inputs[rows], self._outputs[rows]
        choosable = inputs @ choices.T
        for row, unit in enumerate(self._units):
            rest = _about_one_value(outputs[:, row, None] - unit * choosable, self._periods[row])
            means = (rest - rest.median(dim=0).values).abs().mean(dim=0)
            best = int(means.argmin()) if means.min() < (1 - LEAST_SAVING) * means[0] else 0
            fit.weight[row] = unit * choices[best]
        copied = fit.weight.any(dim=0)
        for row, output in enumerate(outputs.T):
            rest = output - inputs @ fit.weight[row]
            rest = _about_one_value(rest[:, None], self._periods[row])[:, 0]
            slopes, fit.bias[row] = regress(inputs[:, copied], rest)
            fit.weight[row, copied] += slopes
            rest = output - inputs @ fit.weight[row] - fit.bias[row]
            fit.spread[row] = wrapped(rest, self._periods[row]).std(correction=0)
        return fit


def _about_one_value(values: Tensor, period: Tensor) -> Tensor:
    """Return values ``(n, columns)`` less periods that bring each column about one value."""
    if not period:
        return values
    angles = values * (2 * pi / period)
    centre = torch.atan2(angles.sin().mean(dim=0), angles.cos().mean(dim=0)) * (period / (2 * pi))
    return centre + wrapped(values - centre, period)


def _choices(group: Tensor) -> Tensor:
    """Return the weights of what may be copied, ``(choices, inputs)``: first nothing at all."""
    copies = torch.eye(len(group), dtype=torch.float64)[group]
    return torch.cat((copies.new_zeros(1, len(group)), copies, -copies))
