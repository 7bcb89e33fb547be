"""How a check says what is wrong."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from prime_core.contracts.observations import Modality
from prime_core.contracts.training import TrainableConfig
from prime_core.errors import PrimeError


class CheckError(PrimeError):
    """A third party's part breaks its contract; the text says what would keep it."""


def require(holds: bool, text: str) -> None:
    """Raise unless a requirement holds.

    Args:
        holds: Whether it does.
        text: What is wrong, and what would be right.

    Raises:
        CheckError: If it does not hold.
    """
    if not holds:
        raise CheckError(text)


def require_array(value: Any, shape: tuple[int, ...], kind: type[np.generic], subject: str) -> None:
    """Raise unless a value is a finite array.

    Args:
        value: What to look at.
        shape: What its shape must be.
        kind: What its dtype must be or derive from, such as ``np.floating``.
        subject: What the text calls it.

    Raises:
        CheckError: If it is something else.
    """
    wanted = f"it must be a numpy array {shape} of {kind.__name__}"
    require(isinstance(value, np.ndarray), f"{subject} is a {type(value).__name__}: {wanted}")
    found = f"{subject} is {value.shape} of {value.dtype}"
    require(value.shape == shape and np.issubdtype(value.dtype, kind), f"{found}: {wanted}")
    finite = bool(np.all(np.isfinite(value)))
    require(finite, f"{subject} holds {value}: all its numbers must be finite")


def require_bool(value: Any, subject: str) -> None:
    """Raise unless a value is True or False itself, not something like it.

    Raises:
        CheckError: If it is something else, such as a numpy bool.
    """
    require(
        isinstance(value, bool),
        f"{subject} is {value!r}, a {type(value).__name__}: it must be True or False; "
        "put bool(...) around it",
    )


def require_images_agree(sees: Sequence[Modality], config: TrainableConfig) -> None:
    """Require that a model sees images where its settings say so, and only there."""
    require(
        ("images" in sees) == ("images" in config.modalities),
        f"the model sees {tuple(sees)}, its settings' modalities are {config.modalities}: both or "
        "neither must name images, for a run makes images by what the settings say",
    )


def require_missing_is_told(load: Callable[[], object], place: str) -> None:
    """Require that loading what was never trained raises a PrimeError.

    Args:
        load: Loads it.
        place: What there is instead, for the text.

    Raises:
        CheckError: If it raises another error, or none.
    """
    try:
        load()
    except PrimeError:
        return
    except Exception as problem:  # a stranger's code
        raise CheckError(
            f"load() of {place} raises {type(problem).__name__}: it must raise a PrimeError that "
            "says what is missing"
        ) from problem
    raise CheckError(f"load() of {place} returns a model: it must raise a PrimeError")
