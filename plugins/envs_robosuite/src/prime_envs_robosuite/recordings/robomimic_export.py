"""Writing demonstrations as an HDF5 file that robomimic trains on, and that is read back here."""

from collections.abc import Iterable
from pathlib import Path
from typing import ClassVar

from pydantic import Field

from prime_core.contracts.demonstration import Demonstration
from prime_core.contracts.environment import EnvironmentConfig
from prime_core.contracts.exporter import ExporterConfig
from prime_core.errors import DatasetError, PrimeError
from prime_core.files import new_file
from prime_envs_robosuite.config import CleanUpConfig, RobosuiteConfig, TidyUpConfig
from prime_envs_robosuite.recordings.recorded_tasks import recorded_task

NAME = "robomimic"


class RobomimicConfig(ExporterConfig):
    """robomimic's HDF5 file of a robosuite task, with low-dimensional observations.

    Images of demonstrations that have some are written, too. What robomimic passes over and
    'robosuite-hdf5' reads are the simulator's whole states.
    """

    suffix: ClassVar[str] = ".hdf5"

    validation_share: float = Field(0.0, ge=0, lt=1)
    """Share of the demonstrations that ``mask/valid`` names, the others are in ``mask/train``; with
    0 there are no masks."""
    seed: int = Field(0, ge=0, lt=2**63)
    """Of the draw of those."""

    def export(
        self, demonstrations: Iterable[Demonstration], environment: EnvironmentConfig, target: Path
    ) -> None:
        """Write demonstrations; see `ExporterConfig`."""
        if target.exists():
            raise DatasetError(f"{target}: is there already: choose another file")
        task = task_name(environment)
        from prime_envs_robosuite.recorder import build_for_recording
        from prime_envs_robosuite.recordings.robomimic_writer import (
            write_demonstrations,
            write_masks,
        )

        built = build_for_recording(environment, NAME)
        try:
            with new_file(target) as partial:
                names = write_demonstrations(partial, demonstrations, built, task)
                if self.validation_share:
                    write_masks(partial, names, self.validation_share, self.seed)
        finally:
            built.close()


def task_name(environment: EnvironmentConfig) -> str:
    """Return what robosuite calls the task of an environment; ours that it has not, our name.

    Raises:
        PrimeError: If it is no environment of this pack.
    """
    match environment:
        case TidyUpConfig():
            return f"TidyUp{environment.variant}"
        case CleanUpConfig():
            return f"CleanUp{environment.variant.capitalize()}"
        case RobosuiteConfig():
            return recorded_task(environment, NAME)
    raise PrimeError(
        f"exporter {NAME!r} writes demonstrations of robosuite environments, such as "
        f"'robosuite/lift'; it cannot write those of {type(environment).__name__}"
    )
