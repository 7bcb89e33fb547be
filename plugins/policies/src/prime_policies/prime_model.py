"""The policy ``prime`` at work."""

import numpy as np
import torch
from numpy.typing import NDArray

from prime_core.features import FeatureEncoder, gripper_yaw
from prime_core.frames import Frames
from prime_core.idm import PrimitiveSpace
from prime_core.policy import Policy
from prime_core.primitive_calls import PrimitiveCall
from prime_core.scene import ENVIRONMENT_STATE_KEY, STATE_KEY, Scene, SceneDescription
from prime_policies.mixture import best_means
from prime_policies.networks import Classifier, ParameterNetwork
from prime_policies.parameter_codec import ParameterCodec
from prime_policies.threads import one_thread


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
        self, scene: Scene, startable: NDArray[np.bool_], generator: np.random.Generator
    ) -> PrimitiveCall:
        """Draw a primitive that can start, with its most likely parameters.

        The primitive is drawn from p(p | s), because the most likely one would be chosen again
        for ever where it changes nothing.
        """
        observation = scene.observation()
        frame = Frames(observation[STATE_KEY][None], observation[ENVIRONMENT_STATE_KEY][None])
        features = torch.from_numpy(self._encoder.encode(frame))[None]
        with one_thread():
            scores = np.where(startable, self._classifier(features)[0].double().numpy(), -np.inf)
            chances = np.exp(scores - scores.max())
            label = generator.choice(len(chances), size=1, p=chances / chances.sum())
            mixture = self._parameter_network(features, torch.from_numpy(label))
            targets = best_means(mixture).numpy().astype(np.float64)
        parameters = self._codec.parameters(targets, label, gripper_yaw(frame))[0]
        name, own = self._space.names[label[0]], self._space.parameter_spaces[label[0]]
        return PrimitiveCall(name, parameters[: len(own)])
