"""What models learn from, and what a training is told."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from prime_core.arrays import Flags, Floats, Indices
from prime_core.configuration import Config
from prime_core.contracts.calls import PrimitiveSpace
from prime_core.contracts.description import SceneDescription
from prime_core.contracts.images import CameraConfig
from prime_core.contracts.observations import Modality, Observations

Progress = Callable[[int, int], None]
"""Called with the number of finished parts and the number of all parts."""


def no_progress(done: int, total: int) -> None:
    """Tell nobody."""


@dataclass(frozen=True, eq=False)
class Labels:
    """Labelled rows of observations.

    Attributes:
        rows: Start and end row of each pair, ``(n, 2)``, for an inverse dynamics model; the row of
            each, ``(n, 1)``, for a policy.
        classes: Number of the primitive of each, ``(n,)``; of `other` the number of primitives.
        weights: Sampling weight of each, ``(n,)``.
    """

    rows: Indices
    classes: Indices
    weights: Floats

    def __len__(self) -> int:
        return len(self.rows)


@dataclass(frozen=True, eq=False)
class CallData:
    """Observations labelled with primitive calls: what IDMs and primitive policies learn from.

    Attributes:
        observations: What the labels' rows point into.
        types: Which primitive.
        parameters: Of which the parameters are learnt; none is `other`.
        values: Their parameters in their units, padded with zeros, ``(m, width)``.
        under_way: Of which the motion is under way, ``(m,)``; None if of none. They say where a
            motion leads, but no longer how it has to begin: see `AugmentationConfig`.
    """

    observations: Observations
    types: Labels
    parameters: Labels
    values: Floats
    under_way: Flags | None = None


@dataclass(frozen=True, kw_only=True)
class ModelContext:
    """Where a model is used.

    Attributes:
        description: Of the environment's scenes.
        space: The primitives to tell apart or choose from; a motor policy has none.
        device: Where networks are trained: ``cpu``, ``cuda``, or ``auto`` for a GPU if there is
            one. A model at work may stay on the CPU.
        cameras: What a model that sees images sees through; None for others.
    """

    description: SceneDescription
    space: PrimitiveSpace
    device: str = "auto"
    cameras: CameraConfig | None = None


class TrainableConfig(Config):
    """Settings of what is trained."""

    @property
    def modalities(self) -> tuple[Modality, ...]:
        """What the trained model will see; with images among them, training data has images."""
        return ("proprioception", "objects")

    def check_device(self, device: str) -> None:
        """Make sure that this machine can train on a device, before hours of other work.

        Args:
            device: See `ModelContext`.

        Raises:
            PrimeError: If it cannot.
        """


@dataclass(frozen=True, kw_only=True)
class TrainingContext(ModelContext):
    """Where and how a model is trained.

    Attributes:
        folder: Where it is kept. A training that was interrupted there goes on after its last
            finished epoch.
        seed: Of all random draws.
        threads: Processor threads that it may use; no result may depend on it.
        progress: Told of finished epochs.
    """

    folder: Path
    seed: int
    threads: int = 1
    progress: Progress = no_progress
