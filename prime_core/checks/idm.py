"""The contract of an inverse dynamics model."""

import tempfile
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from prime_core.arrays import Indices
from prime_core.checks.requirement import (
    require,
    require_array,
    require_images_agree,
    require_missing_is_told,
)
from prime_core.checks.samples import CONTEXT, SPACE, sample_observations, sample_pairs
from prime_core.contracts.idm import IdmConfig, InverseDynamicsModel
from prime_core.contracts.training import TrainingContext

Numbers = NDArray[np.floating]

TOLERANCE = 1e-4
"""Relative and absolute; of answers that must agree. Networks compute in float32."""


def check_idm(config: IdmConfig, seed: int = 0) -> None:
    """Check on made-up pairs that an inverse dynamics model keeps its contract.

    It is trained twice in a temporary folder, so give it settings that train briefly. What
    it learns is not looked at; see `prime_core.contracts.idm` for the contract.

    Args:
        config: Settings of the model.
        seed: Of the pairs and the training.

    Raises:
        CheckError: If it breaks the contract.
    """
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "missing").mkdir()
        require_missing_is_told(lambda: config.load(folder / "missing", CONTEXT), "an empty folder")
        model = _fit(config, folder / "first", seed)
        answers = _check_answers(model, seed)
        advice = "weights and all that answers depend on must be kept in the folder"
        loaded = config.load(folder / "first", CONTEXT)
        _require_same(
            answers, _check_answers(loaded, seed), f"load() gives another model: {advice}"
        )
        resumed = _fit(config, folder / "first", seed)
        _require_same(
            answers,
            _check_answers(resumed, seed),
            "fit() in a folder with a finished training gives another model: it must go on after "
            "its last finished epoch, so return what it finds",
        )
        again = _fit(config, folder / "second", seed)
        _require_same(
            answers,
            _check_answers(again, seed),
            f"two trainings with seed {seed} give two models: all draws must come from the seed",
        )


def _fit(config: IdmConfig, folder: Path, seed: int) -> InverseDynamicsModel:
    folder.mkdir(exist_ok=True)
    context = TrainingContext(**vars(CONTEXT), folder=folder, seed=seed)
    model = config.fit(sample_pairs(seed), context)
    require(
        isinstance(model, InverseDynamicsModel),
        f"fit() returned a {type(model).__name__}: it must return an InverseDynamicsModel",
    )
    require(model.space == SPACE, "the model's space must be the one that fit() was given")
    require_images_agree(model.sees, config)
    return model


def _check_answers(model: InverseDynamicsModel, seed: int) -> list[Numbers]:
    """Return encoding, scores, parameters and densities of some pairs, checked."""
    generator = np.random.default_rng(seed + 1)
    seen = sample_observations(generator, 12)
    features = model.encode(seen)
    width = features.shape[1] if np.ndim(features) == 2 else 1
    require_array(features, (12, width), np.float32, "encode()")
    require(
        np.allclose(model.encode(seen[:5]), features[:5], rtol=TOLERANCE, atol=TOLERANCE),
        "encode() of five frames differs from the same five among others: each frame must be "
        "encoded alone",
    )
    pairs = np.array([[start, end] for start in range(12) for end in range(start + 1, 12)])
    labels = generator.integers(len(SPACE.names), size=len(pairs))
    before = features.copy()
    scores = _check_scores(model, features, pairs)
    parameters, density = _check_parameters(model, features, pairs, labels)
    require(
        np.array_equal(features, before),
        "score() or parameters() changed the features: they are used again, leave them alone",
    )
    return [features, scores, parameters, density]


def _check_scores(
    model: InverseDynamicsModel, features: NDArray[np.float32], pairs: Indices
) -> NDArray[np.float32]:
    scores = model.score(features, pairs)
    classes = len(SPACE.names) + 1
    require_array(scores, (len(pairs), classes), np.floating, "score()")
    totals = np.exp(scores.astype(np.float64)).sum(axis=1)
    require(
        np.allclose(totals, 1.0, atol=1e-3),
        f"score() gives probabilities that sum to {totals.min():.3g} to {totals.max():.3g}: each "
        "row must hold log probabilities whose exponentials sum to 1 (log-softmax)",
    )
    few = model.score(features, pairs[:3])
    require(
        np.allclose(few, scores[:3], rtol=TOLERANCE, atol=TOLERANCE),
        "score() of three pairs differs from the same three among others: pairs must be scored "
        "alone (no batch statistics, dropout or noise)",
    )
    return scores


def _check_parameters(
    model: InverseDynamicsModel, features: NDArray[np.float32], pairs: Indices, labels: Indices
) -> tuple[Numbers, Numbers]:
    parameters, density = model.parameters(features, pairs, labels)
    require_array(parameters, (len(pairs), SPACE.width), np.floating, "parameters()[0]")
    require_array(density, (len(pairs),), np.floating, "parameters()[1]")
    for row, label in zip(parameters, labels, strict=True):
        space = SPACE.parameter_spaces[label]
        values, padding = row[: len(space)], row[len(space) :]
        require(
            bool(np.all(values >= space.low - 1e-6) and np.all(values <= space.high + 1e-6)),
            f"parameters() gives {values} for {SPACE.names[label]!r}: they must be in their units, "
            f"within {space.low} to {space.high}",
        )
        require(
            not padding.any(),
            f"parameters() gives {row} for {SPACE.names[label]!r}, which has {len(space)}: the "
            "rest must be zeros",
        )
    return parameters, density


def _require_same(left: list[Numbers], right: list[Numbers], text: str) -> None:
    for one, two in zip(left, right, strict=True):
        same = one.shape == two.shape and np.allclose(one, two, rtol=TOLERANCE, atol=TOLERANCE)
        require(same, text)
