"""The policy ``prime`` at work."""

from collections.abc import Iterator

import numpy as np
import torch
from numpy.typing import NDArray

from prime_core.contracts.calls import PrimitiveCall
from prime_core.contracts.observations import Observations
from prime_core.contracts.policy import PrimitivePolicy
from prime_policies.networks.mixture import Mixture, draw, log_mass
from prime_policies.training.call_networks import CallNetworks
from prime_policies.training.repeatable import threads

DRAWS = 50  # of parameters, where the likeliest ones are not wanted
BLUR = 0.05  # over the scales, one or two centimetres: calls that are so near do the same


class PrimePolicy(PrimitivePolicy):
    """Two trained networks on a single instant."""

    def __init__(self, networks: CallNetworks) -> None:
        self._networks = networks

    def candidates(
        self, seen: Observations, startable: NDArray[np.bool_], generator: np.random.Generator
    ) -> Iterator[PrimitiveCall]:
        """Draw a primitive that can start, and yield its calls, then another one's, and so on.

        The primitive is drawn from p(p | s), because the most likely one would be chosen again
        for ever where it changes nothing. Its calls are the best of the components' means, then
        draws from the mixture, the best first: those near which most of the mixture lies.
        """
        for label, wanted in self._primitives(seen, startable, generator):
            means = wanted.means[0][wanted.logits[0] > -torch.inf]
            yield from self._calls(label, _best_first(wanted, means)[:1])
            yield from self._calls(label, _best_first(wanted, draw(wanted, DRAWS, generator)))

    def draw(
        self, seen: Observations, startable: NDArray[np.bool_], generator: np.random.Generator
    ) -> PrimitiveCall:
        """Draw a primitive, then a component of its mixture, and return the call of its mean.

        The paper's evaluation with low noise, as robomimic's.
        """
        label, wanted = next(self._primitives(seen, startable, generator))
        calm = wanted._replace(deviations=torch.zeros_like(wanted.deviations))
        return next(self._calls(label, draw(calm, 1, generator)))

    def _primitives(
        self, seen: Observations, startable: NDArray[np.bool_], generator: np.random.Generator
    ) -> Iterator[tuple[int, Mixture]]:
        """Yield primitives that can start, drawn one after another, and their mixtures."""
        networks = self._networks
        features = torch.from_numpy(networks.features.encode(seen))[None]
        poses = networks.frames.poses(networks.frames.encode(seen), np.zeros((1, 1), np.int64))
        with threads(), torch.inference_mode():
            scores = networks.classifier(features)[0].double().numpy()
        chances = np.exp(np.where(startable, scores - scores[startable].max(), -np.inf))
        while chances.any():
            label = int(generator.choice(len(chances), p=chances / chances.sum()))
            with threads(), torch.inference_mode():
                wanted = networks.mixtures(features, torch.from_numpy(poses).float(), label)
            yield label, wanted
            chances[label] = 0.0

    def _calls(self, label: int, values: torch.Tensor) -> Iterator[PrimitiveCall]:
        """Yield the calls of targets over the scales ``(k, D)``."""
        layout = self._networks.layouts[label]
        for parameters in layout.parameters(values.numpy().astype(np.float64) * layout.scales):
            yield PrimitiveCall(self._networks.space.names[label], parameters)


def _best_first(wanted: Mixture, values: torch.Tensor) -> torch.Tensor:
    """Return values ``(k, D)``, those first near which most of the mixture lies."""
    with threads(), torch.inference_mode():
        scores = log_mass(wanted, values, BLUR)
        return values[scores.argsort(descending=True, stable=True)]
