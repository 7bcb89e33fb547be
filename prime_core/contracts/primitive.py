"""The contract of a primitive."""

from abc import ABC, abstractmethod
from collections.abc import Generator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Self

import numpy as np
from pydantic import model_validator

from prime_core.arrays import Array, Floats
from prime_core.configuration import Config, LocalPath
from prime_core.contracts.calls import ParameterSpace
from prime_core.contracts.demonstration import Demonstration
from prime_core.contracts.description import SceneDescription
from prime_core.contracts.environment import Action
from prime_core.contracts.scene import Scene
from prime_core.contracts.training import Progress, no_progress

Motion = Generator[Action, Scene, None]
"""Yields motor actions, is sent the scene after each, and returns when it is done."""


class Primitive(ABC):
    """A parameterised movement pattern, such as a grasp.

    It knows the world through scenes only, so that it works in any environment that gives them.

    Attributes:
        name: What primitive calls name it by, unique in an experiment.
        parameter_space: Names, units and bounds of its parameters.
        maximum_steps: Motor actions after which it is stopped.
    """

    name: str
    parameter_space: ParameterSpace
    maximum_steps: int

    @abstractmethod
    def can_start(self, scene: Scene) -> bool:
        """Whether it makes sense in this scene; a grasp does not with something held."""

    @abstractmethod
    def propose(self, scene: Scene, generator: np.random.Generator) -> Array:
        """Draw parameters ``(P,)`` from the prior: near where the primitive makes sense."""

    def reachable(self, scene: Scene, parameters: Array) -> bool:
        """Whether the arm can do it from this scene; asked before a draw is tried."""
        return self.parameter_space.contains(parameters)

    @abstractmethod
    def motion(self, scene: Scene, parameters: Array) -> Motion:
        """Return the motion that starts in a scene.

        Args:
            scene: Where it starts.
            parameters: ``(P,)``, in the units of the parameter space, world frame.
        """

    @abstractmethod
    def succeeded(self, scenes: Sequence[Scene], parameters: Array) -> bool:
        """Whether it did what it is for.

        Args:
            scenes: The scene it started in and the scene after each of its steps.
            parameters: What it was called with, ``(P,)``.
        """


class PrimitiveConfig(Config):
    """Settings of a primitive; what packs register."""

    @abstractmethod
    def build(self, description: SceneDescription) -> Primitive:
        """Make the primitive for the scenes of an environment."""


@dataclass(frozen=True, eq=False)
class PrimitiveExamples:
    """The segments of demonstrations that show one primitive.

    Attributes:
        name: What the segments call it.
        space: Of its parameters, as the data set has it.
        executions: The frames of each segment, its first and last included, ``n`` of them; the
            action of each last frame leads out of the segment.
        parameters: Of each, in the units of the space, world frame, ``(n, P)``.
    """

    name: str
    space: ParameterSpace
    executions: tuple[Demonstration, ...]
    parameters: Floats


@dataclass(frozen=True, kw_only=True)
class PrimitiveTraining:
    """Where and how a primitive is trained.

    It knows no environment, as `TrainingContext` does: segments come from a data set alone.

    Attributes:
        folder: Where it is kept. A training that was interrupted there goes on after its last
            finished epoch.
        seed: Of all random draws.
        device: ``cpu``, ``cuda``, or ``auto`` for a GPU if there is one.
        progress: Told of finished epochs.
    """

    folder: Path
    seed: int
    device: str = "auto"
    progress: Progress = no_progress


class LearnedPrimitiveConfig(PrimitiveConfig):
    """Settings of a primitive that is trained on segments of demonstrations.

    An experiment trains it on the data set that ``segments`` names, or takes what was trained
    before from ``trained``; one of the two is given.
    """

    segments: LocalPath | None = None
    """Folder of a LeRobot data set with prime's segments, to train on; null if ``trained``."""
    trained: LocalPath | None = None
    """Folder of what was trained before, as ``prime learn-primitives`` writes it."""

    @model_validator(mode="after")
    def _one_source(self) -> Self:
        if (self.segments is None) == (self.trained is None):
            raise ValueError(
                "give either segments, a LeRobot data set with prime's segments to train on, or "
                "trained, a folder that 'prime learn-primitives' wrote"
            )
        return self

    @classmethod
    @abstractmethod
    def for_segments(cls, name: str, segments: Path) -> Self | None:
        """Return settings that learn the segments of a name; None where these do not."""

    @property
    @abstractmethod
    def learns(self) -> str:
        """Name of the segments that it learns from."""

    @property
    @abstractmethod
    def called(self) -> str:
        """What primitive calls name it by."""

    @abstractmethod
    def fit(self, examples: PrimitiveExamples, training: PrimitiveTraining) -> None:
        """Train the primitive, and leave it in a folder.

        Args:
            examples: One at least.
            training: Where and how.

        Raises:
            PrimeError: If there is too little to learn from, or a loss is not finite.
        """

    def with_trained(self, folder: Path) -> Self:
        """Return the settings with what `fit` left in a folder, ready to be built."""
        own = self.model_dump(exclude_defaults=True, exclude={"segments"})
        return type(self)(**own, trained=folder)
