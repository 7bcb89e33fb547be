"""Demonstrations, the segments they are parsed into, and the contract of their sources."""

from abc import abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from prime_core.configuration import Config, ConfigDump
from prime_core.contracts.calls import OTHER, PrimitiveCall
from prime_core.contracts.environment import EnvironmentConfig
from prime_core.contracts.observations import Observations
from prime_core.errors import DatasetError, DemonstrationError


@dataclass(frozen=True, eq=False)
class Segment:
    """A stretch of a demonstration, explained.

    Attributes:
        start: Frame where it begins.
        end: Frame where it ends; the next segment starts there.
        call: The primitive call that leads from the one to the other. Its primitive is
            ``"other"`` and its parameters are empty where no primitive does.
        log_probability: As the parser scored it.
        confidence: How sure the scores are of its primitive, in [0, 1]; see
            `prime_core.parsing.confidence`. None where that is not known.
    """

    start: int
    end: int
    call: PrimitiveCall
    log_probability: float
    confidence: float | None = None

    @property
    def steps(self) -> int:
        """Motor actions that the segment covers."""
        return self.end - self.start


@dataclass(frozen=True, eq=False)
class Demonstration:
    """One recorded episode of motor actions.

    A frame is an instant; the action of a frame leads to the next. The action of the last
    frame was never done: it is a hold.

    Attributes:
        observations: What was seen in the ``N`` frames, the last one after the last action.
        actions: As in `prime_core.contracts.environment`, ``(N, 5)`` float32.
        task: What is done, in words.
        simulator_states: From ``Environment.get_state``, ``(N, n)`` float64, or None where the
            episode comes from elsewhere.
    """

    observations: Observations
    actions: NDArray[np.float32]
    task: str
    simulator_states: NDArray[np.float64] | None = None

    @property
    def steps(self) -> int:
        """Motor actions that were done."""
        return len(self.observations) - 1


class DemonstratorConfig(Config):
    """Settings of a source of demonstrations; what packs register."""

    @classmethod
    def reads(cls, source: Path) -> bool:
        """Whether ``{type: ..., path: SOURCE}`` are settings that read a file or folder."""
        return False

    def recorded_environment(self) -> ConfigDump | None:
        """Return the environment that a recording says it is of, as plain data with its ``type``.

        Returns:
            None where it does not say.

        Raises:
            DatasetError: If it cannot be read, or names one that is not known.
        """
        return None

    @abstractmethod
    def count_available(self) -> int:
        """How many demonstrations it gives."""

    @abstractmethod
    def demonstrate(self, environment: EnvironmentConfig, index: int, seed: int) -> Demonstration:
        """Return one demonstration.

        Args:
            environment: Where it is shown.
            index: Which one, below `count_available`.
            seed: Of the experiment; the demonstration depends on the seed and the index only.

        Raises:
            DemonstrationError: If this one cannot be used; others may be.
            PrimeError: If there is none to be had.
        """

    def demonstrations(
        self, environment: EnvironmentConfig, indices: Sequence[int], seed: int
    ) -> Iterator[Demonstration | DemonstrationError]:
        """Return some demonstrations, each or why it cannot be used; see `demonstrate`."""
        for index in indices:
            try:
                yield self.demonstrate(environment, index, seed)
            except DemonstrationError as error:
                yield error


class RecordedDemonstratorConfig(DemonstratorConfig):
    """Settings of a source whose demonstrations lie in one file or folder.

    `demonstrations` opens it once for all of them.
    """

    path: Path
    """Of the file or folder."""

    @abstractmethod
    def demonstrations(
        self, environment: EnvironmentConfig, indices: Sequence[int], seed: int
    ) -> Iterator[Demonstration | DemonstrationError]:
        """Return some demonstrations, each or why it cannot be used; see `demonstrate`."""

    def demonstrate(self, environment: EnvironmentConfig, index: int, seed: int) -> Demonstration:
        """Return one demonstration; see `DemonstratorConfig`."""
        (found,) = self.demonstrations(environment, [index], seed)
        if isinstance(found, DemonstrationError):
            raise found
        return found

    def check_indices(self, indices: Sequence[int]) -> None:
        """Check that there are such demonstrations.

        Raises:
            DatasetError: If there are not.
        """
        available = self.count_available()
        for index in indices:
            if not 0 <= index < available:
                raise DatasetError(f"{self.path} gives {available} demonstrations, not {index + 1}")


@dataclass(frozen=True, eq=False)
class ParsedDemonstration:
    """A demonstration and the segments that it was cut into, in order."""

    demonstration: Demonstration
    segments: tuple[Segment, ...]

    @property
    def primitives(self) -> int:
        """Number of segments that a primitive explains."""
        return sum(item.call.primitive != OTHER for item in self.segments)

    @property
    def other_steps(self) -> int:
        """Motor actions in segments that no primitive explains."""
        return sum(item.steps for item in self.segments if item.call.primitive == OTHER)
