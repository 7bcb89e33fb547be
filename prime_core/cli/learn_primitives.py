"""``prime learn-primitives``."""

from pathlib import Path
from typing import Annotated

import typer

from prime_core.cli.options import SetOption, expanded
from prime_core.cli.output import console


def learn_primitives(
    dataset: Annotated[
        Path,
        typer.Argument(
            help="A LeRobot data set with prime's segments, such as the folder 'dataset' of a run.",
            callback=expanded,
        ),
    ],
    out: Annotated[
        Path,
        typer.Option(
            "--out", help="Where to write, a folder for each primitive.", callback=expanded
        ),
    ] = Path("primitives"),
    primitive: Annotated[
        list[str] | None,
        typer.Option("--primitive", help="Which segments to learn; all if not given. Repeatable."),
    ] = None,
    set_: SetOption = None,
    seed: Annotated[int, typer.Option("--seed", min=0, help="Of the trainings.")] = 0,
) -> None:
    """Train primitives on the segments of a parsed data set."""
    from prime_core.experiments import learn_primitives as learning
    from prime_core.experiments.progress_bar import training_bar

    screen = console()
    with training_bar(screen) as bar:
        learned = learning.learn_primitives(dataset, out, primitive or (), set_ or (), seed, bar)
    screen.print("To use them, name them in an experiment:\n\nprimitives:", highlight=False)
    for item in learned:
        pairs = ", ".join(f"{key}: {value}" for key, value in item.settings.items())
        screen.print(
            f"  - {{{pairs}}}  # {item.segments} segments",
            highlight=False,
            markup=False,
            soft_wrap=True,
        )
