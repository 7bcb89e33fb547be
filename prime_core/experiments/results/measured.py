"""The success rates in results files, as a figure shows them."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import Any

from prime_core.errors import PrimeError
from prime_core.experiments.results.tasks import ResultsFile, Task, published_by

_GREATEST = 10**15
"""Of the numbers that rates are drawn against: axes have no room for any number."""


class Against(StrEnum):
    """What success rates are drawn against."""

    DEMONSTRATIONS = "demonstrations"
    TRANSITIONS = "transitions"

    @property
    def stage(self) -> str:
        """The stage among whose figures the number is, under the name of this."""
        return "collection" if self is Against.TRANSITIONS else "demonstrations"


@dataclass(frozen=True)
class Measured:
    """A success rate of the best checkpoints.

    Attributes:
        method: What it is called in a figure.
        mean: Over the seeds of its trainings.
        deviation: Standard deviation over those seeds; None where there is but one.
        number: What it is drawn against; 0 where it is drawn against nothing.
        where: The file, and the variant in it.
        published: Whether others published it.
    """

    method: str
    mean: float
    deviation: float | None
    number: int
    where: str
    published: bool


def bars_of(task: Task) -> list[Measured]:
    """Return what policies of a task reached, those of variants where they differ, too.

    Raises:
        PrimeError: If a rate is none, or two are called the same.
    """
    found = [
        _measured(path, file, variant, name, task.method(file, name, variant), 0)
        for path, file in task.files.items()
        for variant, results in _all_results(file)
        for name in _evaluated(results)
    ]
    _check_apart(found, "")
    return found


def points_of(task: Task, against: Against) -> list[Measured]:
    """Return what policies of a task reached with so many demonstrations, or the like.

    Variants that change something else are left out: a line could not tell them apart.

    Raises:
        PrimeError: If a rate or a number is none, or two of one method have the same number.
    """
    found = [
        _measured(path, file, variant, name, task.method(file, name), number)
        for path, file in task.files.items()
        for variant, results in _all_results(file)
        if (number := _number(results, against, _where(path, variant))) is not None
        for name in _evaluated(results)
    ]
    _check_apart(found, str(against))
    return sorted(found, key=lambda one: one.number)


def _number(results: dict[str, Any], against: Against, where: str) -> int | None:
    """Return what results are drawn against, or None where they do not say."""
    number = results.get(against.stage, {}).get(against)
    if number is not None and (type(number) is not int or not 1 <= number <= _GREATEST):
        raise PrimeError(f"{where}: found {number!r} {against}; it must be a number from 1 on")
    return number


def _check_apart(rates: Iterable[Measured], against: str) -> None:
    found: dict[tuple[str, bool, int], Measured] = {}
    for rate in rates:
        key = rate.method, rate.published, rate.number
        if key in found:
            number = f" with {rate.number:,} {against}" if against else ""
            raise PrimeError(
                f"{rate.where} and {found[key].where} both have {rate.method!r}{number}: a figure "
                "cannot tell them apart"
            )
        found[key] = rate


def _all_results(file: ResultsFile) -> Iterator[tuple[str, dict[str, Any]]]:
    yield "", file["results"]
    yield from file.get("variants", {}).items()


def _evaluated(results: dict[str, Any]) -> list[str]:
    prefix = "evaluation."
    return [name.removeprefix(prefix) for name in results if name.startswith(prefix)]


def _measured(
    path: Path, file: ResultsFile, variant: str, policy: str, method: str, number: int
) -> Measured:
    results = file["variants"][variant] if variant else file["results"]
    success = results[f"evaluation.{policy}"]["success"]
    mean, deviation = success["mean"], success["standard_deviation"]
    if not (0 <= mean <= 1 and 0 <= deviation <= 1):
        raise PrimeError(
            f"{_where(path, variant)}: the success of {policy!r} is {mean} ± {deviation}: rates "
            "lie between 0 and 1"
        )
    seeds = success.get("seeds")  # published values tell none
    has_one_seed = isinstance(seeds, dict) and len(seeds) == 1
    return Measured(
        method=method,
        mean=mean,
        deviation=None if has_one_seed else deviation,
        number=number,
        where=_where(path, variant),
        published=bool(published_by(file)),
    )


def _where(path: Path, variant: str) -> str:
    return f"{path}, variant {variant!r}" if variant else str(path)
