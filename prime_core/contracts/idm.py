"""The contract of an inverse dynamics model (IDM).

IDM(p, x | s, s') = IDM_prim(p | s, s') IDM_param(x | s, s', p), paper equation 2.
"""

from abc import ABC, abstractmethod
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from prime_core.arrays import Floats, Indices
from prime_core.contracts.calls import PrimitiveSpace
from prime_core.contracts.observations import Modality, Observations
from prime_core.contracts.training import (
    CallData,
    ModelContext,
    TrainableConfig,
    TrainingContext,
)


class InverseDynamicsModel(ABC):
    """Says which primitive, with what parameters, leads from one state to another.

    Attributes:
        space: The primitives that it tells apart.
        sees: What it looks at.
    """

    space: PrimitiveSpace
    sees: tuple[Modality, ...] = ("proprioception", "objects")

    @abstractmethod
    def encode(self, seen: Observations) -> NDArray[np.float32]:
        """Encode each instant once, ``(N, features)``."""

    @abstractmethod
    def score(self, features: NDArray[np.float32], pairs: Indices) -> NDArray[np.float32]:
        """Return log p(primitive | s, s').

        Args:
            features: From `encode`, ``(N, features)``.
            pairs: Start and end row, ``(n, 2)``.

        Returns:
            ``(n, primitives + 1)``; each row's exponentials sum to 1, the last is `other`.
        """

    @abstractmethod
    def parameters(
        self, features: NDArray[np.float32], pairs: Indices, labels: Indices
    ) -> tuple[Floats, Floats]:
        """Return the most likely parameters and their log density.

        Args:
            features: From `encode`, ``(N, features)``.
            pairs: ``(n, 2)``.
            labels: The primitive of each pair, ``(n,)``, below ``len(space.names)``.

        Returns:
            Parameters in their units, ``(n, space.width)``, padded with zeros, and the log
            density of each row's parameters, normalised to [-1, 1], ``(n,)``.
        """


class IdmConfig(TrainableConfig):
    """Settings of an inverse dynamics model; what packs register."""

    @abstractmethod
    def fit(self, data: CallData, context: TrainingContext) -> InverseDynamicsModel:
        """Train a model.

        Args:
            data: Labelled pairs.
            context: Where and how.

        Raises:
            PrimeError: If a loss or weight is not finite; nothing is kept as done.
        """

    @abstractmethod
    def load(self, folder: Path, context: ModelContext) -> InverseDynamicsModel:
        """Load what `fit` left in a folder.

        Raises:
            PrimeError: If the folder holds no trained model of these settings.
        """
