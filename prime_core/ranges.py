"""Ranges in settings: two numbers, of which the first is not the greater."""

from typing import Annotated

from pydantic import AfterValidator, PositiveInt


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
