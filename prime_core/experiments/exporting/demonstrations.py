"""Writes the demonstrations of a run in a format of other programs."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from prime_core.contracts.demonstration import Demonstration
from prime_core.contracts.exporter import ExporterConfig
from prime_core.errors import ConfigurationError, DatasetError
from prime_core.experiments.parse_dataset import beside, open_run
from prime_core.experiments.reading import read_choice
from prime_core.experiments.run_folder.place import place_told
from prime_core.experiments.stages.demonstrations import check_left_out
from prime_core.registry.fields import dump_choice

Shown = Callable[[Iterable[Demonstration], int], Iterable[Demonstration]]
"""Gives what it is given, and shows how many of a number have gone by."""


@dataclass(frozen=True)
class Exported:
    """What was written.

    Attributes:
        target: Where.
        demonstrations: How many.
        actions: Motor actions that were done in them.
    """

    target: Path
    demonstrations: int
    actions: int


def read_exporter(name: str, settings: Sequence[str]) -> ExporterConfig:
    """Return the settings of a registered format.

    Args:
        name: That it is registered under, such as ``robomimic``.
        settings: Changes to its settings, such as ``validation_share=0.1``.

    Raises:
        ConfigurationError: If there is no such format or setting.
    """
    return read_choice(ExporterConfig, {"type": name}, settings, f"--to {name}")


def export_run(run: Path, exporter: ExporterConfig, target: Path | None, shown: Shown) -> Exported:
    """Write the demonstrations of a run, those that can be used.

    Args:
        run: The folder of the run. What its demonstrations stage has not made is not made here.
        exporter: Settings of the format.
        target: Where, which must not exist; beside the run if None.
        shown: Shows how far it is.

    Raises:
        PrimeError: If the run has no demonstrations, they cannot be written so, or the target is
            there already.
    """
    experiment = open_run(run)
    stage = experiment.demonstrations
    total, missing = len(stage.items()), len(stage.missing())
    if missing:
        raise ConfigurationError(
            f"{run}: {missing} of its {total} demonstrations are not made yet: prime run ... "
            "--until demonstrations makes them"
        )
    check_left_out(stage.left_out(), total, strict=False)
    name = dump_choice(exporter)["type"].replace("/", "-")
    target = target or beside(run, f"{name}{exporter.suffix}")
    if target.exists():
        raise DatasetError(f"{target}: is there already: choose another place with --out")
    steps: list[int] = []

    def usable() -> Iterator[Demonstration]:
        for _, one in stage.one_by_one():
            steps.append(one.steps)
            yield one

    count = total - len(stage.left_out())
    with place_told(target, keeps=False):
        exporter.export(shown(usable(), count), experiment.config.environment, target)
    return Exported(target, len(steps), sum(steps))
