"""The IDM ``mlp-gmm`` and the policy ``prime`` seen through a perception."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from prime_core.arrays import Floats, Indices
from prime_core.contracts.calls import PrimitiveCall
from prime_core.contracts.idm import InverseDynamicsModel
from prime_core.contracts.observations import Observations
from prime_core.contracts.policy import PrimitivePolicy
from prime_policies.perception.perception import Perception
from prime_policies.perception.settings import SEES


class ImageIdm(InverseDynamicsModel):
    """An IDM of object poses that are told from images."""

    sees = SEES

    def __init__(self, perception: Perception, model: InverseDynamicsModel) -> None:
        self.space = model.space
        self._perception, self._model = perception, model

    def encode(self, seen: Observations) -> NDArray[np.float32]:
        """Look at each instant once; see `InverseDynamicsModel`."""
        return self._model.encode(self._perception.see(seen))

    def score(self, features: NDArray[np.float32], pairs: Indices) -> NDArray[np.float32]:
        """Return log p(primitive | s, s'); see `InverseDynamicsModel`."""
        return self._model.score(features, pairs)

    def parameters(
        self, features: NDArray[np.float32], pairs: Indices, labels: Indices
    ) -> tuple[Floats, Floats]:
        """Return parameters and log density; see `InverseDynamicsModel`."""
        return self._model.parameters(features, pairs, labels)


class ImagePolicy(PrimitivePolicy):
    """A policy of object poses that are told from images."""

    sees = SEES

    def __init__(self, perception: Perception, policy: PrimitivePolicy) -> None:
        self.cameras = perception.cameras
        self._perception, self._policy = perception, policy

    def candidates(
        self, seen: Observations, startable: NDArray[np.bool_], generator: np.random.Generator
    ) -> Iterator[PrimitiveCall]:
        """Look once, and yield calls; see `PrimitivePolicy`."""
        yield from self._policy.candidates(self._perception.see(seen), startable, generator)

    def draw(
        self, seen: Observations, startable: NDArray[np.bool_], generator: np.random.Generator
    ) -> PrimitiveCall:
        """Look, and draw a call; see `PrimitivePolicy`."""
        return self._policy.draw(self._perception.see(seen), startable, generator)
