"""The contracts of policies: over primitives, and over motor actions.

A policy over primitives yields calls; a runner that makes one of them and runs it is itself a
motor policy (`prime_core.execution.runner`), so that both kinds are evaluated alike.
"""

from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from prime_core.contracts.calls import PrimitiveCall
from prime_core.contracts.demonstration import Demonstration
from prime_core.contracts.environment import Action
from prime_core.contracts.images import CameraConfig
from prime_core.contracts.observations import Modality, Observations
from prime_core.contracts.training import (
    CallData,
    ModelContext,
    TrainableConfig,
    TrainingContext,
)


class PrimitivePolicy(ABC):
    """Picks the next primitive call: p(primitive | s) and p(parameters | s, primitive).

    Attributes:
        sees: What it looks at; it is given nothing else.
        cameras: What it sees images through; None where it sees none.
    """

    sees: tuple[Modality, ...] = ("proprioception", "objects")
    cameras: CameraConfig | None = None

    @abstractmethod
    def candidates(
        self,
        seen: Observations,
        startable: NDArray[np.bool_],
        generator: np.random.Generator,
    ) -> Iterator[PrimitiveCall]:
        """Yield calls, the one to make first; which one is made is the runner's business.

        Args:
            seen: One instant, ``N = 1``.
            startable: For each primitive, in the order of the primitive space, whether it can
                start here, ``(primitives,)``; at least one can. Others are not yielded.
            generator: Of all random draws.
        """

    def draw(
        self,
        seen: Observations,
        startable: NDArray[np.bool_],
        generator: np.random.Generator,
    ) -> PrimitiveCall:
        """Return a call drawn from p(call | seen), as the paper makes them; see `candidates`.

        A policy that has no such distribution gives its first candidate.
        """
        return next(self.candidates(seen, startable, generator))


class MotorPolicy(ABC):
    """Acts step by step, as LeRobot's ``reset`` and ``select_action`` do: numpy, one instant.

    Attributes:
        sees: What it looks at; it is given nothing else.
        cameras: What it sees images through; None where it sees none.
    """

    sees: tuple[Modality, ...] = ("proprioception", "objects")
    cameras: CameraConfig | None = None

    @abstractmethod
    def reset(self, generator: np.random.Generator) -> None:
        """Forget the episode before.

        Args:
            generator: Of all random draws of the episode to come.
        """

    @abstractmethod
    def act(self, seen: Observations) -> Action | None:
        """Return the next motor action, or None to give the episode up.

        An action is as wide as those of the demonstrations, ``(A,)``; 5 numbers on a robot.

        Args:
            seen: One instant, ``N = 1``.
        """


class PolicyConfig(TrainableConfig):
    """Settings of a policy; what packs register are subclasses of the two below."""

    @abstractmethod
    def count_checkpoints(self) -> int:
        """How many checkpoints a training leaves."""


class PrimitivePolicyConfig(PolicyConfig):
    """Settings of a policy over primitives."""

    pretrain: bool = True
    """Whether the policy is first trained on the rollouts of the primitives."""

    @abstractmethod
    def fit(
        self, rollouts: CallData | None, demonstrations: CallData, context: TrainingContext
    ) -> Sequence[Path]:
        """Train a policy.

        Args:
            rollouts: What to pretrain on, or None.
            demonstrations: The parsed and augmented demonstrations.
            context: Where and how.

        Returns:
            The checkpoints, oldest first.

        Raises:
            PrimeError: If a loss or weight is not finite; nothing is kept as done.
        """

    @abstractmethod
    def load(self, checkpoint: Path, context: ModelContext) -> PrimitivePolicy:
        """Load one checkpoint that `fit` returned.

        Raises:
            PrimeError: If it is not a checkpoint of these settings.
        """


class MotorPolicyConfig(PolicyConfig):
    """Settings of a policy over motor actions."""

    pretrain: bool = False
    """Whether the policy is first trained on all motor actions of the rollouts."""

    @abstractmethod
    def fit(
        self,
        rollouts: Sequence[Demonstration] | None,
        demonstrations: Sequence[Demonstration],
        context: TrainingContext,
    ) -> Sequence[Path]:
        """Train a policy; see `PrimitivePolicyConfig.fit`.

        All actions are equally wide, but not always the 5 numbers of a robot: what is learnt from
        may hold more. The last frame of each episode has no action that was done.

        Args:
            rollouts: What to pretrain on, or None. An episode is read each time that it is
                indexed, and going through them in order is fastest.
            demonstrations: As they were recorded.
            context: Where and how; its primitive space is empty.

        Returns:
            The checkpoints, oldest first; none of a training on rollouts alone.
        """

    @abstractmethod
    def load(self, checkpoint: Path, context: ModelContext) -> MotorPolicy:
        """Load one checkpoint; see `PrimitivePolicyConfig.load`."""
