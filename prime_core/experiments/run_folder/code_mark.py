"""Marks beside a stage: which code made what lies in its folder."""

import json
import time
from dataclasses import asdict, dataclass, replace
from pathlib import Path

from pydantic import TypeAdapter

from prime_core.errors import DamagedError
from prime_core.experiments.run_folder.code import Code, changes, digest_of
from prime_core.files import new_file

NAME = "code.json"

UNKNOWN = "unknown code"
"""What made a stage that has no mark: an earlier version of prime."""


@dataclass(frozen=True)
class CodeMark:
    """Which code made a stage.

    Attributes:
        stage: What the stage depends on but for the code, as text.
        version: Value of the stage's field ``code``.
        made_by: The code; empty where it is not known.
        kept_for: Digests of other code for which the user kept it.
        begun: When it was begun [s since 1970].
    """

    stage: str
    version: str
    made_by: Code
    kept_for: tuple[str, ...] = ()
    begun: float = 0.0

    def is_kept_for(self, code: Code) -> bool:
        """Whether the user chose to keep it with this code."""
        return digest_of(code) in self.kept_for

    def fits(self, code: Code) -> bool:
        """Whether this code may go on with it."""
        return self.made_by == code or self.is_kept_for(code)

    def difference(self, code: Code) -> list[str]:
        """Return what differs from this code: modules by name."""
        return changes(self.made_by, code) if self.made_by else [UNKNOWN]


_MARK = TypeAdapter(CodeMark)


def new_mark(stage: str, version: str, made_by: Code) -> CodeMark:
    """Return a mark of a stage that begins now."""
    return CodeMark(stage, version, made_by, begun=time.time())


def keep_for(folder: Path, mark: CodeMark, code: Code) -> None:
    """Note that the user keeps a stage with other code than it was made by."""
    write_mark(folder, replace(mark, kept_for=(*mark.kept_for, digest_of(code))))


def write_mark(folder: Path, mark: CodeMark) -> None:
    """Write a mark, in place of one that is there."""
    with new_file(folder / NAME) as aside:
        aside.write_text(json.dumps(asdict(mark), indent=1), encoding="utf-8")


def read_mark(folder: Path) -> CodeMark | None:
    """Read the mark of a stage's folder, or return None if there is none.

    Raises:
        DamagedError: If it cannot be read.
    """
    path = folder / NAME
    try:
        return _MARK.validate_json(path.read_bytes())
    except FileNotFoundError:
        return None
    except ValueError:
        raise DamagedError(
            f"{path} is damaged: remove it, then what lies beside it counts as made by unknown code"
        ) from None


def marks_beside(folder: Path, stage: str) -> list[CodeMark]:
    """Return the marks of a stage that was made by several codes, the newest first.

    Args:
        folder: Of the stage, as any of them made it.
        stage: As in the marks.
    """
    found = [read_mark(path.parent) for path in folder.parent.glob(f"*/{NAME}")]
    mine = [mark for mark in found if mark is not None and mark.stage == stage]
    return sorted(mine, key=lambda mark: mark.begun, reverse=True)
