"""The contract of an inverse dynamics model (IDM).

IDM(p, x | s, s') = IDM_prim(p | s, s') IDM_param(x | s, s', p), paper equation 2.
"""

from abc import ABC, abstractmethod
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from prime_core.arrays import Floats, Indices
from prime_core.configuration import Config
from prime_core.contracts.calls import PrimitiveSpace
from prime_core.contracts.description import SceneDescription
from prime_core.contracts.observations import Frames
from prime_core.contracts.training import PairData, Progress


class InverseDynamicsModel(ABC):
    """Says which primitive, with what parameters, leads from one state to another.

    Attributes:
        space: The primitives that it tells apart.
    """

    space: PrimitiveSpace

    @abstractmethod
    def encode(self, frames: Frames) -> NDArray[np.float32]:
        """Encode each frame once, ``(frames, features)``."""

    @abstractmethod
    def score(self, features: NDArray[np.float32], pairs: Indices) -> NDArray[np.float32]:
        """Return log p(primitive | s, s').

        Args:
            features: From `encode`, ``(frames, features)``.
            pairs: Start and end frame, ``(n, 2)``.

        Returns:
            ``(n, primitives + 1)``; each row's exponentials sum to 1, the last is `other`.
        """

    @abstractmethod
    def parameters(
        self, features: NDArray[np.float32], pairs: Indices, labels: Indices
    ) -> tuple[Floats, Floats]:
        """Return the most likely parameters and their log density.

        Args:
            features: From `encode`, ``(frames, features)``.
            pairs: ``(n, 2)``.
            labels: The primitive of each pair, ``(n,)``, below ``len(space.names)``.

        Returns:
            Parameters in their units, ``(n, space.width)``, padded with zeros, and the log
            density of each row's parameters, normalised to [-1, 1], ``(n,)``.
        """


class IdmConfig(Config):
    """Settings of an inverse dynamics model; what packs register."""

    @abstractmethod
    def fit(
        self,
        data: PairData,
        description: SceneDescription,
        space: PrimitiveSpace,
        folder: Path,
        seed: int,
        progress: Progress,
    ) -> InverseDynamicsModel:
        """Train a model.

        Args:
            data: Training pairs.
            description: Of the environment that they come from.
            space: The primitives to tell apart.
            folder: Where the model is kept. A training that was interrupted there goes on
                after its last finished epoch.
            seed: Of all random draws.
            progress: Told of finished epochs.
        """

    @abstractmethod
    def load(
        self, folder: Path, description: SceneDescription, space: PrimitiveSpace
    ) -> InverseDynamicsModel:
        """Load what `fit` left in a folder.

        Raises:
            PrimeError: If the folder holds no trained model of these settings.
        """
