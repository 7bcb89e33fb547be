"""Networks and schedules built from settings."""

from collections.abc import Callable

import torch
from torch import nn

from prime_core.contracts.calls import PrimitiveSpace
from prime_policies.line_inputs import LineInputs
from prime_policies.networks import Classifier, ParameterNetwork, Trunk
from prime_policies.parameter_codec import ParameterCodec
from prime_policies.settings import NetworkSettings
from prime_policies.training import Schedule, seeded


def start_network[AnyNetwork: nn.Module](
    build: Callable[[], AnyNetwork], seed: int, name: str
) -> AnyNetwork:
    """Build a network whose first weights depend on a seed and a name only."""
    with torch.random.fork_rng(devices=[]):
        torch.manual_seed(int(seeded(seed, name, 0).integers(2**62)))
        return build().eval()


def schedule(settings: NetworkSettings, epochs: int) -> Schedule:
    """Return the schedule of a training from the start."""
    rate, decay = settings.learning_rate, settings.weight_decay
    return Schedule(epochs, settings.steps_per_epoch, rate, decay)


def build_classifier(
    settings: NetworkSettings, features: int, pair: bool, classes: int
) -> Classifier:
    """Build a classifier of frames or pairs of frames."""
    trunk = Trunk(features, pair, settings.hidden_sizes, settings.input_noise)
    return Classifier(trunk, settings.hidden_sizes[-1], classes)


def build_parameter_network(
    settings: NetworkSettings, inputs: LineInputs, space: PrimitiveSpace
) -> ParameterNetwork:
    """Build a mixture of parameters given what its lines see."""
    codec = ParameterCodec(space)
    return ParameterNetwork(
        Trunk(inputs.features, inputs.pair, settings.hidden_sizes, settings.input_noise),
        settings.hidden_sizes[-1],
        inputs,
        mask=torch.from_numpy(codec.mask),
        periods=torch.from_numpy(codec.periods),
        components=settings.components,
        minimum_deviation=settings.minimum_deviation,
    )
