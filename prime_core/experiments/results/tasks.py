"""Groups results files by their task: what a figure shows side by side."""

import json
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from prime_core.errors import PrimeError

ResultsFile = dict[str, Any]
"""What `comparison.read_results` returned."""


@dataclass
class Task:
    """The results files of one task.

    Attributes:
        files: By where they lie.
        marks: What other files of the task have in common with one of these.
    """

    files: dict[Path, ResultsFile] = field(default_factory=dict)
    marks: set[str] = field(default_factory=set)

    @property
    def title(self) -> str:
        """The shortest name of a run, or of a file of published values where there is no run."""
        own = [file["name"] for file in self.files.values() if not published_by(file)]
        return str(min(own or (file["name"] for file in self.files.values()), key=len))

    def method(self, file: ResultsFile, policy: str, variant: str = "") -> str:
        """Return what a policy is called in a figure.

        Args:
            file: Whose it is.
            policy: Its name.
            variant: The variant that it is of, or nothing.

        Returns:
            The policy, and in brackets in what it differs from the one of the task's first run:
            what the run's name has besides the task's, and the variant.
        """
        run = "" if published_by(file) else _besides(file["name"], self.title)
        differs = ", ".join(part for part in (run, variant) if part)
        return f"{policy} ({differs})" if differs else policy


def published_by(file: ResultsFile) -> str:
    """Return who published the values of a file, or nothing where prime measured them."""
    return str(file.get("published", ""))


def publishers(files: Iterable[ResultsFile]) -> str:
    """Return who published values, in one line; nothing where nobody did."""
    return ", ".join(dict.fromkeys(name for name in map(published_by, files) if name))


def tasks_of(paths: Sequence[Path], files: Sequence[ResultsFile]) -> list[Task]:
    """Group files by their task: those with the same environment, or name, or name of a task.

    Args:
        paths: Where each lies.
        files: What each holds.

    Raises:
        PrimeError: If two of one task have the same name, so that no figure tells them apart.
    """
    tasks: list[Task] = []
    for path, file in zip(paths, files, strict=True):
        task = Task(marks=_marks(file))
        # One file may tell that two others are of one task.
        for other in [each for each in tasks if each.marks & task.marks]:
            task = Task({**task.files, **other.files}, task.marks | other.marks)
            tasks.remove(other)
        _check_name(path, file, task)
        task.files[path] = file
        tasks.append(task)
    return sorted(tasks, key=lambda task: min(map([*paths].index, task.files)))


def _check_name(path: Path, file: ResultsFile, task: Task) -> None:
    for other, there in task.files.items():
        if path.resolve() == other.resolve():
            raise PrimeError(f"{path}: is named twice")
        if there["name"] == file["name"]:
            raise PrimeError(
                f"{path}: its name is {file['name']!r}, as that of {other}: a figure tells runs "
                "of one task apart by their names. Leave one of them out, or run it with "
                "--set name=ANOTHER"
            )


def _marks(file: ResultsFile) -> set[str]:
    # Files of earlier versions have no environment.
    marks = {f"name {file['name']}", f"name {file.get('task', file['name'])}"}
    if "environment" in file:
        marks.add(json.dumps(file["environment"], sort_keys=True))
    return marks


def _besides(name: str, title: str) -> str:
    return "" if name == title else name.removeprefix(f"{title}-")
