"""Networks built from settings, and what is computed from data before they train."""

import hashlib
import json
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

from prime_core.errors import DatasetError
from prime_core.idm import Indices, PrimitiveSpace
from prime_policies.linear import fit_linear
from prime_policies.mixture import best_means
from prime_policies.networks import Classifier, ParameterNetwork, Trunk
from prime_policies.parameter_codec import ParameterCodec
from prime_policies.settings import NetworkSettings
from prime_policies.training import Schedule, Source, seeded

SCALE_FLOOR = 1e-2  # [m], [rad] or 1: features that vary less are not blown up
TAIL = 0.005  # share of values at either end that do not count for the scale
MAXIMUM_ROWS = 100_000  # more do not make statistics better
STRETCHES = 40  # of frames that are left out or not
ENOUGH_ROWS = 8  # left out, to say how far a perceptron is to be trusted
TRUSTS = torch.linspace(0, 1, 9)
BLOCK = 4096  # examples whose residuals are computed at a time, which bounds the memory


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
    settings: NetworkSettings, features: int, pair: bool, space: PrimitiveSpace
) -> ParameterNetwork:
    """Build a mixture of parameters given frames or pairs of frames."""
    return ParameterNetwork(
        Trunk(features, pair, settings.hidden_sizes, settings.input_noise),
        settings.hidden_sizes[-1],
        inputs=(1 + pair) * features,
        mask=torch.from_numpy(ParameterCodec(space).mask),
        components=settings.components,
        minimum_deviation=settings.minimum_deviation,
    )


def measure_inputs(trunk: Trunk, source: Source) -> None:
    """Take the mean and the scale of a trunk's inputs from examples."""
    stride = max(1, len(source.indices) // MAXIMUM_ROWS)
    frames = source.features[source.indices[::stride]].numpy().astype(np.float64)
    everything = frames.reshape(-1, frames.shape[-1])
    # A single object that fell off the world must not set the scale.
    low, high = np.quantile(everything, (TAIL, 1 - TAIL), axis=0)
    within = np.clip(everything, low, high)
    trunk.mean.copy_(torch.from_numpy(within.mean(axis=0)))
    trunk.scale.copy_(torch.from_numpy(np.maximum(within.std(axis=0), SCALE_FLOOR)))
    difference = frames[:, -1] - frames[:, 0]
    low, high = np.quantile(difference, (TAIL, 1 - TAIL), axis=0)
    spread = np.clip(difference, low, high).std(axis=0)
    trunk.difference_scale.copy_(torch.from_numpy(np.maximum(spread, SCALE_FLOOR)))


def fit_lines(network: ParameterNetwork, source: Source, space: PrimitiveSpace) -> None:
    """Fit the lines of a parameter network, one for each primitive that has examples."""
    units = torch.from_numpy(ParameterCodec(space).units)
    for primitive, parameters in enumerate(space.parameter_spaces):
        rows = torch.nonzero(source.labels == primitive)[:, 0]
        if not len(rows):
            continue
        width = len(parameters)
        batch = source.batch(rows)
        fit = fit_linear(
            batch.frames.flatten(1).double(),
            batch.targets[:, :width].double(),
            units[primitive, :width],
        )
        network.weight[primitive, :width] = fit.weight.float()
        network.bias[primitive, :width] = fit.bias.float()
        spread = fit.spread.clamp_min(network.minimum_deviation)
        network.spread[primitive, :width] = spread.float()


def with_residuals(network: ParameterNetwork, source: Source) -> Source:
    """Return the examples with what the network's lines leave over as targets."""
    with torch.no_grad():
        blocks = [
            network.residuals(*source.batch(rows))
            for rows in torch.split(torch.arange(len(source.labels)), BLOCK)
        ]
    return replace(source, targets=torch.cat(blocks))


def split(source: Source) -> tuple[Source, Source]:
    """Split examples into those to train on, and an eighth to measure with.

    Frames of one episode follow each other: what is left out are whole stretches of frames.
    """
    stretch = source.indices[:, 0] * STRETCHES // len(source.features)
    left_out = stretch % 8 == 3
    if bool(left_out.all()) or not bool(left_out.any()):
        return source, _rows(source, torch.zeros_like(left_out))
    return _rows(source, ~left_out), _rows(source, left_out)


def _rows(source: Source, chosen: Tensor) -> Source:
    return replace(
        source,
        indices=source.indices[chosen],
        labels=source.labels[chosen],
        targets=source.targets[chosen],
        weights=source.weights[chosen.numpy()],
    )


def measure_trust(network: ParameterNetwork, left_out: Source) -> None:
    """Set how much each primitive's perceptron is trusted, by the errors on data left out.

    Where few rollouts leave little beyond their own noise to learn, the line alone is better.

    Args:
        network: Trained on other examples.
        left_out: Examples, with residuals as targets.
    """
    with torch.no_grad():
        for primitive in range(len(network.trust)):
            rows = torch.nonzero(left_out.labels == primitive)[:, 0]
            if len(rows) < ENOUGH_ROWS:
                network.trust[primitive] = 0.0
                continue
            batch = left_out.batch(rows)
            means = best_means(network.residual_mixture(batch.frames, batch.labels))
            errors = (batch.targets - TRUSTS[:, None, None] * means).abs().mean(dim=1)
            network.trust[primitive] = TRUSTS[errors.argmin(dim=0)]


def classifier_source(
    features: Tensor, indices: Indices, labels: Indices, weights: NDArray[np.float64]
) -> Source:
    """Return examples of classes.

    Args:
        features: Of all frames, ``(N, features)``.
        indices: ``(n,)`` or ``(n, 2)``.
        labels: ``(n,)``.
        weights: ``(n,)``.
    """
    return _source(features, indices, labels, np.zeros((len(labels), 0)), weights)


def parameter_source(
    features: Tensor,
    indices: Indices,
    labels: Indices,
    targets: NDArray[np.float64],
    weights: NDArray[np.float64],
) -> Source:
    """Return examples of parameters, given as targets ``(n, D)``; see `classifier_source`."""
    return _source(features, indices, labels, targets, weights)


def _source(
    features: Tensor,
    indices: Indices,
    labels: Indices,
    targets: NDArray[np.float64],
    weights: NDArray[np.float64],
) -> Source:
    if not len(labels) or weights.sum() <= 0:
        raise DatasetError("there are no examples to train on: no rollout or segment was kept")
    return Source(
        features=features,
        indices=torch.from_numpy(indices.reshape(len(labels), -1).astype(np.int64)),
        labels=torch.from_numpy(labels.astype(np.int64)),
        targets=torch.from_numpy(targets.astype(np.float32)),
        weights=weights,
    )


def fingerprint(card: dict[str, Any], seed: int, arrays: list[NDArray[Any]]) -> str:
    """Return what tells a training apart: its settings, its seed and its data."""
    digest = hashlib.blake2b(json.dumps([card, seed]).encode(), digest_size=16)
    for array in arrays:
        digest.update(repr((array.shape, array.dtype)).encode())
        digest.update(np.ascontiguousarray(array).data)
    return digest.hexdigest()
