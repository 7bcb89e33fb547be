"""What all stages share: caching and fanning out through exca, progress, timing, clear errors.

A stage's fields are exactly what it depends on, other stages included: exca derives its cache
folder from them. Settings are held as plain data with their defaults written out, so that a
default that changes in a plugin counts as a change.

A stage is a list of items (shards, demonstrations, seeds, trials). Finished items are kept; a
kill loses those in hand. Results are mappings of arrays and plain values, which exca keeps as
raw arrays and JSON: nothing is unpickled to read them.
"""

import os
import resource
import time
from abc import abstractmethod
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any, ClassVar

import exca
from pydantic import BaseModel, ConfigDict

from prime_core.errors import PrimeError

Result = dict[str, Any]
"""What an item gives: arrays, numbers, text, and lists and mappings of them."""


DEVICE_IS_NO_IDENTITY = ("device",)
"""Value of exca's ``_exclude_from_cls_uid``: a stage is the same wherever its networks compute."""

TIMING = "timing"
"""Key of an item's seconds and peak memory, beside what it gives."""


PARENT_VARIABLE = "PRIME_PARENT_PROCESS"
"""Holds the process that workers work for: they stop when it is gone."""


class Stage(BaseModel):
    """One step of an experiment."""

    model_config = ConfigDict(extra="forbid")

    infra: exca.MapInfra = exca.MapInfra()

    title: ClassVar[str]
    """What the stage does, for people."""
    unit: ClassVar[str] = "items"
    """What its progress counts."""
    optional: ClassVar[bool] = False
    """Whether an experiment goes on, with a hint, where the stage cannot be done."""

    @abstractmethod
    def items(self) -> list[str]:
        """Return the names of the stage's items, in order."""

    @abstractmethod
    def process(self, items: Sequence[str]) -> Iterator[Result]:
        """Do items, one after another, and yield one result for each."""

    @infra.apply(item_uid=str)
    def compute(self, items: Sequence[str]) -> Iterator[Result]:
        """Do items that are not cached and return the results of all of them."""
        self.error_file.unlink(missing_ok=True)
        results = self.process(items)
        for _ in items:
            _stop_without_parent()
            start = time.perf_counter()
            try:
                result = next(results)
            except PrimeError as error:
                # The process that asked only sees that a worker failed.
                self.error_file.write_text(str(error), encoding="utf-8")
                raise
            seconds = time.perf_counter() - start
            peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
            yield {**result, TIMING: {"seconds": seconds, "peak_bytes": peak}}

    def results(self) -> list[Result]:
        """Return the results of all items, in order; what is missing is done first."""
        return list(self.compute(self.items()))

    def missing(self) -> list[str]:
        """Return the items that are not done."""
        done = set(self.infra.cache_dict.keys())
        return [item for item in self.items() if item not in done]

    @property
    def folder(self) -> Path:
        """Where the stage keeps what it makes."""
        folder = self.infra.uid_folder(create=True)
        if folder is None:
            raise RuntimeError("a stage needs a cache folder")
        return folder

    @property
    def error_file(self) -> Path:
        """Where a worker leaves the text of an error that the user can mend."""
        return self.folder / "error.txt"

    def progress_writer(self, item: str) -> Callable[[int, int], None]:
        """Return a function that tells how far an item is."""
        file = self.folder / f"progress-{item}.txt"

        def write(done: int, total: int) -> None:
            _stop_without_parent()
            file.write_text(f"{done} {total}")

        return write

    def fraction_done(self) -> float:
        """Return how many items are done, parts of running ones included."""
        missing = set(self.missing())
        done = float(len(self.items()) - len(missing))
        for item in missing:
            try:
                numbers = (self.folder / f"progress-{item}.txt").read_text().split()
            except OSError:
                continue
            if len(numbers) == 2:  # else it is just being written
                done += int(numbers[0]) / max(int(numbers[1]), 1)
        return done


def _stop_without_parent() -> None:
    """End a worker whose experiment was killed, so that a new run finds the cores free."""
    parent = os.environ.get(PARENT_VARIABLE)
    if parent is None or os.getpid() == int(parent):
        return
    if not _is_running(int(parent)):
        raise SystemExit(1)


def _is_running(process: int) -> bool:
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    # A killed process that nobody has asked after yet still has its number.
    status = Path(f"/proc/{process}/stat")
    return not status.exists() or status.read_text().rpartition(")")[2].split()[0] != "Z"
