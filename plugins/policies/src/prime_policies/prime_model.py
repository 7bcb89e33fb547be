"""The policy ``prime`` at work."""

from collections.abc import Iterator
from functools import partial

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from prime_core.contracts.calls import PrimitiveCall, PrimitiveSpace
from prime_core.contracts.description import SceneDescription
from prime_core.contracts.observations import Observations
from prime_core.contracts.policy import PrimitivePolicy
from prime_policies.mixture import best_means, draw
from prime_policies.networks import Classifier, ParameterNetwork
from prime_policies.parameter_codec import ParameterCodec
from prime_policies.scene_features import FeatureEncoder
from prime_policies.threads import one_thread

DRAWS = 50  # of parameters, where the most likely ones are not feasible


class PrimePolicy(PrimitivePolicy):
    """Two networks on a single frame.

    Args:
        description: Of the scenes.
        space: The primitives to choose from.
        classifier: Of the next primitive.
        parameter_network: Of its parameters.
    """

    def __init__(
        self,
        description: SceneDescription,
        space: PrimitiveSpace,
        classifier: Classifier,
        parameter_network: ParameterNetwork,
    ) -> None:
        self._space = space
        self._encoder = FeatureEncoder(description)
        self._codec = ParameterCodec(space)
        self._classifier, self._parameter_network = classifier, parameter_network

    def candidates(
        self, seen: Observations, startable: NDArray[np.bool_], generator: np.random.Generator
    ) -> Iterator[PrimitiveCall]:
        """Draw a primitive that can start, and yield its calls, then another one's, and so on.

        The primitive is drawn from p(p | s), because the most likely one would be chosen again
        for ever where it changes nothing. Its calls are the mean of the mixture's weightiest
        component, then draws from the mixture, the likeliest first.
        """
        features = torch.from_numpy(self._encoder.encode(seen))[None]
        yaw = float(seen.gripper_yaw[0])
        with one_thread(), torch.inference_mode():
            logits = self._classifier(features)[0].double().numpy()
        scores = np.where(startable, logits, -np.inf)
        chances = np.exp(scores - scores.max())
        while chances.any():
            label = int(generator.choice(len(chances), p=chances / chances.sum()))
            yield from self._calls(features, yaw, label, generator)
            chances[label] = 0.0

    def _calls(
        self, features: Tensor, yaw: float, label: int, generator: np.random.Generator
    ) -> Iterator[PrimitiveCall]:
        """Yield calls of a primitive: the most likely one, then draws."""
        labels, yaws = np.array([label]), np.array([yaw])
        with one_thread(), torch.inference_mode():
            mixture = self._parameter_network(features, torch.from_numpy(labels))
        name, own = self._space.names[label], self._space.parameter_spaces[label]
        for propose in (best_means, partial(draw, count=DRAWS, generator=generator)):
            with one_thread(), torch.inference_mode():
                targets = propose(mixture).numpy().astype(np.float64)
            count = len(targets)
            values = self._codec.parameters(targets, labels.repeat(count), yaws.repeat(count))
            for parameters in values:
                yield PrimitiveCall(name, parameters[: len(own)])
