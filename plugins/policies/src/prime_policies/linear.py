"""Robust linear fits that start from a copy of a feature."""

from dataclasses import dataclass
from math import inf

import torch
from torch import Tensor

from prime_policies.threads import one_thread

SCALE_FLOOR = 5e-4  # [m], [rad] or 1: features that vary less are taken as constant
HUBER = 1.345  # in standard deviations: residuals beyond it count less and less
ROUNDS = 10  # of reweighting, at most
SETTLED = 1e-3  # of the spread: what a round must change the line by to be worth another
RIDGES = (1e-2, 1.0, 1e2)  # in rows of data; chosen by cross-validation
LEAST_GAIN = 0.1  # share of a copy's error that a ridge must save
FOLDS = 4
MAXIMUM_ROWS = 20_000  # more rows do not make a line better, only slower
MAXIMUM_FOLD_ROWS = 3_000  # enough to tell the ridges apart


@dataclass(frozen=True, eq=False)
class LinearFit:
    """A linear function of features, and how far the data are from it.

    Attributes:
        weight: ``(outputs, inputs)``.
        bias: ``(outputs,)``.
        spread: Standard deviation of the residuals, ``(outputs,)``; that of `fit_linear`
            leaves outliers out.
        gate: The line is for where this weighted sum of the features, ``(inputs,)``, is
            `gate_value`, to within a half; zeros where it is for anywhere.
        gate_value: ``()``.
    """

    weight: Tensor
    bias: Tensor
    spread: Tensor
    gate: Tensor
    gate_value: Tensor

    @classmethod
    def zero(cls, inputs: Tensor, outputs: Tensor) -> "LinearFit":
        """Return zeros for inputs ``(n, inputs)`` and outputs ``(n, outputs)``."""
        count = outputs.shape[1]
        width = inputs.shape[1]
        lines = (inputs.new_zeros(shape) for shape in ((count, width), count, count))
        return cls(*lines, gate=inputs.new_zeros(width), gate_value=inputs.new_zeros(()))


def fit_linear(inputs: Tensor, outputs: Tensor, units: Tensor) -> LinearFit:
    """Fit outputs that follow from the inputs, but for a few outliers, by a line.

    Each output is first taken as one input plus a constant (or the constant alone), whichever
    has the smallest median error: a primitive's target is often the gripper's or an object's
    position plus an offset. A regression then corrects this copy, so that few data shrink to the
    copy and not to zero.

    All tensors are float64, for features that repeat each other leave few digits.

    Args:
        inputs: ``(n, inputs)``, in their units. Rows that follow each other may be alike.
        outputs: ``(n, outputs)``.
        units: How much an output changes where an input that is copied changes by one,
            ``(outputs,)``.
    """
    with one_thread():
        inputs, outputs = thin(inputs, MAXIMUM_ROWS), thin(outputs, MAXIMUM_ROWS)
        fit = LinearFit.zero(inputs, outputs)
        for row, output in enumerate(outputs.T):
            fit.weight[row] = _best_copy(inputs, output, units[row])
            rest = output - inputs @ fit.weight[row]
            slopes, fit.bias[row] = regress(inputs, rest)
            fit.weight[row] += slopes
            fit.spread[row] = _deviation(rest - inputs @ slopes - fit.bias[row])
        return fit


def regress(inputs: Tensor, output: Tensor) -> tuple[Tensor, Tensor]:
    """Fit an output by a ridge regression with Huber weights, as far as that is no chance.

    Args:
        inputs: ``(n, inputs)`` float64. Rows that follow each other may be alike.
        output: ``(n,)`` float64.

    Returns:
        Slopes ``(inputs,)``, zero where they would save little of the error on rows left out, and
        the constant ``()``.
    """
    if not inputs.numel():
        return inputs.new_zeros(inputs.shape[1]), output.median()
    centre, scale = inputs.median(dim=0).values, inputs.std(dim=0, correction=0)
    scale = torch.where(scale > SCALE_FLOOR, scale, torch.inf)
    design = torch.cat(((inputs - centre) / scale, inputs.new_ones(len(inputs), 1)), dim=1)
    solution = _huber_ridge(design, output, _best_ridge(design, output))
    slopes = solution[:-1] / scale
    return slopes, solution[-1] - slopes @ centre


def thin(rows: Tensor, maximum: int) -> Tensor:
    """Return every n-th row, so that no more are left than the maximum."""
    return rows[:: max(1, -(-len(rows) // maximum))]


def _best_copy(inputs: Tensor, output: Tensor, unit: Tensor) -> Tensor:
    """Return the weights ``(inputs,)`` of the input that an output is nearest to.

    Args:
        inputs: ``(n, inputs)``.
        output: ``(n,)``; may differ from the input by a constant.
        unit: The weight of an input that is copied. All are zero where none is nearer than the
            constant alone.
    """
    differences = torch.cat((output[:, None] - unit * inputs, output[:, None]), dim=1)
    errors = (differences - differences.median(dim=0).values).abs().median(dim=0).values
    best = int(errors.argmin())
    weights = inputs.new_zeros(inputs.shape[1])
    if errors[best] < errors[-1]:  # of equals, the constant
        weights[best] = unit
    return weights


def _best_ridge(design: Tensor, output: Tensor) -> float:
    """Return the ridge with the smallest median error on rows left out; infinite if none helps.

    A small gain is chance. By the mean, a few primitives that ended far from where they were
    called to would buy their own better fit with a worse one of all others. Rows are left out in
    blocks, because neighbours come from the same episode.
    """
    design, output = thin(design, MAXIMUM_FOLD_ROWS), thin(output, MAXIMUM_FOLD_ROWS)
    count = len(output)
    folds = torch.arange(count) * FOLDS // count
    errors = dict.fromkeys((inf, *RIDGES), 0.0)
    for fold in range(FOLDS if count >= FOLDS else 0):
        kept, left = folds != fold, folds == fold
        for ridge in errors:
            solution = _huber_ridge(design[kept], output[kept], ridge)
            errors[ridge] += float((output[left] - design[left] @ solution).abs().median())
    best = min(errors, key=lambda ridge: errors[ridge])
    return best if errors[best] < (1 - LEAST_GAIN) * errors[inf] else inf


def _huber_ridge(design: Tensor, output: Tensor, ridge: float) -> Tensor:
    """Return the coefficients ``(columns,)``; the last column, of ones, is not shrunk.

    An infinite ridge leaves the constant alone: the median, which is its robust fit.
    """
    solution = design.new_zeros(design.shape[1])
    solution[-1] = output.median()
    if ridge == inf:
        return solution
    penalty = torch.full_like(solution, ridge)
    penalty[-1] = 1e-9
    fitted = design @ solution
    for _ in range(ROUNDS):
        residual = output - fitted
        deviation = max(_deviation(residual), 1e-9)
        weights = (HUBER * deviation / residual.abs().clamp_min(1e-12)).clamp_max(1.0)
        weighted = design * weights[:, None]
        gram = weighted.T @ design + penalty.diag()
        solution = torch.linalg.solve(gram, weighted.T @ output)
        before, fitted = fitted, design @ solution
        if float((fitted - before).abs().mean()) < SETTLED * deviation:
            break
    return solution


def _deviation(residual: Tensor) -> float:
    """Return the standard deviation that the median absolute residual stands for."""
    return 1.4826 * float(residual.abs().median())
