"""What becomes of stages that other code made: the user says whether they are kept."""

import sys
from enum import Enum
from pathlib import Path

from rich.console import Console

from prime_core.experiments.experiment import Experiment
from prime_core.experiments.settings import ExperimentConfig

_SHOWN = 4
"""Names of modules that are shown of each stage."""


class OtherCode(Enum):
    """What to do with stages that other code made than is installed now."""

    ASK = "ask"
    KEEP = "keep"
    REMAKE = "remake"


def other_code_in(experiment: Experiment) -> dict[str, list[str]]:
    """Return the stages that other code made, with the modules that differ."""
    found = {name: stage.other_code() for name, stage in experiment.stages.items()}
    return {name: modules for name, modules in found.items() if modules}


def describe(modules: list[str]) -> str:
    """Return names of modules in a line."""
    more = f" and {len(modules) - _SHOWN} more" if len(modules) > _SHOWN else ""
    return ", ".join(modules[:_SHOWN]) + more


def open_experiment(
    config: ExperimentConfig, folder: Path, console: Console, word: OtherCode
) -> Experiment:
    """Return an experiment whose stages the code of now may go on with.

    What other code made is never removed: when that code is there again, so are its results.

    Args:
        config: The experiment.
        folder: Of its run.
        console: Where the user is told and, if it is a terminal, asked.
        word: What the user said. Who cannot be asked has stages made anew.
    """
    experiment = Experiment(config, folder)
    stages = experiment.stages
    doubtful = {
        name: modules
        for name, modules in other_code_in(experiment).items()
        if word is OtherCode.REMAKE or not stages[name].is_kept
    }
    if not doubtful:
        return experiment
    for name, modules in doubtful.items():
        console.print(
            f"[yellow]![/] {name} was made by other code: {describe(modules)}",
            highlight=False,
            soft_wrap=True,
        )
    if word is OtherCode.ASK:
        word = _asked(console)
    if word is OtherCode.KEEP:
        for name in doubtful:
            stages[name].keep()
        console.print("  They are kept, and marked as such.", highlight=False)
        return experiment
    console.print(
        "  They and what depends on them are made anew. What was made is kept beside it; to go on "
        "with it, say --keep.",
        highlight=False,
        soft_wrap=True,
    )
    return Experiment(config, folder, remake=True)


def _asked(console: Console) -> OtherCode:
    if not (console.is_terminal and sys.stdin.isatty()):
        return OtherCode.REMAKE
    try:
        answer = console.input("  Make them anew? \\[Y/n] ")
    except EOFError:
        return OtherCode.REMAKE
    return OtherCode.KEEP if answer.strip().lower().startswith("n") else OtherCode.REMAKE
