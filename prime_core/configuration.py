"""The base of all settings: plain data, frozen, unknown keys forbidden."""

import difflib
from abc import ABC
from typing import Annotated, Any

from pydantic import AfterValidator, BaseModel, ConfigDict, PositiveInt, model_validator


class Config(BaseModel, ABC):
    """Settings: plain data, frozen, unknown keys forbidden."""

    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True)

    @model_validator(mode="before")
    @classmethod
    def _keys_are_known(cls, data: Any) -> Any:
        # Pydantic forbids unknown keys too, but cannot say which key was meant.
        if isinstance(data, dict):
            for key in data:
                if key not in cls.model_fields:
                    raise ValueError(unknown_key(str(key), list(cls.model_fields)))
        return data


def unknown_key(key: str, known: list[str]) -> str:
    """Return the text for a key that is not there."""
    near = difflib.get_close_matches(key, known, n=1, cutoff=0.4)
    guess = f"did you mean {near[0]!r}? " if near else ""
    return f"unknown key {key!r}: {guess}There are: {', '.join(known) or 'none'}"


ConfigDump = dict[str, Any]
"""Settings as plain data, with their ``type``; what stages are identified by."""


def _in_order[Number: float](value: tuple[Number, Number]) -> tuple[Number, Number]:
    if not 0 <= value[0] <= value[1]:
        raise ValueError(f"a range is two numbers, 0 <= low <= high; found {list(value)}")
    return value


def _above_zero(value: tuple[float, float]) -> tuple[float, float]:
    if value[0] <= 0:
        raise ValueError(f"both numbers are above 0; found {list(value)}")
    return value


Range = Annotated[tuple[float, float], AfterValidator(_in_order)]
"""From 0 on."""


PositiveRange = Annotated[Range, AfterValidator(_above_zero)]
"""Above 0."""


StepRange = Annotated[tuple[PositiveInt, PositiveInt], AfterValidator(_in_order)]
"""Least and greatest number of motor actions."""
