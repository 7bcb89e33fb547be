"""How well an IDM does on rollouts that it has not seen."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from prime_core.arrays import Floats
from prime_core.contracts.calls import OTHER, ParameterSpace
from prime_core.contracts.idm import InverseDynamicsModel
from prime_core.contracts.observations import Observations
from prime_core.contracts.training import CallData
from prime_core.errors import PrimeError

POSE_NAMES = ("x", "y", "z", "yaw")
"""Parameters that are a gripper pose, by the names that primitives give them."""


def report_on(idm: InverseDynamicsModel, held_out: CallData) -> dict[str, Any]:
    """Test an IDM on held-out pairs, the trivial baseline beside it.

    Args:
        idm: The trained model.
        held_out: Pairs of episodes that it has not seen; parameter pairs without jitter.

    Returns:
        Accuracy per class, balanced accuracy, the confusion matrix (rows: truth), and per
        primitive the median parameter errors of the IDM and of the baseline that takes the
        gripper's pose at s' for the parameters.

    Raises:
        PrimeError: If the model gives what is no number: it has learnt nothing.
    """
    features = idm.encode(held_out.observations.only(idm.sees))
    names = (*idm.space.names, OTHER)
    scores = idm.score(features, held_out.types.rows)
    _check(scores)
    guesses = scores.argmax(axis=1)
    confusion = np.zeros((len(names), len(names)), dtype=np.int64)
    np.add.at(confusion, (held_out.types.classes, guesses), 1)
    totals = confusion.sum(axis=1)
    accuracy = {
        name: float(confusion[index, index] / totals[index])
        for index, name in enumerate(names)
        if totals[index]
    }
    errors: dict[str, Any] = {}
    for label, name in enumerate(idm.space.names):
        rows = held_out.parameters.classes == label
        if rows.any():
            errors[name] = _parameter_errors(idm, held_out, features, rows, label)
    return {
        "classes": list(names),
        "accuracy": accuracy,
        "balanced_accuracy": float(np.mean(list(accuracy.values()))),
        "confusion": confusion.tolist(),
        "parameter_errors": errors,
    }


def _parameter_errors(
    idm: InverseDynamicsModel,
    data: CallData,
    features: NDArray[np.float32],
    rows: NDArray[np.bool_],
    label: int,
) -> dict[str, Any]:
    space = idm.space.parameter_spaces[label]
    truth = data.values[rows, : len(space)]
    pairs = data.parameters.rows[rows]
    guess, _ = idm.parameters(features, pairs, data.parameters.classes[rows])
    _check(guess[:, : len(space)])
    baseline = gripper_as_parameters(space, data.observations[pairs[:, 1]], truth)
    return {
        "rollouts": int(rows.sum()),
        "idm": median_errors(space, guess[:, : len(space)], truth),
        "baseline": median_errors(space, baseline, truth),
    }


def _check(values: NDArray[Any]) -> None:
    if np.isnan(values).any():
        raise PrimeError(
            "the trained IDM gives values that are not numbers: its training diverged, so that "
            "nothing is kept of it; lower its learning rate"
        )


def gripper_as_parameters(space: ParameterSpace, seen: Observations, fill: Floats) -> Floats:
    """Take the gripper's pose for the parameters x, y, z and yaw.

    Args:
        space: The parameters' names.
        seen: At s', ``N = n``.
        fill: Values of parameters that a pose does not have, ``(n, P)``.

    Returns:
        ``(n, P)``.
    """
    pose = np.column_stack((seen.gripper_position, seen.gripper_yaw))
    result = fill.copy()
    for index, item in enumerate(space.parameters):
        if item.name in POSE_NAMES:
            result[:, index] = pose[:, POSE_NAMES.index(item.name)]
    return result


def median_errors(space: ParameterSpace, guess: Floats, truth: Floats) -> dict[str, float]:
    """Return the median distance [mm] over all metres, and the median angle [degrees].

    Args:
        space: The parameters.
        guess: ``(n, P)``.
        truth: ``(n, P)``.
    """
    difference = space.difference(guess, truth)
    lengths = [index for index, item in enumerate(space.parameters) if item.unit == "m"]
    angles = [index for index, item in enumerate(space.parameters) if item.unit == "rad"]
    result = {}
    if lengths:
        distance = np.linalg.norm(difference[:, lengths], axis=1)
        result["position_mm"] = float(np.median(distance) * 1e3)
    if angles:
        result["angle_degrees"] = float(np.degrees(np.median(np.abs(difference[:, angles]))))
    return result
