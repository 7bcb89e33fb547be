"""What is computed from examples before and after a network trains on them."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import torch
from torch import Tensor

from prime_core.idm import PrimitiveSpace
from prime_policies.examples import Source
from prime_policies.linear import LinearFit
from prime_policies.mixture import best_means
from prime_policies.networks import ParameterNetwork, Trunk
from prime_policies.parameter_codec import ParameterCodec

SCALE_FLOOR = 1e-2  # [m], [rad] or 1: features that vary less are not blown up
TAIL = 0.005  # share of values at either end that do not count for the scale
MAXIMUM_ROWS = 100_000  # more do not make statistics better
LEAST_GAIN = 0.2  # share of the line's error that a trusted perceptron must save
ENOUGH_ROWS = 8  # left out, to say how far a perceptron is to be trusted
TRUSTS = torch.linspace(0, 1, 9)
BLOCK = 4096  # examples whose residuals are computed at a time, which bounds the memory


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


def fit_lines(
    network: ParameterNetwork,
    source: Source,
    space: PrimitiveSpace,
    fit: Callable[[Tensor, Tensor, Tensor], LinearFit],
) -> None:
    """Fit the lines of a parameter network, one for each primitive that has examples.

    Args:
        network: Its lines are set.
        source: Examples with targets.
        space: The primitives.
        fit: `fit_linear` or `fit_copy`.
    """
    units = torch.from_numpy(ParameterCodec(space).units)
    for primitive, parameters in enumerate(space.parameter_spaces):
        rows = torch.nonzero(source.labels == primitive)[:, 0]
        if not len(rows):
            continue
        own = (primitive, slice(len(parameters)))
        batch = source.batch(rows)
        inputs, outputs = batch.frames.flatten(1).double(), batch.targets[:, own[1]].double()
        line = fit(inputs, outputs, units[own])
        network.weight[own], network.bias[own] = line.weight.float(), line.bias.float()
        network.spread[own] = line.spread.clamp_min(network.minimum_deviation).float()


def with_residuals(network: ParameterNetwork, source: Source) -> Source:
    """Return the examples with what the network's lines leave over as targets."""
    with torch.no_grad():
        blocks = [
            network.residuals(*source.batch(rows))
            for rows in torch.split(torch.arange(len(source.labels)), BLOCK)
        ]
    return replace(source, targets=torch.cat(blocks))


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
            errors = (batch.targets - TRUSTS[:, None, None] * means).abs().median(dim=1).values
            best, least = errors.argmin(dim=0), errors.min(dim=0).values
            # A small gain on a few rows is chance.
            gains = least < (1 - LEAST_GAIN) * errors[0]
            network.trust[primitive] = torch.where(gains, TRUSTS[best], 0.0)
