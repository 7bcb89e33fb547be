"""Arguments and options that several commands have."""

from pathlib import Path
from typing import Annotated, Any

import typer


def expanded(value: Any) -> Any:
    """Return a path, or each of several, without ``~``, which shells leave in ``--out=~/runs``."""
    if isinstance(value, (list, tuple)):
        return [expanded(item) for item in value]
    try:
        return value.expanduser() if isinstance(value, Path) else value
    except RuntimeError as error:
        raise typer.BadParameter(f"found '{value}', which is no path: {error}") from None


ExperimentArgument = Annotated[
    Path,
    typer.Argument(metavar="EXPERIMENT.yaml", help="The experiment.", callback=expanded),
]
SetOption = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Change a key, such as seed=3. Repeatable."),
]
OutOption = Annotated[
    Path,
    typer.Option(
        "--out", help="Folder in which the experiment's own folder lies.", callback=expanded
    ),
]
UntilOption = Annotated[
    str | None, typer.Option("--until", metavar="STAGE", help="The last stage to run.")
]
RUNS = Path("runs")
OWN_COMMANDS = (
    "run",
    "show",
    "validate",
    "parse",
    "annotate",
    "convert",
    "learn-primitives",
    "export",
    "export-policy",
    "compare",
    "plugins",
)
"""Prime's own commands, whose names no plugin can take."""
