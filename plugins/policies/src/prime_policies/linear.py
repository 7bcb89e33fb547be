"""Robust linear fits that start from a copy of a feature."""

from dataclasses import dataclass

import numpy as np

from prime_core.idm import Floats

SCALE_FLOOR = 1e-2  # [m], [rad] or 1: features that vary less are taken as constant
HUBER = 1.345  # in standard deviations: residuals beyond it count less and less
ROUNDS = 10  # of reweighting
MAXIMUM_ROWS = 20_000  # more rows do not make a line better, only slower


@dataclass(frozen=True, eq=False)
class LinearFit:
    """A linear function of features, and how far the data are from it.

    Attributes:
        weight: ``(outputs, inputs)``.
        bias: ``(outputs,)``.
        spread: Standard deviation of the residuals, outliers left out, ``(outputs,)``.
    """

    weight: Floats
    bias: Floats
    spread: Floats


def fit_linear(inputs: Floats, outputs: Floats, units: Floats, ridge: float) -> LinearFit:
    """Fit outputs as a linear function of inputs.

    Each output is first taken as one input plus a constant (or the constant alone), whichever
    has the smallest median error: a primitive's target is often the gripper's or an object's
    position plus an offset. A ridge regression with Huber weights then corrects this copy, so
    that few data shrink to the copy and not to zero.

    Args:
        inputs: ``(n, inputs)``, in their units.
        outputs: ``(n, outputs)``.
        units: How much an output changes where an input that is copied changes by one,
            ``(outputs,)``.
        ridge: Strength of the shrinkage, in rows of data.
    """
    stride = max(1, -(-len(inputs) // MAXIMUM_ROWS))
    inputs, outputs = inputs[::stride], outputs[::stride]
    centre = np.median(inputs, axis=0)
    scale = inputs.std(axis=0)
    used = scale > SCALE_FLOOR
    standard = np.where(used, (inputs - centre) / np.where(used, scale, 1.0), 0.0)
    design = np.hstack((standard, np.ones((len(inputs), 1))))
    count = outputs.shape[1]
    weight, bias, spread = np.zeros((count, inputs.shape[1])), np.zeros(count), np.zeros(count)
    for row in range(count):
        copied = _best_copy(inputs * units[row], outputs[:, row])
        if copied is not None:
            weight[row, copied] = units[row]
        rest = outputs[:, row] - inputs @ weight[row]
        solution = _huber_ridge(design, rest, ridge)
        spread[row] = _deviation(rest - design @ solution)
        correction = np.where(used, solution[:-1] / np.where(used, scale, 1.0), 0.0)
        weight[row] += correction
        bias[row] = solution[-1] - correction @ centre
    return LinearFit(weight, bias, spread)


def _best_copy(candidates: Floats, output: Floats) -> int | None:
    """Return the column that an output is nearest to, up to a constant; None for no column."""
    differences = output[:, None] - candidates
    errors = np.median(np.abs(differences - np.median(differences, axis=0)), axis=0)
    best = int(np.argmin(errors))
    constant = np.median(np.abs(output - np.median(output)))
    return best if errors[best] < constant else None


def _huber_ridge(design: Floats, output: Floats, ridge: float) -> Floats:
    """Return the coefficients ``(columns,)``; the last column, of ones, is not shrunk."""
    penalty = np.diag(np.append(np.full(design.shape[1] - 1, ridge), 1e-9))
    solution = np.zeros(design.shape[1])
    solution[-1] = np.median(output)
    for _ in range(ROUNDS):
        residual = output - design @ solution
        limit = HUBER * max(_deviation(residual), 1e-9)
        weights = np.minimum(1.0, limit / np.maximum(np.abs(residual), 1e-12))
        weighted = design * weights[:, None]
        solution = np.linalg.solve(weighted.T @ design + penalty, weighted.T @ output)
    return solution


def _deviation(residual: Floats) -> float:
    """Return the standard deviation that the median absolute residual stands for."""
    return 1.4826 * float(np.median(np.abs(residual)))
