"""The base of all settings: plain data, frozen, unknown keys forbidden, numbers finite."""

import difflib
import os
from abc import ABC
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any, get_args

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    ValidationError,
    model_validator,
)
from pydantic_core import InitErrorDetails, PydanticCustomError

_NO_NUMBER = PydanticCustomError("number_type", "Input should be a number")


class Config(BaseModel, ABC):
    """Settings: plain data, frozen, unknown keys forbidden, numbers finite."""

    model_config = ConfigDict(
        frozen=True, extra="forbid", allow_inf_nan=False, use_attribute_docstrings=True
    )

    @model_validator(mode="before")
    @classmethod
    def _keys_are_known(cls, data: Any) -> Any:
        # Pydantic forbids unknown keys too, but cannot say which key was meant.
        if isinstance(data, dict):
            for key in data:
                if key not in cls.model_fields:
                    raise ValueError(unknown_key(str(key), list(cls.model_fields)))
        return data

    @model_validator(mode="before")
    @classmethod
    def _truth_is_no_number(cls, data: Any) -> Any:
        # Pydantic takes true for 1.
        fields = cls.model_fields
        found = [
            InitErrorDetails(type=_NO_NUMBER, loc=(key, *place), input=truth)
            for key, value in (data.items() if isinstance(data, dict) else ())
            if key in fields and _is_numeric(fields[key].annotation)
            for place, truth in _truths(value)
        ]
        if found:
            raise ValidationError.from_exception_data(cls.__name__, found)
        return data


def _is_numeric(annotation: Any) -> bool:
    """Whether a field takes numbers, and does not take true and false."""
    kinds = list(_kinds(annotation))
    return (int in kinds or float in kinds) and bool not in kinds


def _kinds(annotation: Any) -> Iterator[Any]:
    annotation = getattr(annotation, "__value__", annotation)  # of ``type Name = ...``
    yield annotation
    for part in get_args(annotation):
        yield from _kinds(part)


def _truths(value: Any) -> Iterator[tuple[tuple[Any, ...], bool]]:
    """Yield where true or false stand in plain data, and which of them."""
    if isinstance(value, bool):
        yield (), value
    named = value.items() if isinstance(value, dict) else ()
    for key, item in enumerate(value) if isinstance(value, (list, tuple)) else named:
        for place, truth in _truths(item):
            yield (key, *place), truth


def unknown_key(key: str, known: list[str]) -> str:
    """Return the text for a key that is not there."""
    near = difflib.get_close_matches(key, known, n=1, cutoff=0.4)
    guess = f"did you mean {near[0]!r}? " if near else ""
    return f"unknown key {key!r}: {guess}There are: {', '.join(known) or 'none'}"


ConfigDump = dict[str, Any]
"""Settings as plain data, with their ``type``; what stages are identified by."""


Seed = Annotated[int, Field(ge=0, lt=2**32)]
"""Of random draws."""


Share = Annotated[float, Field(ge=0, le=1)]
"""Of a whole."""


GREATEST_COUNT = 100_000
"""Of steps, episodes or trials; far above what makes sense, far below what memory cannot hold."""


Count = Annotated[int, Field(ge=1, le=GREATEST_COUNT)]
"""How many there are, 1 at least."""


def _in_order[Number: float](value: tuple[Number, Number]) -> tuple[Number, Number]:
    if not 0 <= value[0] <= value[1]:
        raise ValueError(f"a range is two numbers, 0 <= low <= high; found {list(value)}")
    return value


def _above_zero(value: tuple[float, float]) -> tuple[float, float]:
    if value[0] <= 0:
        raise ValueError(f"both numbers are above 0; found {list(value)}")
    return value


Range = Annotated[tuple[float, float], AfterValidator(_in_order)]
"""From 0 on; ``Annotated[Range, within(LOW, HIGH)]`` gives it its bounds."""


PositiveRange = Annotated[Range, AfterValidator(_above_zero)]
"""Above 0."""


_Steps = Annotated[int, Field(gt=0, le=GREATEST_COUNT)]
StepRange = Annotated[tuple[_Steps, _Steps], AfterValidator(_in_order)]
"""Least and greatest number of motor actions."""


def within(low: float, high: float) -> AfterValidator:
    """Return bounds that both numbers of a range must keep, for ``Annotated``."""

    def check(value: tuple[float, float]) -> tuple[float, float]:
        if not low <= value[0] <= value[1] <= high:
            raise ValueError(f"both numbers are {low:g} to {high:g}; found {list(value)}")
        return value

    return AfterValidator(check)


def _expanded(value: Any) -> Any:
    """Return a path without ``~`` and variables, from the root, or say why there is none."""
    if not isinstance(value, (str, Path)):
        return value
    if not str(value).strip():
        raise ValueError(f"found {str(value)!r}: a path must name a file or folder")
    try:
        return Path(os.path.expandvars(value)).expanduser().resolve()
    except (OSError, RuntimeError, ValueError) as error:  # no such user, links in a circle, NUL
        raise ValueError(f"found {str(value)!r}, which is no path: {error}") from None


LocalPath = Annotated[Path, BeforeValidator(_expanded)]
"""A file or folder of this machine, held as a path from the root: ``~`` and variables are expanded,
and what is relative is so to the folder that prime was started in."""
