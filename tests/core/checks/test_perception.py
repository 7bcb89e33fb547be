"""Every way to break the contract of a perception is found, and named."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from prime_core.checks import CheckError, check_perception
from prime_core.contracts.images import CameraConfig
from prime_core.contracts.observations import Modality, Observations
from prime_core.contracts.perception import Perception, PerceptionConfig
from prime_core.contracts.training import ModelContext, TrainingContext
from prime_core.errors import DatasetError

WEIGHTS = "weights.npy"


class Linear(Perception):
    """Upright objects by least squares on what a few pixels show."""

    def __init__(self, cameras: CameraConfig, weights: np.ndarray) -> None:
        self.cameras = cameras
        self.weights = weights

    def see(self, seen: Observations) -> Observations:
        told = (pixels(self.cameras, seen) @ self.weights).reshape(len(seen), -1, 8)
        told[..., 3:7], told[..., 7] = (1, 0, 0, 0), told[..., 7] > 0.5
        return Observations(seen.state, told.reshape(len(seen), -1).astype(np.float32))


def pixels(cameras: CameraConfig, seen: Observations) -> np.ndarray:
    (name,) = cameras.cameras
    images = np.asarray(seen.images[name], dtype=np.float64)[:, ::12, ::12] / 255
    return np.column_stack((images.reshape(len(images), -1), np.ones(len(images))))


class LinearConfig(PerceptionConfig):
    """Settings of `Linear`."""

    def fit(self, seen: Observations, context: TrainingContext) -> Perception:
        assert context.cameras is not None and seen.environment_state is not None
        inputs = pixels(context.cameras, seen)
        ridge = 0.1 * np.eye(inputs.shape[1])
        weights = np.linalg.solve(inputs.T @ inputs + ridge, inputs.T @ seen.environment_state)
        np.save(context.folder / WEIGHTS, weights)
        return self.load(context.folder, context)

    def load(self, folder: Path, context: ModelContext) -> Perception:
        if not (folder / WEIGHTS).exists():
            raise DatasetError(f"{folder}: holds no weights")
        assert context.cameras is not None
        return self.build(context.cameras, np.load(folder / WEIGHTS))

    def build(self, cameras: CameraConfig, weights: np.ndarray) -> Perception:
        return Linear(cameras, weights)


def test_a_perception_that_keeps_the_contract_passes() -> None:
    check_perception(LinearConfig())
    check_perception(LinearConfig(), seed=3)


class Peeking(Linear):
    def see(self, seen: Observations) -> Observations:
        return replace(seen, images={}) if seen.environment_state is not None else super().see(seen)


class Crowd(Linear):
    def see(self, seen: Observations) -> Observations:
        told = super().see(seen)
        assert told.environment_state is not None
        told.environment_state[:, 0] -= told.environment_state[:, 0].mean()
        return told


class Long(Linear):
    def see(self, seen: Observations) -> Observations:
        told = super().see(seen)
        assert told.environment_state is not None
        return replace(told, environment_state=2 * told.environment_state)


class Imagining(Linear):
    def see(self, seen: Observations) -> Observations:
        return replace(super().see(seen), images=seen.images)


class Narrow(Linear):
    def see(self, seen: Observations) -> Observations:
        told = super().see(seen)
        assert told.environment_state is not None
        return replace(told, environment_state=told.environment_state[:, :8])


class Moving(Linear):
    def see(self, seen: Observations) -> Observations:
        return replace(super().see(seen), state=seen.state + 1)


class Forgetful(LinearConfig):
    def load(self, folder: Path, context: ModelContext) -> Perception:
        assert context.cameras is not None
        return Linear(context.cameras, np.zeros((148, 16)))


class Drawing(LinearConfig):
    def fit(self, seen: Observations, context: TrainingContext) -> Perception:
        chosen = np.random.default_rng().permutation(len(seen))[:80]
        return super().fit(seen[chosen], context)


class Wordy(LinearConfig):
    @property
    def modalities(self) -> tuple[Modality, ...]:
        return ("proprioception", "objects", "images")


class OtherCameras(LinearConfig):
    def build(self, cameras: CameraConfig, weights: np.ndarray) -> Perception:
        return Linear(CameraConfig(cameras=("below",)), weights)


class Nothing(LinearConfig):
    def build(self, cameras: CameraConfig, weights: np.ndarray) -> Any:
        return None


@pytest.mark.parametrize(
    ("broken", "text"),
    [
        (Peeking, "must not look at them"),
        (Crowd, "other poses alone than among others"),
        (Long, "quaternions have lengths"),
        (Imagining, "Observations without images"),
        (Narrow, r"it must be a numpy array \(8, 16\)"),
        (Moving, "changed the robot's state"),
        (Forgetful, "must raise a PrimeError"),
        (Drawing, "all draws must come from the seed|in a folder with a finished training"),
        (Wordy, "a perception sees proprioception and images"),
        (OtherCameras, "must be the context's"),
        (Nothing, "must return a Perception"),
    ],
)
def test_what_breaks_the_contract_is_named(broken: type[Any], text: str) -> None:
    if issubclass(broken, Perception):
        seeing = broken

        class BrokenConfig(LinearConfig):
            def build(self, cameras: CameraConfig, weights: np.ndarray) -> Perception:
                return seeing(cameras, weights)

        broken = BrokenConfig
    with pytest.raises(CheckError, match=text):
        check_perception(broken())
