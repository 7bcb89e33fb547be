"""What is computed from examples before and after a network trains on them."""

from collections.abc import Callable, Sequence

import numpy as np
import torch
from torch import Tensor

from prime_core.contracts.calls import PrimitiveSpace
from prime_policies.examples import Source
from prime_policies.linear import LinearFit
from prime_policies.mixture import best_means, wrapped
from prime_policies.networks import ParameterNetwork, Trunk
from prime_policies.parameter_codec import ParameterCodec

SCALE_FLOOR = 1e-2  # [m], [rad] or 1: features that vary less are not blown up
TAIL = 0.005  # share of values at either end that do not count for the scale
MAXIMUM_ROWS = 100_000  # more do not make statistics better
LEAST_GAIN = 0.2  # share of the line's error that a trusted perceptron must save
ENOUGH_ROWS = 8  # left out, to say how far a perceptron is to be trusted
TRUSTS = torch.linspace(0, 1, 9)

type LineFitter = Callable[[Tensor, Tensor, Tensor, Tensor], Sequence[LinearFit]]
"""Fits lines to inputs ``(n, inputs)``, outputs ``(n, outputs)``, units ``(outputs,)``: how much an
output changes where an input that is copied changes by one, and periods ``(outputs,)``: by which
outputs may differ and mean the same, 0 for none. All are float64."""


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
    fit: LineFitter,
    components: range,
) -> None:
    """Fit the lines of a parameter network, for each primitive that has examples.

    Args:
        network: Its lines are set.
        source: Examples with targets.
        space: The primitives.
        fit: Of each primitive.
        components: Which get the lines.
    """
    codec = ParameterCodec(space)
    units, periods = torch.from_numpy(codec.units), torch.from_numpy(codec.periods)
    for primitive, parameters in enumerate(space.parameter_spaces):
        rows = torch.nonzero(source.labels == primitive)[:, 0]
        if not len(rows):
            continue
        batch, own = source.batch(rows), slice(len(parameters))
        inputs = network.inputs(batch.frames).double()
        outputs = batch.targets[:, own].double()
        scales = units[primitive, own], periods[primitive, own]
        network.set_lines(primitive, fit(inputs, outputs, *scales), components)


def measure_trust(network: ParameterNetwork, left_out: Source) -> None:
    """Set how much each primitive's perceptron is trusted, by the errors on data left out.

    Where few rollouts leave little beyond their own noise to learn, the lines alone are better.

    Args:
        network: Trained on other examples.
        left_out: Examples.
    """
    nothing, everything = torch.zeros_like(network.trust), torch.ones_like(network.trust)
    with torch.no_grad():
        for primitive in range(len(network.trust)):
            rows = torch.nonzero(left_out.labels == primitive)[:, 0]
            if len(rows) < ENOUGH_ROWS:
                network.trust[primitive] = 0.0
                continue
            frames, labels, targets = left_out.batch(rows)
            lines = best_means(network.mixture(frames, labels, nothing))
            corrections = best_means(network.mixture(frames, labels, everything)) - lines
            errors = targets - lines - TRUSTS[:, None, None] * corrections
            errors = wrapped(errors, network.periods[primitive]).abs()
            medians = errors.median(dim=1).values
            best, least = medians.argmin(dim=0), medians.min(dim=0).values
            # A small gain on a few rows is chance.
            gains = least < (1 - LEAST_GAIN) * medians[0]
            network.trust[primitive] = torch.where(gains, TRUSTS[best], 0.0)
