"""The contract of a primitive."""

from abc import ABC, abstractmethod
from collections.abc import Generator, Sequence

import numpy as np

from prime_core.arrays import Array
from prime_core.configuration import Config
from prime_core.contracts.calls import ParameterSpace
from prime_core.contracts.description import SceneDescription
from prime_core.contracts.environment import Action
from prime_core.contracts.scene import Scene

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
