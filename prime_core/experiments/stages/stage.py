"""What all stages share: caching and fanning out through exca, progress, timing, clear errors.

A stage's fields are exactly what it depends on, other stages included: exca derives its cache
folder from them. Settings are held as plain data with their defaults written out, so that a
default that changes in a plugin counts as a change.

A stage is a list of items (shards, demonstrations, seeds, trials). Finished items are kept; a
kill loses those in hand. Results are mappings of arrays and plain values, which exca keeps as
raw arrays and JSON: nothing is unpickled to read them.
"""

import contextlib
import resource
import time
from abc import abstractmethod
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any, ClassVar

from pydantic import BaseModel, ConfigDict, PrivateAttr

from prime_core.errors import DamagedError, PrimeError
from prime_core.experiments.run_folder.cache import StageInfra, kept_items
from prime_core.experiments.run_folder.code import Code, code_of
from prime_core.experiments.run_folder.code_mark import (
    CodeMark,
    keep_for,
    new_mark,
    read_mark,
    write_mark,
)
from prime_core.experiments.run_folder.contents import content_of
from prime_core.experiments.run_folder.parent import stop_without_parent
from prime_core.experiments.run_folder.seal import SEAL, TIMING, damage_of, remove, sealed
from prime_core.experiments.run_folder.settings_of import makers, settings_in

_UNREADABLE = (
    ArithmeticError,
    AttributeError,
    LookupError,
    MemoryError,
    OSError,
    RuntimeError,
    TypeError,
    ValueError,
)
"""What exca raises where its files are not what they were."""

Result = dict[str, Any]
"""What an item gives: arrays, numbers, text, and lists and mappings of them."""


DEVICE_IS_NO_IDENTITY = ("device",)
"""Value of exca's ``_exclude_from_cls_uid``: a stage is the same wherever its networks compute."""


class Stage(BaseModel):
    """One step of an experiment."""

    model_config = ConfigDict(extra="forbid")

    infra: StageInfra = StageInfra()
    content: str = ""
    """Digest of the files that the stage's settings name; empty if they name none."""
    code: str = ""
    """Digest of the code that makes the stage; empty for the code that made it first."""
    _sound: set[str] = PrivateAttr(default_factory=set)

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

    def outputs(self, item: str) -> list[Path]:
        """Return the files, and folders of files, that an item leaves beside its result."""
        return []

    @infra.apply(item_uid=str)
    def compute(self, items: Sequence[str]) -> Iterator[Result]:
        """Do items that are not cached and return the results of all of them."""
        results = self._begun(items)
        for item in items:
            stop_without_parent()
            start = time.perf_counter()
            try:
                result = next(results)
                self._check_content()
            except PrimeError as error:
                # The process that asked only sees that a worker failed.
                with contextlib.suppress(OSError):
                    self.error_file.write_text(str(error), encoding="utf-8")
                raise
            seconds = time.perf_counter() - start
            peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
            yield {
                **result,
                TIMING: {"seconds": seconds, "peak_bytes": peak},
                SEAL: sealed(item, result, self.folder, self.outputs(item)),
            }

    def _begun(self, items: Sequence[str]) -> Iterator[Result]:
        self._check_code()
        yield from self.process(items)

    def _check_content(self) -> None:
        """Make sure that files which the settings name are still what the stage is made of."""
        if self.content and content_of(settings_in(dict(self))) != self.content:
            raise PrimeError(
                f"files of stage {self.title!r} were changed while it read them: run again, when "
                "they are as they should be"
            )

    def results(self, items: Sequence[str] | None = None) -> list[Result]:
        """Return results in order; what is missing is done first.

        Args:
            items: Whose; None for all.

        Raises:
            DamagedError: If one is not what it was when it was made.
        """
        items = self.items() if items is None else items
        self.compute(items)
        found = []
        for item in items:
            result, damage = self._load(item)
            if damage:
                raise DamagedError(
                    f"{self.folder}: {item!r} of stage {self.title!r} is damaged: {damage}. "
                    "'prime run' makes it anew; or remove the folder"
                )
            found.append(result)
        return found

    def _load(self, item: str) -> tuple[Result, str | None]:
        """Return what is kept of an item, and what is wrong with it or None."""
        try:
            (result,) = self.compute([item])
            damage = None if item in self._sound else damage_of(item, result, self.folder)
        except _UNREADABLE as error:
            text = str(error).partition("\n")[0]
            return {}, f"it cannot be read ({type(error).__name__}: {text})"
        if damage is None:
            self._sound.add(item)
        return result, damage

    def drop_damaged(self) -> list[str]:
        """Forget items that are not what they were when they were made, and return them."""
        kept = kept_items(self.folder)
        damaged = [item for item in self.items() if item in kept and self._load(item)[1]]
        if damaged:
            self.infra.forget(damaged)
            remove(path for item in damaged for path in self.outputs(item))
        return damaged

    def missing(self) -> list[str]:
        """Return the items that are not done."""
        done = kept_items(self.folder)
        return [item for item in self.items() if item not in done]

    @property
    def is_begun(self) -> bool:
        """Whether anything is there that the stage made, if only a part of an item."""
        outputs = (path for item in self.items() for path in self.outputs(item))
        return bool(kept_items(self.folder)) or any(path.exists() for path in outputs)

    @property
    def folder(self) -> Path:
        """Where the stage keeps what it makes; it is there once something is made."""
        folder = self.infra.uid_folder()
        if folder is None:
            raise RuntimeError("a stage needs a cache folder")
        return folder

    @property
    def error_file(self) -> Path:
        """Where a worker leaves the text of an error that the user can mend."""
        return self.folder / "error.txt"

    @property
    def family(self) -> str:
        """What tells the stage apart from others, but for the code that makes it."""
        depends_on = self.infra.config(uid=True, exclude_defaults=True)
        depends_on.pop("code", None)
        return str(depends_on.to_uid())

    def code_now(self) -> Code:
        """Return the code that makes the stage as it is installed now."""
        return code_of(makers(self))

    def other_code(self) -> list[str]:
        """Return in what the code that made the stage differs from that of now: modules."""
        mark, now = read_mark(self.folder), self.code_now()
        if mark is None or mark.made_by == now or not self.is_begun:
            return []
        return mark.difference(now)

    @property
    def is_kept(self) -> bool:
        """Whether the user chose to keep the stage with the code of now."""
        mark = read_mark(self.folder)
        return mark is not None and mark.is_kept_for(self.code_now())

    def keep(self) -> None:
        """Take the stage as it is, though other code made it."""
        mark = read_mark(self.folder) or new_mark(self.family, self.code, {})
        keep_for(self.folder, mark, self.code_now())

    def begin(self) -> None:
        """Mark the stage as made by the code that runs, unless something is there already.

        Raises:
            PrimeError: If other code began it, and nobody said that this is right.
        """
        mark, now = read_mark(self.folder), self.code_now()
        if mark is not None and mark.fits(now):
            return
        if not self.is_begun:
            write_mark(self.folder, new_mark(self.family, self.code, now))
        elif mark is None:
            self.keep()  # an earlier version of prime began it
        else:
            raise self._begun_otherwise(mark)

    def _check_code(self) -> None:
        """Make sure that this process, which may be a worker, has the code that began the stage."""
        mark = read_mark(self.folder)
        if mark is None:
            self.begin()
        elif not mark.fits(self.code_now()):
            raise self._begun_otherwise(mark)

    def _begun_otherwise(self, mark: CodeMark) -> PrimeError:
        return PrimeError(
            f"stage {self.title!r} was begun by other code than there is now "
            f"({', '.join(mark.difference(self.code_now()))}): run again with --keep to go on with "
            "it, or with --remake to make it anew"
        )

    def progress_writer(self, item: str) -> Callable[[int, int], None]:
        """Return a function that tells how far an item is."""
        file = self.folder / f"progress-{item}.txt"

        def write(done: int, total: int) -> None:
            stop_without_parent()
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
