"""Digests beside what an item gave: damage is noticed where it would be read as data."""

import shutil
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from prime_core.experiments.run_folder.contents import file_digest, result_digest

SEAL = "seal"
"""Key of an item's digests, beside what it gives."""

TIMING = "timing"
"""Key of an item's seconds and peak memory, beside what it gives."""

BESIDE = (SEAL, TIMING)


def sealed(
    item: str, result: Mapping[str, Any], folder: Path, outputs: Iterable[Path]
) -> dict[str, Any]:
    """Return the digests of a result and of files, and whose they are.

    Args:
        item: The item.
        result: What it gives.
        folder: Of the stage.
        outputs: Files, and folders of files, that it left in it.
    """
    files = sorted(file for path in outputs for file in _files(path))
    return {
        "item": item,
        "result": result_digest(result),
        "files": {str(file.relative_to(folder)): file_digest(file) for file in files},
    }


def damage_of(item: str, result: Mapping[str, Any], folder: Path) -> str | None:
    """Return what is no longer as it was when it was sealed, or None.

    Args:
        item: Whose result it should be.
        result: As it was kept.
        folder: Of the stage.
    """
    seal = result.get(SEAL)
    if seal is None:
        return "its digests are missing"
    if seal["item"] != item:
        return f"it is what {seal['item']!r} gave"
    given = {name: value for name, value in result.items() if name not in BESIDE}
    if result_digest(given) != seal["result"]:
        return "its numbers are not those that were written"
    for name, digest in seal["files"].items():
        found = file_digest(folder / name)
        if found != digest:
            return f"{name} is missing" if found == "missing" else f"{name} was changed"
    return None


def remove(outputs: Iterable[Path]) -> None:
    """Remove files, and folders of files."""
    for path in outputs:
        if path.is_dir():
            shutil.rmtree(path)
        else:
            path.unlink(missing_ok=True)


def _files(path: Path) -> list[Path]:
    if path.is_dir():
        return [file for file in path.rglob("*") if file.is_file()]
    return [path] if path.is_file() else []
