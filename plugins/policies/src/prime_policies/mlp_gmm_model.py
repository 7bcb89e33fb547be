"""The inverse dynamics model ``mlp-gmm`` at work."""

import numpy as np
import torch
from numpy.typing import NDArray

from prime_core.arrays import Floats, Indices
from prime_core.contracts.calls import PrimitiveSpace
from prime_core.contracts.description import SceneDescription
from prime_core.contracts.idm import InverseDynamicsModel
from prime_core.contracts.observations import Observations
from prime_policies.mixture import best_means, log_density
from prime_policies.networks import Classifier, ParameterNetwork
from prime_policies.parameter_codec import ParameterCodec
from prime_policies.scene_features import FeatureEncoder, gripper_yaw
from prime_policies.threads import one_thread

BATCH = 2048  # pairs whose hidden layers stay in the cache of one core


class MlpGmmIdm(InverseDynamicsModel):
    """Two networks on pairs of frames.

    Args:
        description: Of the scenes.
        space: The primitives to tell apart.
        classifier: Of pairs.
        parameter_network: Of pairs.
    """

    def __init__(
        self,
        description: SceneDescription,
        space: PrimitiveSpace,
        classifier: Classifier,
        parameter_network: ParameterNetwork,
    ) -> None:
        self.space = space
        self._encoder = FeatureEncoder(description)
        self._codec = ParameterCodec(space)
        self._classifier, self._parameter_network = classifier, parameter_network

    def encode(self, seen: Observations) -> NDArray[np.float32]:
        """Return the features of each frame and, last, the gripper's yaw [rad]."""
        yaw = gripper_yaw(seen).astype(np.float32)
        return np.hstack((self._encoder.encode(seen), yaw[:, None]))

    @torch.inference_mode()
    def score(self, features: NDArray[np.float32], pairs: Indices) -> NDArray[np.float32]:
        """Return log p(primitive | s, s'); see `InverseDynamicsModel.score`."""
        trunk = self._classifier.trunk
        scores = np.empty((len(pairs), len(self.space.names) + 1), dtype=np.float32)
        with one_thread():
            starts, ends = trunk.halves(torch.from_numpy(features[:, :-1]))
            for first in range(0, len(pairs), BATCH):
                start, end = torch.from_numpy(pairs[first : first + BATCH]).T
                hidden = trunk.finish(starts[start] + ends[end])
                result = self._classifier.log_probabilities(hidden)
                scores[first : first + BATCH] = result.numpy()
        return scores

    @torch.inference_mode()
    def parameters(
        self, features: NDArray[np.float32], pairs: Indices, labels: Indices
    ) -> tuple[Floats, Floats]:
        """Return the mean of the weightiest component and its log density."""
        targets, density = np.empty((len(pairs), self.space.width)), np.empty(len(pairs))
        with one_thread():
            for first in range(0, len(pairs), BATCH):
                part = slice(first, first + BATCH)
                frames = torch.from_numpy(features[:, :-1][pairs[part]])
                mixture = self._parameter_network(frames, torch.from_numpy(labels[part]))
                best = best_means(mixture)
                targets[part] = best.numpy()
                density[part] = log_density(mixture, best).numpy()
        yaws = features[pairs[:, 1], -1].astype(np.float64)
        return self._codec.parameters(targets, labels, yaws), density
