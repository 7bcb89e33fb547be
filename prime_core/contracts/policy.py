"""The contract of a policy over primitives: p(primitive | s) and p(parameters | s, primitive)."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from prime_core.configuration import Config
from prime_core.contracts.calls import PrimitiveCall, PrimitiveSpace
from prime_core.contracts.description import SceneDescription
from prime_core.contracts.scene import Scene
from prime_core.contracts.training import PolicyData, Progress


class Policy(ABC):
    """Picks the next primitive call."""

    @abstractmethod
    def act(
        self,
        scene: Scene,
        startable: NDArray[np.bool_],
        feasible: Callable[[PrimitiveCall], bool],
        generator: np.random.Generator,
    ) -> PrimitiveCall:
        """Return the primitive call to make.

        Args:
            scene: The scene as it is now.
            startable: For each primitive, in the order of the primitive space, whether it can
                start here; at least one can.
            feasible: Tells whether a call of one of them makes sense here: whether the arm can do
                it, and it did not come to nothing before. A policy that has several calls to
                choose from can leave out those that do not.
            generator: Of all random draws.
        """


class PolicyConfig(Config):
    """Settings of a policy; what packs register."""

    pretrain: bool = True
    """Whether the policy is first trained on the rollouts of the primitives."""

    @abstractmethod
    def count_checkpoints(self) -> int:
        """How many checkpoints a training leaves."""

    @abstractmethod
    def fit(
        self,
        rollouts: PolicyData | None,
        demonstrations: PolicyData,
        description: SceneDescription,
        space: PrimitiveSpace,
        folder: Path,
        seed: int,
        progress: Progress,
    ) -> Sequence[Path]:
        """Train a policy.

        Args:
            rollouts: What to pretrain on, or None.
            demonstrations: The parsed and augmented demonstrations.
            description: Of the environment.
            space: The primitives to choose from.
            folder: Where checkpoints are kept. A training that was interrupted there goes on
                after its last finished epoch.
            seed: Of all random draws.
            progress: Told of finished epochs.

        Returns:
            The checkpoints, oldest first.
        """

    @abstractmethod
    def load(
        self, checkpoint: Path, description: SceneDescription, space: PrimitiveSpace
    ) -> Policy:
        """Load one checkpoint that `fit` returned.

        Raises:
            PrimeError: If it is not a checkpoint of these settings.
        """
