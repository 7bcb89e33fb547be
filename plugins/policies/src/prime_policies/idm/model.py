"""The inverse dynamics model ``mlp-gmm`` at work."""

import numpy as np
import torch
from numpy.typing import NDArray

from prime_core.arrays import Floats, Indices
from prime_core.contracts.calls import PrimitiveSpace
from prime_core.contracts.idm import InverseDynamicsModel
from prime_core.contracts.observations import Observations
from prime_policies.networks.classifier import Classifier
from prime_policies.networks.mixture import best_means, log_density
from prime_policies.networks.parameter_network import ParameterNetwork
from prime_policies.training.call_examples import CallEncoder
from prime_policies.training.threads import threads

BATCH = 2048  # pairs whose hidden layers stay in the cache of one core


class MlpGmmIdm(InverseDynamicsModel):
    """Two networks on pairs of instants.

    Args:
        space: The primitives to tell apart.
        encoder: Of instants and pairs.
        classifier: Of pairs.
        parameter_network: Of pairs.
    """

    def __init__(
        self,
        space: PrimitiveSpace,
        encoder: CallEncoder,
        classifier: Classifier,
        parameter_network: ParameterNetwork,
    ) -> None:
        self.space = space
        self._encoder = encoder
        self._classifier, self._parameter_network = classifier, parameter_network

    def encode(self, seen: Observations) -> NDArray[np.float32]:
        """Return each instant's features and, after them, its poses; see `InverseDynamicsModel`."""
        poses = self._encoder.frames.encode(seen).reshape(len(seen), -1)
        return np.hstack((self._encoder.features.encode(seen), poses))

    @torch.inference_mode()
    def score(self, features: NDArray[np.float32], pairs: Indices) -> NDArray[np.float32]:
        """Return log p(primitive | s, s'); see `InverseDynamicsModel.score`."""
        trunk = self._classifier.trunk
        scores = np.empty((len(pairs), len(self.space.names) + 1), dtype=np.float32)
        with threads():
            starts, ends = trunk.halves(self._features(features))
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
        values, density = np.zeros((len(pairs), self.space.width)), np.empty(len(pairs))
        encoded = features[:, self._encoder.features.width :].reshape(len(features), -1, 4)
        network, seen = self._parameter_network, self._features(features)
        with threads():
            for label in np.unique(labels):
                layout = self._encoder.layouts[label]
                of_label = np.flatnonzero(labels == label)
                for rows in np.array_split(of_label, -(-len(of_label) // BATCH)):
                    poses = torch.from_numpy(self._encoder.frames.poses(encoded, pairs[rows]))
                    mixture = network(seen[torch.from_numpy(pairs[rows])], poses.float(), label)
                    best = best_means(mixture)
                    targets = best.numpy().astype(np.float64) * layout.scales
                    values[rows, : len(layout.scales)] = layout.parameters(targets)
                    density[rows] = log_density(mixture, best).numpy() + layout.density_shift
        return values, density

    def _features(self, features: NDArray[np.float32]) -> torch.Tensor:
        return torch.from_numpy(features[:, : self._encoder.features.width])
