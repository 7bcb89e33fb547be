"""The contract of a perception."""

import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from prime_core.checks.requirement import require, require_array, require_missing_is_told
from prime_core.checks.samples import CAMERAS, CONTEXT, DESCRIPTION, sample_observations
from prime_core.contracts.observations import OBJECT_WIDTH, Observations
from prime_core.contracts.perception import Perception, PerceptionConfig
from prime_core.contracts.training import TrainingContext

TOLERANCE = 1e-4
"""Relative and absolute; of poses that must agree. Networks compute in float32."""

INSTANTS = 8


def check_perception(config: PerceptionConfig, seed: int = 0) -> None:
    """Check on made-up images that a perception keeps its contract.

    It is trained twice in a temporary folder, so give it settings that train briefly. What
    it learns is not looked at; see `prime_core.contracts.perception` for the contract.

    Args:
        config: Settings of the perception.
        seed: Of the images and the training.

    Raises:
        CheckError: If it breaks the contract.
    """
    require(
        tuple(config.modalities) == ("proprioception", "images"),
        f"its settings' modalities are {config.modalities}: a perception sees proprioception and "
        "images, and nothing else",
    )
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "missing").mkdir()
        require_missing_is_told(lambda: config.load(folder / "missing", CONTEXT), "an empty folder")
        perception = _fit(config, folder / "first", seed)
        told = _check_told(perception, seed)
        advice = "weights and all that answers depend on must be kept in the folder"
        loaded = config.load(folder / "first", CONTEXT)
        _require_same(told, _check_told(loaded, seed), f"load() gives another one: {advice}")
        _require_same(
            told,
            _check_told(_fit(config, folder / "first", seed), seed),
            "fit() in a folder with a finished training gives another one: it must go on after "
            "its last finished epoch, so return what it finds",
        )
        _require_same(
            told,
            _check_told(_fit(config, folder / "second", seed), seed),
            f"two trainings with seed {seed} give two: all draws must come from the seed",
        )


def _fit(config: PerceptionConfig, folder: Path, seed: int) -> Perception:
    folder.mkdir(exist_ok=True)
    context = TrainingContext(**vars(CONTEXT), folder=folder, seed=seed)
    perception = config.fit(sample_observations(np.random.default_rng(seed)), context)
    require(
        isinstance(perception, Perception),
        f"fit() returned a {type(perception).__name__}: it must return a Perception",
    )
    require(
        perception.cameras == CAMERAS,
        f"its cameras are {perception.cameras!r}: they must be the context's",
    )
    return perception


def _check_told(perception: Perception, seed: int) -> NDArray[np.float32]:
    """Return the poses told of some instants, checked."""
    seen = sample_observations(np.random.default_rng(seed + 1), INSTANTS)
    told = _told(perception, seen.only(("proprioception", "images")))
    if seen.environment_state is not None:
        lie = replace(seen, environment_state=seen.environment_state[::-1] + 1)
        _require_same(
            told,
            _told(perception, lie),
            "see() tells other poses where the simulator's are others: it must not look at them",
        )
    alone = np.concatenate(
        [
            _told(perception, seen[row : row + 1].only(("proprioception", "images")))
            for row in range(INSTANTS)
        ]
    )
    _require_same(
        told, alone, "see() tells of an instant other poses alone than among others: as at work"
    )
    poses = Observations(seen.state, told)
    lengths = np.linalg.norm(poses.object_quaternions, axis=-1)
    require(
        np.allclose(lengths, 1, atol=TOLERANCE),
        f"its quaternions have lengths {lengths.round(3).tolist()}: they must be 1",
    )
    return told


def _told(perception: Perception, seen: Observations) -> NDArray[np.float32]:
    found = perception.see(seen)
    require(
        isinstance(found, Observations) and not found.images,
        "see() must return Observations without images",
    )
    require(
        np.array_equal(found.state, seen.state),
        "see() changed the robot's state: it must be what it was",
    )
    told, width = found.environment_state, OBJECT_WIDTH * len(DESCRIPTION.objects)
    require_array(told, (len(seen), width), np.float32, "environment_state of what see() returns")
    return np.asarray(told, dtype=np.float32)


def _require_same(left: NDArray[np.float32], right: NDArray[np.float32], text: str) -> None:
    require(np.allclose(left, right, rtol=TOLERANCE, atol=TOLERANCE), text)
