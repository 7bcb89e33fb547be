"""The contract of formats that demonstrations are written in for other programs."""

from abc import abstractmethod
from collections.abc import Iterable
from pathlib import Path
from typing import ClassVar

from prime_core.configuration import Config
from prime_core.contracts.demonstration import Demonstration
from prime_core.contracts.environment import EnvironmentConfig


class ExporterConfig(Config):
    """Settings of a format that demonstrations are written in; what packs register."""

    suffix: ClassVar[str] = ""
    """Of its files, such as ``.hdf5``; empty where it writes folders."""

    @abstractmethod
    def export(
        self, demonstrations: Iterable[Demonstration], environment: EnvironmentConfig, target: Path
    ) -> None:
        """Write demonstrations, whole or not at all.

        Args:
            demonstrations: At least one. They are taken one after another, and none is held once it
                is written: who gives them may count them to tell how far it is.
            environment: That they are of.
            target: File or folder, which must not exist. Its parent is made if need be.

        Raises:
            DatasetError: If the target is there already, or a demonstration cannot be written so.
            PrimeError: If demonstrations of such an environment cannot be written so.
            OSError: If it cannot be written.
        """
