"""Puts the results of several experiments side by side."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from prime_core.errors import PrimeError
from prime_core.experiments.results.checksum import CHECKSUM, is_whole
from prime_core.experiments.results.figures import figures_of

NOTHING = "-"


def read_results(path: Path) -> dict[str, Any]:
    """Read a results file, as ``prime run`` leaves it or with a part of its keys.

    Args:
        path: The file, or the folder of a run.

    Raises:
        PrimeError: If it is not a results file.
    """
    file = path / "results.json" if path.is_dir() else path
    try:
        found = json.loads(file.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise PrimeError(f"{file}: there is no such file: prime run leaves one") from None
    except (OSError, ValueError, RecursionError) as error:
        raise PrimeError(f"{file}: cannot be read as JSON: {error}") from None
    if isinstance(found, dict) and not is_whole(found):
        raise PrimeError(
            f"{file}: is damaged, or was edited: 'prime run' writes it anew. If you edited it, "
            f"remove the key {CHECKSUM!r}"
        )
    if not isinstance(found, dict) or not {"name", "results"} <= set(found):
        raise PrimeError(f"{file}: a results file has the keys 'name' and 'results'")
    if not isinstance(found["name"], str):
        raise PrimeError(f"{file}: 'name' is {found['name']!r}; it must be a text")
    try:
        figures_of(found)
    except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError) as error:
        raise PrimeError(f"{file}: what it holds is not what prime run leaves: {error!r}") from None
    return found


def whole_results(path: Path) -> dict[str, Any]:
    """Return what `read_results` does, or nothing if the file is damaged or there is none."""
    try:
        return read_results(path)
    except PrimeError:
        return {}


def comparison_rows(files: Sequence[dict[str, Any]]) -> list[list[str]]:
    """Return a table: a heading, then a row for each figure that any of the files has.

    Args:
        files: What `read_results` returned.

    Returns:
        Rows of what it is and one cell for each file.
    """
    columns = [figures_of(item) for item in files]
    names = list(dict.fromkeys(name for column in columns for name in column))
    rows = [[name, *(column.get(name, NOTHING) for column in columns)] for name in names]
    return [["what", *(str(item["name"]) for item in files)], *rows]


def markdown(rows: Sequence[Sequence[str]]) -> str:
    """Return a table in Markdown; the first row is its heading."""
    lines = [f"| {' | '.join(row)} |" for row in rows]
    return "\n".join([lines[0], "|---" * len(rows[0]) + "|", *lines[1:]])
