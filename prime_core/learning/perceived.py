"""Models of object poses as models of images: a perception tells them the poses."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from prime_core.arrays import Floats, Indices
from prime_core.contracts.calls import PrimitiveCall
from prime_core.contracts.environment import Action
from prime_core.contracts.idm import InverseDynamicsModel
from prime_core.contracts.observations import Modality, Observations
from prime_core.contracts.perception import Perception
from prime_core.contracts.policy import MotorPolicy, PrimitivePolicy
from prime_core.contracts.training import CallData, Labels

SEES: tuple[Modality, ...] = ("proprioception", "images")
"""What a model sees that is behind a perception."""


def perceived_calls(perception: Perception, data: CallData) -> CallData:
    """Return data as a perception sees it: only what labels point into is looked at."""
    rows, places = np.unique(
        np.concatenate((data.types.rows.ravel(), data.parameters.rows.ravel())),
        return_inverse=True,
    )
    cut = data.types.rows.size
    return replace(
        data,
        observations=perception.see(data.observations[rows]),
        types=_at(data.types, places[:cut]),
        parameters=_at(data.parameters, places[cut:]),
    )


def _at(labels: Labels, places: Indices) -> Labels:
    return replace(labels, rows=places.reshape(labels.rows.shape))


class PerceivedIdm(InverseDynamicsModel):
    """An IDM of object poses that a perception tells it."""

    sees = SEES

    def __init__(self, perception: Perception, model: InverseDynamicsModel) -> None:
        self.space = model.space
        self._perception, self._model = perception, model

    def encode(self, seen: Observations) -> NDArray[np.float32]:
        """Look at each instant once; see `InverseDynamicsModel`."""
        return self._model.encode(self._perception.see(seen).only(self._model.sees))

    def score(self, features: NDArray[np.float32], pairs: Indices) -> NDArray[np.float32]:
        """Return log p(primitive | s, s'); see `InverseDynamicsModel`."""
        return self._model.score(features, pairs)

    def parameters(
        self, features: NDArray[np.float32], pairs: Indices, labels: Indices
    ) -> tuple[Floats, Floats]:
        """Return parameters and log density; see `InverseDynamicsModel`."""
        return self._model.parameters(features, pairs, labels)


class PerceivedPolicy(PrimitivePolicy):
    """A policy over primitives of object poses that a perception tells it."""

    sees = SEES

    def __init__(self, perception: Perception, policy: PrimitivePolicy) -> None:
        self.cameras = perception.cameras
        self._perception, self._policy = perception, policy

    def candidates(
        self, seen: Observations, startable: NDArray[np.bool_], generator: np.random.Generator
    ) -> Iterator[PrimitiveCall]:
        """Look once, and yield calls; see `PrimitivePolicy`."""
        yield from self._policy.candidates(self._look(seen), startable, generator)

    def draw(
        self, seen: Observations, startable: NDArray[np.bool_], generator: np.random.Generator
    ) -> PrimitiveCall:
        """Look, and draw a call; see `PrimitivePolicy`."""
        return self._policy.draw(self._look(seen), startable, generator)

    def _look(self, seen: Observations) -> Observations:
        return self._perception.see(seen).only(self._policy.sees)


class PerceivedMotorPolicy(MotorPolicy):
    """A policy over motor actions of object poses that a perception tells it."""

    sees = SEES

    def __init__(self, perception: Perception, policy: MotorPolicy) -> None:
        self.cameras = perception.cameras
        self._perception, self._policy = perception, policy

    def reset(self, generator: np.random.Generator) -> None:
        """Forget the episode before; see `MotorPolicy`."""
        self._policy.reset(generator)

    def act(self, seen: Observations) -> Action | None:
        """Look, and return the next motor action; see `MotorPolicy`."""
        return self._policy.act(self._perception.see(seen).only(self._policy.sees))
