"""The policy ``prime`` at work."""

from collections.abc import Iterator

import numpy as np
import torch
from numpy.typing import NDArray

from prime_core.contracts.calls import PrimitiveCall, PrimitiveSpace
from prime_core.contracts.observations import Observations
from prime_core.contracts.policy import PrimitivePolicy
from prime_policies.networks.classifier import Classifier
from prime_policies.networks.mixture import Mixture, draw, log_mass
from prime_policies.networks.parameter_network import ParameterNetwork
from prime_policies.training.call_examples import CallEncoder
from prime_policies.training.threads import threads

DRAWS = 50  # of parameters, where the likeliest ones are not wanted
BLUR = 0.05  # over the scales, one or two centimetres: calls that are so near do the same


class PrimePolicy(PrimitivePolicy):
    """Two networks on a single instant.

    Args:
        space: The primitives to choose from.
        encoder: Of instants.
        classifier: Of the next primitive.
        parameter_network: Of its parameters.
    """

    def __init__(
        self,
        space: PrimitiveSpace,
        encoder: CallEncoder,
        classifier: Classifier,
        parameter_network: ParameterNetwork,
    ) -> None:
        self._space = space
        self._encoder = encoder
        self._classifier, self._parameter_network = classifier, parameter_network

    def candidates(
        self, seen: Observations, startable: NDArray[np.bool_], generator: np.random.Generator
    ) -> Iterator[PrimitiveCall]:
        """Draw a primitive that can start, and yield its calls, then another one's, and so on.

        The primitive is drawn from p(p | s), because the most likely one would be chosen again
        for ever where it changes nothing. Its calls are the best of the components' means, then
        draws from the mixture, the best first: those near which most of the mixture lies.
        """
        features = torch.from_numpy(self._encoder.features.encode(seen))[None]
        encoded = self._encoder.frames.encode(seen)
        poses = torch.from_numpy(self._encoder.frames.poses(encoded, np.zeros((1, 1), np.int64)))
        with threads(), torch.inference_mode():
            scores = self._classifier(features)[0].double().numpy()
        chances = np.exp(np.where(startable, scores - scores[startable].max(), -np.inf))
        while chances.any():
            label = int(generator.choice(len(chances), p=chances / chances.sum()))
            with threads(), torch.inference_mode():
                wanted = self._parameter_network(features, poses.float(), label)
            yield from self._calls(wanted, label, generator)
            chances[label] = 0.0

    def _calls(
        self, wanted: Mixture, label: int, generator: np.random.Generator
    ) -> Iterator[PrimitiveCall]:
        """Yield the best of the components' means, then draws, the best first."""
        name, layout = self._space.names[label], self._encoder.layouts[label]
        for source in (_means, lambda mixture: draw(mixture, DRAWS, generator)):
            with threads(), torch.inference_mode():
                values = source(wanted)
                scores = log_mass(wanted, values, BLUR)
                ordered = values[scores.argsort(descending=True, stable=True)]
            targets = ordered.numpy().astype(np.float64) * layout.scales
            for parameters in layout.parameters(targets[: 1 if source is _means else DRAWS]):
                yield PrimitiveCall(name, parameters)


def _means(mixture: Mixture) -> torch.Tensor:
    """Return the means of components that take part, of a mixture alone, ``(k, D)``."""
    return mixture.means[0][mixture.logits[0] > -torch.inf]
