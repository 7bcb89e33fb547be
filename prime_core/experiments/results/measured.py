"""The success rates in results files, as a figure shows them."""

from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import Any

from prime_core.errors import PrimeError
from prime_core.experiments.results.tasks import ResultsFile, Task, published_by


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
    """Return what policies of a task reached, those of variants where they differ, too."""
    return [
        _measured(path, file, variant, name, task.method(file, name, variant), 0)
        for path, file in task.files.items()
        for variant, results in _all_results(file)
        for name in _evaluated(results)
    ]


def points_of(task: Task, against: Against) -> list[Measured]:
    """Return what policies of a task reached with so many demonstrations, or the like.

    Variants that change something else are left out: a figure could not tell them apart.

    Raises:
        PrimeError: If a number is none, or two of one method have the same.
    """
    found: dict[tuple[str, bool, int], Measured] = {}
    for path, file in task.files.items():
        for variant, results in _all_results(file):
            number = results.get(against.stage, {}).get(against)
            if number is None:
                continue
            if type(number) is not int or number < 1:
                raise PrimeError(
                    f"{_where(path, variant)}: found {number!r} {against}; it must be 1 or more"
                )
            for name in _evaluated(results):
                one = _measured(path, file, variant, name, task.method(file, name), number)
                key = one.method, one.published, one.number
                if key in found:
                    raise PrimeError(
                        f"{one.where} and {found[key].where} both have {name!r} with {number:,} "
                        f"{against}: a figure cannot tell them apart"
                    )
                found[key] = one
    return sorted(found.values(), key=lambda one: one.number)


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
