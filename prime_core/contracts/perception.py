"""The contract of a perception: what tells object poses from images.

Models of object poses that are given those of a perception are models of images.
"""

from abc import ABC, abstractmethod
from pathlib import Path
from typing import Literal

from prime_core.contracts.images import CameraConfig
from prime_core.contracts.observations import Modality, Observations
from prime_core.contracts.training import ModelContext, TrainableConfig, TrainingContext

Source = Literal["rollouts", "demonstrations"]
"""Whose frames a perception is taught on."""


class Perception(ABC):
    """Tells object poses from images.

    Attributes:
        cameras: What it sees images through.
    """

    cameras: CameraConfig

    @abstractmethod
    def see(self, seen: Observations) -> Observations:
        """Return instants with object poses that are told from images and robot state alone.

        Args:
            seen: ``N`` instants with images. Their object poses, if they have any, mean nothing.

        Returns:
            The same instants with ``environment_state`` and without images. What is told of an
            instant does not depend on the others.
        """


class PerceptionConfig(TrainableConfig):
    """Settings of a perception; what packs register."""

    taught_on: Source = "rollouts"
    """Whose frames teach it: those of the rollouts, or, for a comparison without pretraining,
    those of the demonstrations."""

    @property
    def modalities(self) -> tuple[Modality, ...]:
        """Images, and the robot's state."""
        return ("proprioception", "images")

    @abstractmethod
    def fit(self, seen: Observations, context: TrainingContext) -> Perception:
        """Train a perception.

        Args:
            seen: Instants with images and with the object poses to tell from them.
            context: Where and how; ``context.cameras`` are what it will see through.

        Raises:
            PrimeError: If a loss or weight is not finite; nothing is kept as done.
        """

    @abstractmethod
    def load(self, folder: Path, context: ModelContext) -> Perception:
        """Load what `fit` left in a folder.

        Raises:
            PrimeError: If the folder holds no trained perception of these settings.
        """
