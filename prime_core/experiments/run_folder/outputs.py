"""What a run leaves for people beside its stages, and whose it is: that of `experiment.yaml`.

Outputs of other settings are set aside under ``earlier/``, which holds folders like that of the
run itself: with an `experiment.yaml` of their own, and the same stages.
"""

import hashlib
import re
import shutil
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from prime_core.errors import DamagedError
from prime_core.files import new_file

RESOLVED = "experiment.yaml"
RESULTS = "results.json"
EARLIER = "earlier"
STAGES = "stages"

_OUTPUTS = (RESULTS, "trials-*.json", "dataset", "timelines", "episode-*.mp4")
_HEADER = "# Written by prime run. Results {}, digest of all lines below {}\n"
_PATTERN = re.compile(_HEADER.format("(?P<identity>[0-9a-f]+)", "(?P<digest>[0-9a-f]+)"))
_UNKNOWN = "# What the experiment was that these results belong to is not known.\n"


@dataclass(frozen=True)
class Owner:
    """Whose the outputs in a folder are.

    Attributes:
        identity: As `Experiment.identity`; None where an earlier version of prime wrote none.
        text: The experiment in YAML.
        damaged: Whether the text is no longer what was written.
    """

    identity: str | None
    text: str
    damaged: bool


def read_owner(folder: Path) -> Owner | None:
    """Return whose the outputs in a folder are, or None where nothing tells."""
    try:
        text = (folder / RESOLVED).read_bytes().decode(errors="replace")
    except FileNotFoundError:
        return None
    header = _PATTERN.match(text)
    if header is None:
        return Owner(None, text, damaged=text.startswith("# Written by prime"))
    body = text[header.end() :]
    return Owner(header["identity"], body, damaged=_digest(body) != header["digest"])


def check_resolved(folder: Path) -> None:
    """Make sure that the `experiment.yaml` of a run is what was written.

    Raises:
        DamagedError: If it is not.
    """
    owner = read_owner(folder)
    if owner is not None and owner.damaged:
        raise DamagedError(
            f"{folder / RESOLVED} is damaged, or was edited: 'prime run' writes it anew"
        )


def is_of_others(folder: Path, text: str, identity: str) -> bool:
    """Whether a folder holds outputs of another experiment.

    Args:
        folder: Of the run.
        text: The experiment in YAML.
        identity: Of the experiment.
    """
    owner = read_owner(folder)
    if not any(_outputs(folder)):
        return False
    if owner is None or owner.identity is not None:
        return owner is None or owner.identity != identity
    return owner.damaged or _settings(owner.text) != _settings(text)


def set_aside(folder: Path) -> Path:
    """Move the outputs in a folder to one under ``earlier/``, and return that.

    May be interrupted, and goes on when it is called again.
    """
    target = _place(folder / EARLIER, read_owner(folder))
    target.mkdir(parents=True, exist_ok=True)
    if not (target / STAGES).is_symlink():
        # Links to what stages made, and all commands, work there as they do here.
        (target / STAGES).symlink_to(Path("..", "..", STAGES))
    for path in _outputs(folder):
        if (target / path.name).is_dir() and not (target / path.name).is_symlink():
            shutil.rmtree(target / path.name)
        path.rename(target / path.name)
    if (folder / RESOLVED).exists():
        (folder / RESOLVED).rename(target / RESOLVED)  # last: from now on the folder is whole
    else:
        (target / RESOLVED).write_text(_UNKNOWN, encoding="utf-8")
    return target


def write_resolved(folder: Path, text: str, identity: str) -> None:
    """Write whose the outputs in a folder are.

    Args:
        folder: Of the run.
        text: The experiment in YAML, all defaults written out.
        identity: Of the experiment.
    """
    header = _HEADER.format(identity, _digest(text))
    with new_file(folder / RESOLVED) as aside:
        aside.write_text(header + text, encoding="utf-8")


def changed_keys(before: str, now: str) -> list[str]:
    """Return the keys, in dots, in which two experiments in YAML differ."""
    return list(_differences(_settings(before), _settings(now)))


def _outputs(folder: Path) -> list[Path]:
    return sorted(path for pattern in _OUTPUTS for path in folder.glob(pattern))


def _place(earlier: Path, owner: Owner | None) -> Path:
    """Return the folder for outputs: a new one, but for those of an experiment that is there."""
    numbers = sorted(int(path.name) for path in earlier.glob("[0-9]*") if path.name.isdigit())
    for number in numbers:
        there = read_owner(earlier / str(number))
        # Without an owner it is one that was not finished.
        if there is None or (owner and owner.identity and owner.identity == there.identity):
            return earlier / str(number)
    return earlier / str(max(numbers, default=0) + 1)


def _digest(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def _settings(text: str) -> Any:
    """Return an experiment as plain data, without where it runs; None if it cannot be read."""
    try:
        data = yaml.safe_load(text)
    except (yaml.YAMLError, ValueError, RecursionError):  # such as dates that are none
        return None
    return {**data, "compute": None} if isinstance(data, dict) else None


def _differences(before: Any, now: Any, key: str = "") -> Iterator[str]:
    if isinstance(before, dict) and isinstance(now, dict):
        for name in dict.fromkeys((*now, *before)):
            inner = f"{key}.{name}" if key else str(name)
            yield from _differences(before.get(name), now.get(name), inner)
    elif before != now:
        yield key
