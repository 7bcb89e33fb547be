"""Arguments and options that several commands have."""

from pathlib import Path
from typing import Annotated

import typer

ExperimentArgument = Annotated[
    Path, typer.Argument(metavar="EXPERIMENT.yaml", help="The experiment.")
]
SetOption = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Change a key, such as seed=3. Repeatable."),
]
OutOption = Annotated[
    Path, typer.Option("--out", help="Folder in which the experiment's own folder lies.")
]
UntilOption = Annotated[
    str | None, typer.Option("--until", metavar="STAGE", help="The last stage to run.")
]
RUNS = Path("runs")
OWN_COMMANDS = ("run", "show", "validate", "parse", "compare", "plugins")
"""Prime's own commands, whose names no plugin can take."""
