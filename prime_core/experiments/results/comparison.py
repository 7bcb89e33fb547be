"""Puts the results of several experiments side by side."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from prime_core.errors import PrimeError

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
    except (OSError, ValueError) as error:
        raise PrimeError(f"{file}: cannot be read as JSON: {error}") from None
    if not isinstance(found, dict) or not {"name", "results"} <= set(found):
        raise PrimeError(f"{file}: a results file has the keys 'name' and 'results'")
    try:
        _all_figures(found)
    except (AttributeError, KeyError, TypeError, ValueError) as error:
        raise PrimeError(
            f"{file}: 'results' or 'variants' is not what prime run leaves: {error!r}"
        ) from None
    return found


def comparison_rows(files: Sequence[dict[str, Any]]) -> list[list[str]]:
    """Return a table: a heading, then a row for each figure that any of the files has.

    Args:
        files: What `read_results` returned.

    Returns:
        Rows of what it is and one cell for each file.
    """
    columns = [_all_figures(item) for item in files]
    names = list(dict.fromkeys(name for column in columns for name in column))
    rows = [[name, *(column.get(name, NOTHING) for column in columns)] for name in names]
    return [["what", *(str(item["name"]) for item in files)], *rows]


def markdown(rows: Sequence[Sequence[str]]) -> str:
    """Return a table in Markdown; the first row is its heading."""
    lines = [f"| {' | '.join(row)} |" for row in rows]
    return "\n".join([lines[0], "|---" * len(rows[0]) + "|", *lines[1:]])


def _all_figures(file: dict[str, Any]) -> dict[str, str]:
    """Return the figures of an experiment, then those of its variants, by what they are."""
    found = _figures(file["results"])
    for name, variant in file.get("variants", {}).items():  # older files have none
        found |= {f"{name}: {what}": figure for what, figure in _figures(variant).items()}
    return found


def _figures(results: dict[str, Any]) -> dict[str, str]:
    """Return the figures that papers report, by what they are."""
    found: dict[str, str] = {}
    if "collection" in results:
        found["transitions collected"] = f"{results['collection']['transitions']:,}"
    if "idm" in results:
        found["IDM balanced accuracy"] = f"{results['idm']['balanced_accuracy']:.3f}"
    if "replay" in results:
        found["replay success"] = f"{results['replay']['with_other']['success']:.3f}"
    if "parsing" in results:
        parsing = results["parsing"]
        found["primitives / steps"] = (
            f"{parsing['mean_primitives']:.1f} / {parsing['mean_steps']:.0f}"
        )
    policies = {
        key.removeprefix("evaluation."): values
        for key, values in results.items()
        if key.startswith("evaluation.")
    }
    for name, values in policies.items():
        success = values["success"]
        found[f"{name}: best checkpoints"] = (
            f"{success['mean']:.3f} ± {success['standard_deviation']:.3f}"
        )
        if "fresh" in values:
            low, high = values["fresh"]["interval_95"]
            trials = values["fresh"]["trials"]
            found[f"{name}: last checkpoint"] = (
                f"{values['fresh']['mean']:.3f} [{low:.3f}, {high:.3f}], {trials} trials"
            )
    return found
