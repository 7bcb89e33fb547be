"""Lines that copy the features of one object each, for targets that are chosen."""

from collections.abc import Sequence

import torch
from torch import Tensor

from prime_policies.linear import MAXIMUM_ROWS, LinearFit, thin
from prime_policies.threads import one_thread

NEAR = 0.2  # standard deviations of an output: what is further from a line is far from it
LEAST_SAVING = 0.2  # share of the constant's error that a copy must save: a small one is chance
LEAST_GAIN = 0.5  # outputs of a row that must come near a further line for the row to be its own
LEAST_SHARE = 0.05  # of the rows that must be a further line's own
MAXIMUM_START_ROWS = 2_000  # enough to see which features outputs gather about


def fit_copies(
    inputs: Tensor, outputs: Tensor, units: Tensor, shared: Tensor, groups: Sequence[Tensor]
) -> list[LinearFit]:
    """Fit outputs that are chosen, and do not follow from the inputs: copies and no more.

    A grasp goes to one box or to another: no one feature tells where. So there are lines for
    several groups of features, those of one object each, as far as outputs gather about them. A
    line gives each output as one feature (or less one feature) plus a constant, or as the constant
    alone, whichever has the smallest mean error over the rows that the line is nearest to. The
    median would hide that a copy is far off in a part of them. A regression on top finds
    coincidences among the few demonstrations, such as a tilt of the object by a hundredth of a
    degree, and takes them far outside of what was demonstrated.

    Args:
        inputs: ``(n, inputs)`` float64, in their units.
        outputs: ``(n, outputs)`` float64.
        units: How much an output changes where an input that is copied changes by one,
            ``(outputs,)``.
        shared: Which inputs any line may copy, ``(inputs,)`` bool.
        groups: Of each object, which others its line may copy, ``(inputs,)`` bool.

    Returns:
        First the line that most outputs are near, then those about objects that outputs far
        from the ones before gather about.
    """
    with one_thread():
        inputs, outputs = thin(inputs, MAXIMUM_ROWS), thin(outputs, MAXIMUM_ROWS)
        copies = _Copies(inputs, outputs, units)
        left, chosen, errors = list(groups or [shared]), [], []
        least = inputs.new_full((len(inputs),), float(outputs.shape[1]))
        while left:
            far = least > LEAST_GAIN
            starts = [copies.gathered(shared | group, far) for group in left]
            gains = [copies.errors(start) < least - LEAST_GAIN for start in starts]
            if chosen:  # A further line must be about its object.
                gains = [
                    gain & bool(start.weight[:, group].any())
                    for gain, start, group in zip(gains, starts, left, strict=True)
                ]
            best = max(range(len(left)), key=lambda index: int(gains[index].sum()))
            if chosen and int(gains[best].sum()) < LEAST_SHARE * len(inputs):
                break
            chosen.append(shared | left.pop(best))
            errors.append(copies.errors(starts[best]))
            least = torch.minimum(least, errors[-1])
        nearest = torch.stack(errors).argmin(dim=0)
        return [copies.fitted(group, nearest == index) for index, group in enumerate(chosen)]


class _Copies:
    """Lines of some inputs and outputs.

    Args:
        inputs: ``(n, inputs)``.
        outputs: ``(n, outputs)``.
        units: ``(outputs,)``.
    """

    def __init__(self, inputs: Tensor, outputs: Tensor, units: Tensor) -> None:
        self._inputs, self._outputs, self._units = inputs, outputs, units
        self._near = NEAR * outputs.std(dim=0, correction=0).clamp_min(1e-9)

    def errors(self, fit: LinearFit) -> Tensor:
        """Return how many outputs of each row are far from a line, fractions included, ``(n,)``."""
        errors = (self._outputs - self._inputs @ fit.weight.T - fit.bias).abs() / self._near
        return errors.clamp_max(1.0).sum(dim=1)

    def gathered(self, group: Tensor, rows: Tensor) -> LinearFit:
        """Return the line that has the most outputs, each for itself, near it.

        Args:
            group: Which inputs may be copied, ``(inputs,)`` bool.
            rows: Which rows count, ``(n,)`` bool.
        """
        fit = LinearFit.zero(self._inputs, self._outputs)
        choices = _choices(group)
        for row, near in enumerate(self._near):
            rest = thin(self._differences(row, choices, rows), MAXIMUM_START_ROWS)
            if not len(rest):
                break
            rest = rest.sort(dim=0).values
            ends = torch.searchsorted(rest.T.contiguous(), (rest + 2 * near).T.contiguous())
            counts = ends.T - torch.arange(len(rest))[:, None]
            most, first = counts.max(dim=0)
            best = int(most.argmax())
            fit.weight[row] = self._units[row] * choices[best]
            fit.bias[row] = rest[first[best] : first[best] + most[best], best].median()
        return fit

    def fitted(self, group: Tensor, rows: Tensor) -> LinearFit:
        """Return the line with the smallest mean error; see `gathered`."""
        fit = LinearFit.zero(self._inputs, self._outputs)
        choices = _choices(group)
        for row, unit in enumerate(self._units):
            rest = self._differences(row, choices, rows)
            centres = rest.median(dim=0).values
            means = (rest - centres).abs().mean(dim=0)
            best = int(means.argmin()) if means.min() < (1 - LEAST_SAVING) * means[0] else 0
            fit.weight[row], fit.bias[row] = unit * choices[best], centres[best]
            fit.spread[row] = (rest[:, best] - centres[best]).std(correction=0)
        return fit

    def _differences(self, output: int, choices: Tensor, rows: Tensor) -> Tensor:
        """Return an output of some rows less each choice, ``(rows, choices)``."""
        copied = self._inputs[rows] @ choices.T
        return self._outputs[rows, output, None] - self._units[output] * copied


def _choices(group: Tensor) -> Tensor:
    """Return the weights of what may be copied, ``(choices, inputs)``: first nothing at all."""
    copies = torch.eye(len(group), dtype=torch.float64)[group]
    return torch.cat((copies.new_zeros(1, len(group)), copies, -copies))
