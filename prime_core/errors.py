"""The errors that a user can cause."""

import difflib
from collections.abc import Iterable


class PrimeError(Exception):
    """Root of all errors that a user can cause; its text says what would be right."""


class ConfigurationError(PrimeError):
    """A setting is wrong. The text names the file and the key."""


class UnknownObjectsError(PrimeError):
    """Something asks where objects are, in a scene that does not tell."""

    def __init__(self) -> None:
        super().__init__(
            "object poses are asked for, but this scene does not tell them: only models that see "
            "objects, priors and success criteria may look at them"
        )


class UnknownTypeError(ConfigurationError):
    """A name is asked for that nothing is registered under.

    Args:
        kind: What was asked for, such as ``"environment"``.
        name: The name that is not there.
        known: The names that are.
        advice: What else the reader may do.
    """

    def __init__(self, kind: str, name: str, known: Iterable[str], advice: str = "") -> None:
        names = sorted(known)
        near = difflib.get_close_matches(name, names, n=1, cutoff=0.4)
        guess = f" Did you mean {near[0]!r}?" if near else ""
        listing = ", ".join(names) or "none"
        super().__init__(
            f"no {kind} is registered as {name!r}.{guess} Registered: {listing}.{advice}"
        )


class PluginError(PrimeError):
    """A plugin is broken."""


class DatasetError(PrimeError):
    """A data set is broken, or not what it is asked to be."""


class DemonstrationError(DatasetError):
    """One demonstration cannot be used; others of the same source may be."""


class WeightsError(PrimeError):
    """A folder does not hold the trained weights that are asked for."""


class DamagedError(PrimeError):
    """A file that prime wrote is no longer what it wrote."""
