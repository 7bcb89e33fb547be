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
FOLDS = 4
MAXIMUM_ROWS = 20_000  # more rows do not make a line better, only slower
MAXIMUM_FOLD_ROWS = 3_000  # enough to tell the ridges apart


@dataclass(frozen=True, eq=False)
class LinearFit:
    """A linear function of features, and how far the data are from it.

    Attributes:
        weight: ``(outputs, inputs)``.
        bias: ``(outputs,)``.
        spread: Standard deviation of the residuals, outliers left out, ``(outputs,)``.
    """

    weight: Tensor
    bias: Tensor
    spread: Tensor


def fit_linear(
    inputs: Tensor,
    outputs: Tensor,
    units: Tensor,
    start: LinearFit | None = None,
    outliers: bool = False,
) -> LinearFit:
    """Fit outputs as a linear function of inputs.

    Each output is first taken as one input plus a constant (or the constant alone), whichever
    has the smallest median error: a primitive's target is often the gripper's or an object's
    position plus an offset. A ridge regression with Huber weights then corrects this copy, so
    that few data shrink to the copy and not to zero.

    All tensors are float64, for features that repeat each other leave few digits.

    Args:
        inputs: ``(n, inputs)``, in their units. Rows that follow each other may be alike.
        outputs: ``(n, outputs)``.
        units: How much an output changes where an input that is copied changes by one,
            ``(outputs,)``.
        start: An earlier fit to other data, whose outputs may be copied too. Where they are, and
            need no correction but a constant, its spread is kept.
        outliers: Whether outputs follow from the inputs but for a few outliers.
    """
    with one_thread():
        return _fit(
            _thin(inputs, MAXIMUM_ROWS), _thin(outputs, MAXIMUM_ROWS), units, start, outliers
        )


def _fit(
    inputs: Tensor, outputs: Tensor, units: Tensor, start: LinearFit | None, outliers: bool
) -> LinearFit:
    centre, scale = inputs.median(dim=0).values, inputs.std(dim=0, correction=0)
    scale = torch.where(scale > SCALE_FLOOR, scale, torch.inf)
    design = torch.cat(((inputs - centre) / scale, inputs.new_ones(len(inputs), 1)), dim=1)
    count = outputs.shape[1]
    weight, bias = inputs.new_zeros(count, inputs.shape[1]), inputs.new_zeros(count)
    spread = inputs.new_zeros(count)
    for row in range(count):
        copies = units[row] * torch.eye(inputs.shape[1], dtype=inputs.dtype)
        if start is not None:
            copies = torch.cat((copies, start.weight[row : row + 1]))
        weight[row], copied = _best_copy(inputs, outputs[:, row], copies)
        rest = outputs[:, row] - inputs @ weight[row]
        ridge = _best_ridge(design, rest, outliers)
        solution = _huber_ridge(design, rest, ridge)
        weight[row] += solution[:-1] / scale
        bias[row] = solution[-1] - (solution[:-1] / scale) @ centre
        spread[row] = _deviation(rest - design @ solution)
        if start is not None and copied == inputs.shape[1] and ridge == inf:
            spread[row] = start.spread[row]
    return LinearFit(weight, bias, spread)


def _thin(rows: Tensor, maximum: int) -> Tensor:
    return rows[:: max(1, -(-len(rows) // maximum))]


def _best_copy(inputs: Tensor, output: Tensor, copies: Tensor) -> tuple[Tensor, int]:
    """Return the weights that an output is nearest to, up to a constant, and which they are.

    Args:
        inputs: ``(n, inputs)``.
        output: ``(n,)``.
        copies: Weights to choose from, ``(copies, inputs)``. Where none is nearer than the
            constant alone, all weights are zero, and which they are is -1.
    """
    copies = torch.cat((copies, copies.new_zeros(1, copies.shape[1])))
    differences = output[:, None] - inputs @ copies.T
    errors = (differences - differences.median(dim=0).values).abs().median(dim=0).values
    # Of equals, the constant.
    best = int(errors.argmin()) if errors.min() < errors[-1] else -1
    return copies[best].clone(), best


def _best_ridge(design: Tensor, output: Tensor, outliers: bool) -> float:
    """Return the ridge with the smallest error on rows left out; infinite if none helps.

    With outliers that is the median error: a few primitives that ended far from where they were
    called to would otherwise buy their own better fit with a worse one of all others.

    Rows are left out in blocks, because neighbours come from the same episode.
    """
    design, output = _thin(design, MAXIMUM_FOLD_ROWS), _thin(output, MAXIMUM_FOLD_ROWS)
    count = len(output)
    folds = torch.arange(count) * FOLDS // count
    errors = dict.fromkeys((inf, *RIDGES), 0.0)
    for fold in range(FOLDS if count >= FOLDS else 0):
        kept, left = folds != fold, folds == fold
        for ridge in errors:
            solution = _huber_ridge(design[kept], output[kept], ridge)
            rest = (output[left] - design[left] @ solution).abs()
            errors[ridge] += float(rest.median() if outliers else rest.sum())
    return min(errors, key=lambda ridge: errors[ridge])


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
