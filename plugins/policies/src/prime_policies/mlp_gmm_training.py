"""How the inverse dynamics model ``mlp-gmm`` is trained and loaded."""

from pathlib import Path

import numpy as np
import torch

from prime_core.features import FeatureEncoder, gripper_yaw
from prime_core.idm import PairData, PrimitiveSpace
from prime_core.progress import Progress
from prime_core.scene import SceneDescription
from prime_policies import building
from prime_policies.mlp_gmm import MlpGmmIdmConfig
from prime_policies.mlp_gmm_model import MlpGmmIdm
from prime_policies.networks import Classifier, ParameterNetwork
from prime_policies.parameter_codec import ParameterCodec
from prime_policies.training import Schedule, Source, Training, check_identity
from prime_policies.weights import (
    check_card,
    load_weights,
    make_card,
    read_tensors,
    write_card,
    write_tensors,
)

KIND = "mlp-gmm"
CLASSIFIER = "classifier"
PARAMETERS = "parameters"


def fit_idm(
    config: MlpGmmIdmConfig,
    data: PairData,
    description: SceneDescription,
    space: PrimitiveSpace,
    folder: Path,
    seed: int,
    progress: Progress,
) -> MlpGmmIdm:
    """Train the classifier, then the parameters; see `IdmConfig.fit`."""
    folder.mkdir(parents=True, exist_ok=True)
    card = _card(config, description, space)
    trainer = _IdmTrainer(config, folder, _identity(card, seed, data), seed, progress)
    width = FeatureEncoder(description).width
    features = torch.from_numpy(FeatureEncoder(description).encode(data.frames))
    classifier, parameter_network = _build(config, width, space, seed)

    source = building.classifier_source(
        features, data.type_pairs, data.type_labels, data.type_weights
    )
    building.measure_inputs(classifier.trunk, source)
    trainer.train(CLASSIFIER, classifier, source, config.classifier_epochs)

    source = _parameter_source(features, data, space)
    building.measure_inputs(parameter_network.trunk, source)
    building.fit_lines(parameter_network, source, space)
    trainer.train(PARAMETERS, parameter_network, source, config.parameter_epochs)
    write_card(folder, card)
    return MlpGmmIdm(description, space, classifier, parameter_network)


def load_idm(
    config: MlpGmmIdmConfig, folder: Path, description: SceneDescription, space: PrimitiveSpace
) -> MlpGmmIdm:
    """Load what `fit_idm` left in a folder."""
    check_card(folder, _card(config, description, space))
    width = FeatureEncoder(description).width
    classifier, parameter_network = _build(config, width, space, seed=0)
    load_weights(classifier, folder / f"{CLASSIFIER}.safetensors")
    load_weights(parameter_network, folder / f"{PARAMETERS}.safetensors")
    return MlpGmmIdm(description, space, classifier, parameter_network)


class _IdmTrainer:
    """Trains networks into a folder, and counts their epochs together."""

    def __init__(
        self, config: MlpGmmIdmConfig, folder: Path, identity: str, seed: int, progress: Progress
    ) -> None:
        self._config, self._folder, self._identity = config, folder, identity
        self._seed, self._progress = seed, progress
        self._done = 0

    def train(
        self, name: str, network: Classifier | ParameterNetwork, source: Source, epochs: int
    ) -> None:
        """Train a network, unless its finished weights are there: then load them."""
        before, self._done = self._done, self._done + epochs
        path = self._folder / f"{name}.safetensors"
        if path.exists():
            check_identity(path, read_tensors(path)[1], self._identity)
            load_weights(network, path)
            return
        total = self._config.classifier_epochs + self._config.parameter_epochs
        state = self._folder / f"{name}.training.safetensors"
        training = Training(state, self._identity, self._seed, self._schedule(epochs))
        training.run(
            network,
            [(source, self._config.batch_size)],
            keep=lambda epoch: None,
            report=lambda epoch: self._progress(before + epoch, total),
        )
        write_tensors(path, network.state_dict(), {"identity": self._identity})
        training.finish()

    def _schedule(self, epochs: int) -> Schedule:
        config = self._config
        return Schedule(
            epochs,
            config.steps_per_epoch,
            config.learning_rate,
            config.weight_decay,
        )


def _build(
    config: MlpGmmIdmConfig, width: int, space: PrimitiveSpace, seed: int
) -> tuple[Classifier, ParameterNetwork]:
    classes = len(space.names) + 1
    classifier = building.start_network(
        lambda: building.build_classifier(config, width, True, classes), seed, CLASSIFIER
    )
    parameter_network = building.start_network(
        lambda: building.build_parameter_network(config, width, True, space), seed, PARAMETERS
    )
    return classifier, parameter_network


def _parameter_source(features: torch.Tensor, data: PairData, space: PrimitiveSpace) -> Source:
    # Angles are taken from where the gripper ends: that is where primitives bring it.
    yaws = gripper_yaw(data.frames)[data.parameter_pairs[:, 1]]
    targets = ParameterCodec(space).targets(data.parameters, data.parameter_labels, yaws)
    return building.parameter_source(
        features, data.parameter_pairs, data.parameter_labels, targets, data.parameter_weights
    )


def _card(
    config: MlpGmmIdmConfig, description: SceneDescription, space: PrimitiveSpace
) -> dict[str, object]:
    return make_card(KIND, config.model_dump(mode="json"), description, space)


def _identity(card: dict[str, object], seed: int, data: PairData) -> str:
    arrays: list[np.ndarray] = [data.frames.state, data.frames.environment_state]
    arrays += [data.type_pairs, data.type_labels, data.type_weights]
    arrays += [data.parameter_pairs, data.parameter_labels]
    arrays += [data.parameters, data.parameter_weights]
    return building.fingerprint(card, seed, arrays)
