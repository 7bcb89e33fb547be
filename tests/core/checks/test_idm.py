"""Every way to break the contract of an inverse dynamics model is found, and named."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from prime_core.arrays import Floats, Indices
from prime_core.checks import CheckError, check_idm
from prime_core.contracts.calls import PrimitiveSpace
from prime_core.contracts.idm import IdmConfig, InverseDynamicsModel
from prime_core.contracts.observations import Observations
from prime_core.contracts.training import CallData, ModelContext, TrainingContext
from prime_core.errors import PrimeError


class Linear(InverseDynamicsModel):
    """Scores pairs by a random matrix."""

    def __init__(self, space: PrimitiveSpace, weights: Floats) -> None:
        self.space = space
        self.weights = weights

    def encode(self, seen: Observations) -> NDArray[np.float32]:
        return np.hstack((seen.gripper_position, seen.object_positions[:, 0]))

    def score(self, features: NDArray[np.float32], pairs: Indices) -> NDArray[np.float32]:
        values = (features[pairs[:, 1]] - features[pairs[:, 0]]) @ self.weights
        values -= np.log(np.exp(values).sum(axis=1, keepdims=True))
        return values.astype(np.float32)

    def parameters(
        self, features: NDArray[np.float32], pairs: Indices, labels: Indices
    ) -> tuple[Floats, Floats]:
        result = np.zeros((len(pairs), self.space.width))
        for row, pair, label in zip(result, pairs, labels, strict=True):
            space = self.space.parameter_spaces[label]
            end = np.resize(features[pair[1], :3], len(space))
            row[: len(space)] = np.clip(end, space.low, space.high)
        return result, np.zeros(len(pairs))


class LinearConfig(IdmConfig):
    """Settings of `Linear`."""

    def weights(self, seed: int) -> Floats:
        return np.random.default_rng(seed).normal(size=(6, 3))

    def model(self, space: PrimitiveSpace, weights: Floats) -> InverseDynamicsModel:
        return Linear(space, weights)

    def fit(self, data: CallData, context: TrainingContext) -> InverseDynamicsModel:
        weights = self.weights(context.seed)
        (context.folder / "weights.json").write_text(json.dumps(weights.tolist()))
        return self.model(context.space, weights)

    def load(self, folder: Path, context: ModelContext) -> InverseDynamicsModel:
        path = folder / "weights.json"
        if not path.exists():
            raise PrimeError(f"{folder} holds no model")
        return self.model(context.space, np.array(json.loads(path.read_text())))


def test_a_model_that_keeps_the_contract_passes() -> None:
    check_idm(LinearConfig())


class Unnormalised(Linear):
    def score(self, features: NDArray[np.float32], pairs: Indices) -> NDArray[np.float32]:
        return super().score(features, pairs) + 1


class LooksAtAll(Linear):
    def score(self, features: NDArray[np.float32], pairs: Indices) -> NDArray[np.float32]:
        return super().score(features - features[pairs[:, 0]].mean(axis=0) * features, pairs)


class EncodesTogether(Linear):
    def encode(self, seen: Observations) -> NDArray[np.float32]:
        features = super().encode(seen)
        features -= features.mean(axis=0)
        return features


class EncodesDoubles(Linear):
    def encode(self, seen: Observations) -> Any:
        return super().encode(seen).astype(np.float64)


class SpoilsFeatures(Linear):
    def score(self, features: NDArray[np.float32], pairs: Indices) -> NDArray[np.float32]:
        result = super().score(features, pairs)
        features += 1
        return result


class OutOfBounds(Linear):
    def parameters(self, *arguments: Any) -> tuple[Floats, Floats]:
        parameters, density = super().parameters(*arguments)
        return parameters * 10, density


class PadsWithOnes(Linear):
    def parameters(self, *arguments: Any) -> tuple[Floats, Floats]:
        parameters, density = super().parameters(*arguments)
        parameters[parameters == 0] = 1
        return parameters, density


class NoDensity(Linear):
    def parameters(self, *arguments: Any) -> tuple[Floats, Floats]:
        parameters, density = super().parameters(*arguments)
        return parameters, density[:, None]


BROKEN_MODELS = [
    (Unnormalised, r"probabilities that sum to 2\.72.*\(log-softmax\)"),
    (LooksAtAll, r"score\(\) of three pairs differs.*no batch statistics"),
    (EncodesTogether, r"encode\(\) of five frames differs.*each frame must be encoded alone"),
    (EncodesDoubles, r"encode\(\) is \(12, 6\) of float64: .* float32"),
    (SpoilsFeatures, r"changed the features"),
    (OutOfBounds, r"in their units, within \["),
    (PadsWithOnes, r"for 'nudge', which has 2: the rest must be zeros"),
    (NoDensity, r"parameters\(\)\[1\] is \(66, 1\).*numpy array \(66,\)"),
]


@pytest.mark.parametrize(("model", "text"), BROKEN_MODELS)
def test_a_broken_model_is_told_what_would_be_right(model: type[Linear], text: str) -> None:
    class Config(LinearConfig):
        def model(self, space: PrimitiveSpace, weights: Floats) -> InverseDynamicsModel:
            return model(space, weights)

    with pytest.raises(CheckError, match=text):
        check_idm(Config())


class Unseeded(LinearConfig):
    """Draws without the seed; what it left is found again."""

    def fit(self, data: CallData, context: TrainingContext) -> InverseDynamicsModel:
        if (context.folder / "weights.json").exists():
            return self.load(context.folder, context)
        return super().fit(data, context)

    def weights(self, seed: int) -> Floats:
        return np.random.default_rng().normal(size=(6, 3))


class StartsAnew(LinearConfig):
    """Draws without the seed, and forgets what it left."""

    def weights(self, seed: int) -> Floats:
        return np.random.default_rng().normal(size=(6, 3))


class Forgets(LinearConfig):
    """Loads other weights than it trained."""

    def load(self, folder: Path, context: ModelContext) -> InverseDynamicsModel:
        super().load(folder, context)
        return Linear(context.space, np.ones((6, 3)))


class LoadsAnything(LinearConfig):
    """Loads from an empty folder."""

    def load(self, folder: Path, context: ModelContext) -> InverseDynamicsModel:
        return Linear(context.space, np.ones((6, 3)))


class RaisesOsError(LinearConfig):
    """Raises what no user can read."""

    def load(self, folder: Path, context: ModelContext) -> InverseDynamicsModel:
        (folder / "weights.json").read_text()
        return super().load(folder, context)


@pytest.mark.parametrize(
    ("config", "text"),
    [
        (Unseeded(), r"two trainings with seed 0 give two models"),
        (StartsAnew(), r"folder with a finished training gives another model"),
        (Forgets(), r"load\(\) gives another model"),
        (LoadsAnything(), r"load\(\) of an empty folder returns a model"),
        (RaisesOsError(), r"load\(\) of an empty folder raises FileNotFoundError"),
    ],
)
def test_a_broken_training_is_told_what_would_be_right(config: IdmConfig, text: str) -> None:
    with pytest.raises(CheckError, match=text):
        check_idm(config)
