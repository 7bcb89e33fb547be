"""Builds networks and schedules from settings."""

from prime_core.contracts.calls import PrimitiveSpace
from prime_policies.networks.classifier import Classifier
from prime_policies.networks.parameter_layout import ParameterLayout
from prime_policies.networks.parameter_network import ParameterNetwork
from prime_policies.networks.product_mixture import ProductMixture
from prime_policies.networks.reference_frames import ReferenceFrames
from prime_policies.networks.trunk import Trunk
from prime_policies.training.loop import Schedule, start_network
from prime_policies.training.settings import NetworkSettings

CLASSIFIER, PARAMETERS = "classifier", "parameters"
"""Names of the two networks, and of their files."""


def build_classifier(
    settings: NetworkSettings, features: int, pair: bool, classes: int, seed: int
) -> Classifier:
    """Build a classifier of instants or pairs of them."""

    def build() -> Classifier:
        trunk = Trunk(features, pair, settings.hidden_sizes, settings.input_noise)
        return Classifier(trunk, settings.hidden_sizes[-1], classes)

    return start_network(build, seed, CLASSIFIER)


def build_parameter_network(
    settings: NetworkSettings,
    features: int,
    frames: ReferenceFrames,
    space: PrimitiveSpace,
    seed: int,
    *,
    pair: bool,
) -> ParameterNetwork:
    """Build the mixtures of parameters; those of pairs have an affine map, too."""

    def build() -> ParameterNetwork:
        trunk = Trunk(features, pair, settings.hidden_sizes, settings.input_noise)
        mixtures = [
            ProductMixture(
                ParameterLayout(parameters),
                frames.frames,
                settings.hidden_sizes[-1],
                settings.components,
                settings.minimum_deviation,
                affine_inputs=3 * features if pair else 0,
            )
            for parameters in space.parameter_spaces
        ]
        return ParameterNetwork(trunk, mixtures)

    return start_network(build, seed, PARAMETERS)


def schedule(settings: NetworkSettings, epochs: int) -> Schedule:
    """Return the schedule of a training from the start."""
    return Schedule(
        epochs,
        settings.steps_per_epoch,
        settings.learning_rate,
        settings.weight_decay,
        settings.batch_size,
    )
