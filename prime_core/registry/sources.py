"""Finds what reads a file or folder of demonstrations."""

from pathlib import Path

from prime_core.configuration import Config
from prime_core.contracts.demonstration import DemonstratorConfig
from prime_core.errors import DatasetError
from prime_core.registry.contained import contained
from prime_core.registry.fields import read_settings
from prime_core.registry.loading import load_plugins


def demonstrator_of(source: Path) -> DemonstratorConfig:
    """Return settings of the registered demonstrator that reads a source.

    Raises:
        DatasetError: If none does, or it cannot be opened.
    """
    try:
        source.stat()
    except (FileNotFoundError, NotADirectoryError):
        raise DatasetError(f"{source}: there is no such data set") from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise DatasetError(f"{source}: cannot be read: {reason}") from None
    registrations = load_plugins().registry.registrations("demonstrator")
    # Prime's own first: no pack takes what they read.
    for entry in sorted(registrations, key=lambda entry: not entry.plugin.is_own):
        if _reads(entry.config_class, source):
            return read_settings(DemonstratorConfig, {"type": entry.name, "path": str(source)})
    raise DatasetError(
        f"{source}: nothing that is installed reads it: it must be a LeRobot data set's folder, or "
        f"a file for one of {', '.join(entry.name for entry in registrations)}"
    )


def _reads(config_class: type[Config], source: Path) -> bool:
    """Whether settings say that they read a source; those that fail do not."""
    if not issubclass(config_class, DemonstratorConfig):
        return False
    try:
        return bool(contained(lambda: config_class.reads(source)))
    except Exception:  # a stranger's code
        return False
