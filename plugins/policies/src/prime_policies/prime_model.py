"""The policy ``prime`` at work."""

from collections.abc import Callable, Iterator
from functools import partial

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from prime_core.contracts.calls import PrimitiveCall, PrimitiveSpace
from prime_core.contracts.description import SceneDescription
from prime_core.contracts.observations import ENVIRONMENT_STATE_KEY, STATE_KEY, Frames
from prime_core.contracts.policy import Policy
from prime_core.contracts.scene import Scene
from prime_core.features import FeatureEncoder
from prime_policies.mixture import best_means, draw
from prime_policies.networks import Classifier, ParameterNetwork
from prime_policies.parameter_codec import ParameterCodec
from prime_policies.threads import one_thread
from prime_policies.turned_calls import calls_at_any_yaw, turned_calls

DRAWS = 50  # of parameters, where the most likely ones are not feasible


class PrimePolicy(Policy):
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

    @torch.inference_mode()
    def act(
        self,
        scene: Scene,
        startable: NDArray[np.bool_],
        feasible: Callable[[PrimitiveCall], bool],
        generator: np.random.Generator,
    ) -> PrimitiveCall:
        """Draw a primitive that can start, with its most likely parameters that are feasible.

        The primitive is drawn from p(p | s), because the most likely one would be chosen again
        for ever where it changes nothing. Its parameters are the mean of the mixture's weightiest
        component or, where that is not feasible, the same turned to another good yaw of the object
        or to any other, or the likeliest of some draws from the mixture that is. Where none is,
        another primitive is drawn; where no primitive has one, the first mean is returned.
        """
        observation = scene.observation()
        frame = Frames(observation[STATE_KEY][None], observation[ENVIRONMENT_STATE_KEY][None])
        features = torch.from_numpy(self._encoder.encode(frame))[None]
        with one_thread():
            scores = np.where(startable, self._classifier(features)[0].double().numpy(), -np.inf)
            chances = np.exp(scores - scores.max())
            first = None
            while chances.any():
                label = int(generator.choice(len(chances), p=chances / chances.sum()))
                for call in self._calls(scene, features, label, generator):
                    if feasible(call):
                        return call
                    first = first or call
                chances[label] = 0.0
        assert first is not None, "at least one primitive can start"
        return first

    def _calls(
        self, scene: Scene, features: Tensor, label: int, generator: np.random.Generator
    ) -> Iterator[PrimitiveCall]:
        """Yield calls of a primitive: the most likely one, then draws, each also turned."""
        labels, yaw = np.array([label]), np.array([scene.gripper_yaw])
        mixture = self._parameter_network(features, torch.from_numpy(labels))
        name, own = self._space.names[label], self._space.parameter_spaces[label]
        for propose in (best_means, partial(draw, count=DRAWS, generator=generator)):
            targets = propose(mixture)
            count = len(targets)
            values = self._codec.parameters(
                targets.numpy().astype(np.float64), labels.repeat(count), yaw.repeat(count)
            )
            for parameters in values:
                call = PrimitiveCall(name, parameters[: len(own)])
                yield call
                yield from turned_calls(call, own, scene)
                if propose is best_means:
                    yield from calls_at_any_yaw(call, own)
