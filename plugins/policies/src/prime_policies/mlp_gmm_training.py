"""How the inverse dynamics model ``mlp-gmm`` is trained and loaded."""

from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from prime_core.contracts.calls import PrimitiveSpace
from prime_core.contracts.description import SceneDescription
from prime_core.contracts.training import CallData, ModelContext, TrainingContext
from prime_policies import building, examples, preparing
from prime_policies.examples import Source
from prime_policies.line_inputs import LineInputs
from prime_policies.linear import LinearFit, fit_linear
from prime_policies.mlp_gmm import MlpGmmIdmConfig
from prime_policies.mlp_gmm_model import MlpGmmIdm
from prime_policies.networks import Classifier, ParameterNetwork
from prime_policies.parameter_codec import ParameterCodec
from prime_policies.scene_features import FeatureEncoder, gripper_yaw
from prime_policies.training_folder import TrainingFolder
from prime_policies.weights import Card, check_card, load_weights, make_card, write_card

KIND = "mlp-gmm"
CLASSIFIER = "classifier"
PARAMETERS = "parameters"


def fit_idm(
    config: MlpGmmIdmConfig,
    data: CallData,
    context: TrainingContext,
) -> MlpGmmIdm:
    """Train the classifier, then the parameters; see `IdmConfig.fit`."""
    description, space = context.description, context.space
    folder, seed, progress = context.folder, context.seed, context.progress
    folder.mkdir(parents=True, exist_ok=True)
    card = _card(config, description, space)
    epochs = config.classifier_epochs + config.parameter_epochs
    trainings = TrainingFolder(folder, _identity(card, seed, data), seed, progress, epochs)
    encoder = FeatureEncoder(description)
    features = torch.from_numpy(encoder.encode(data.observations))
    classifier, parameter_network = _build(config, encoder, space, seed)

    source = examples.classifier_source(
        features, data.types.rows, data.types.classes, data.types.weights
    )
    preparing.measure_inputs(classifier.trunk, source)
    schedule = building.schedule(config, config.classifier_epochs)
    trainings.train(CLASSIFIER, classifier, [(source, config.batch_size)], schedule)

    source, left_out = examples.split(_parameter_source(features, data, space))
    preparing.measure_inputs(parameter_network.trunk, source)
    preparing.fit_lines(parameter_network, source, space, _fit_line, range(config.components))
    trainings.train(
        PARAMETERS,
        parameter_network,
        [(source, config.batch_size)],
        building.schedule(config, config.parameter_epochs),
        lambda epoch: preparing.measure_trust(parameter_network, left_out),
    )
    write_card(folder, card)
    return MlpGmmIdm(description, space, classifier, parameter_network)


def load_idm(config: MlpGmmIdmConfig, folder: Path, context: ModelContext) -> MlpGmmIdm:
    """Load what `fit_idm` left in a folder."""
    description, space = context.description, context.space
    check_card(folder, _card(config, description, space))
    encoder = FeatureEncoder(description)
    classifier, parameter_network = _build(config, encoder, space, seed=0)
    load_weights(classifier, folder / f"{CLASSIFIER}.safetensors")
    load_weights(parameter_network, folder / f"{PARAMETERS}.safetensors")
    return MlpGmmIdm(description, space, classifier, parameter_network)


def _build(
    config: MlpGmmIdmConfig, encoder: FeatureEncoder, space: PrimitiveSpace, seed: int
) -> tuple[Classifier, ParameterNetwork]:
    classes = len(space.names) + 1
    classifier = building.start_network(
        lambda: building.build_classifier(config, encoder.width, True, classes), seed, CLASSIFIER
    )
    inputs = LineInputs.of(encoder, pair=True)
    parameter_network = building.start_network(
        lambda: building.build_parameter_network(config, inputs, space), seed, PARAMETERS
    )
    return classifier, parameter_network


def _parameter_source(features: torch.Tensor, data: CallData, space: PrimitiveSpace) -> Source:
    # Angles are taken from where the gripper ends: that is where primitives bring it.
    yaws = gripper_yaw(data.observations)[data.parameters.rows[:, 1]]
    targets = ParameterCodec(space).targets(data.values, data.parameters.classes, yaws)
    return examples.parameter_source(
        features, data.parameters.rows, data.parameters.classes, targets, data.parameters.weights
    )


def _fit_line(inputs: Tensor, outputs: Tensor, units: Tensor, periods: Tensor) -> list[LinearFit]:
    """Return one line: what happened tells the parameters, whichever object they are about.

    Angles are taken from where the gripper ends, and so near zero: their period does not matter.
    """
    return [fit_linear(inputs, outputs, units)]


def _card(config: MlpGmmIdmConfig, description: SceneDescription, space: PrimitiveSpace) -> Card:
    return make_card(KIND, config.model_dump(mode="json"), description, space)


def _identity(card: Card, seed: int, data: CallData) -> str:
    arrays: list[NDArray[np.generic]] = [
        data.observations.state,
        data.observations.environment_state,
    ]
    arrays += [data.types.rows, data.types.classes, data.types.weights]
    arrays += [data.parameters.rows, data.parameters.classes]
    arrays += [data.values, data.parameters.weights]
    return examples.fingerprint(card, seed, arrays)
