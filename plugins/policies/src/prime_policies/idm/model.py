"""The inverse dynamics model ``mlp-gmm`` at work."""

import numpy as np
import torch
from numpy.typing import NDArray

from prime_core.arrays import Floats, Indices
from prime_core.contracts.idm import InverseDynamicsModel
from prime_core.contracts.observations import Observations
from prime_policies.networks.mixture import best_means, log_density
from prime_policies.training.call_networks import CallNetworks
from prime_policies.training.repeatable import threads

BATCH = 2048  # pairs whose hidden layers stay in the cache of one core


class MlpGmmIdm(InverseDynamicsModel):
    """Two trained networks on pairs of instants."""

    def __init__(self, networks: CallNetworks) -> None:
        self.space = networks.space
        self._networks = networks

    def encode(self, seen: Observations) -> NDArray[np.float32]:
        """Return each instant's features and, after them, its poses; see `InverseDynamicsModel`."""
        poses = self._networks.frames.encode(seen).reshape(len(seen), -1)
        return np.hstack((self._networks.features.encode(seen), poses))

    @threads()
    @torch.inference_mode()
    def score(self, features: NDArray[np.float32], pairs: Indices) -> NDArray[np.float32]:
        """Return log p(primitive | s, s'); see `InverseDynamicsModel.score`."""
        classifier = self._networks.classifier
        scores = np.empty((len(pairs), len(self.space.names) + 1), dtype=np.float32)
        starts, ends = classifier.trunk.halves(self._features(features))
        for first in range(0, len(pairs), BATCH):
            start, end = torch.from_numpy(pairs[first : first + BATCH]).T
            hidden = classifier.trunk.finish(starts[start] + ends[end])
            scores[first : first + BATCH] = classifier.log_probabilities(hidden).numpy()
        return scores

    @threads()
    @torch.inference_mode()
    def parameters(
        self, features: NDArray[np.float32], pairs: Indices, labels: Indices
    ) -> tuple[Floats, Floats]:
        """Return the mean of the weightiest component and its log density."""
        values, density = np.zeros((len(pairs), self.space.width)), np.empty(len(pairs))
        encoded = features[:, self._networks.features.width :].reshape(len(features), -1, 4)
        seen = self._features(features)
        for label in np.unique(labels):
            layout = self._networks.layouts[label]
            of_label = np.flatnonzero(labels == label)
            for rows in np.array_split(of_label, -(-len(of_label) // BATCH)):
                poses = torch.from_numpy(self._networks.frames.poses(encoded, pairs[rows])).float()
                mixture = self._networks.mixtures(seen[pairs[rows]], poses, label)
                best = best_means(mixture)
                targets = best.numpy().astype(np.float64) * layout.scales
                values[rows, : len(layout.scales)] = layout.parameters(targets)
                density[rows] = log_density(mixture, best).numpy() + layout.density_shift
        return values, density

    def _features(self, features: NDArray[np.float32]) -> torch.Tensor:
        return torch.from_numpy(features[:, : self._networks.features.width])
