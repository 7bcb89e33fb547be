"""The kinds of inputs: which file is changed and how, what reads it, and what must come of it."""

import json
import random
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from changes import BLIND, change_json, change_yaml
from file_changes import change_index, change_parquet, change_safetensors
from good_inputs import LAST, RUN
from good_results import same
from hdf5_changes import change_hdf5

from prime_core.experiments.results.checksum import with_checksum

Check = Callable[[Path, Path], str | None]
"""Returns what is wrong with what a command left, of its folder and that of good inputs."""

Change = Callable[[Path, Path, random.Random], str]
"""Changes a file, given the folder of good inputs too, and returns in what way."""


@dataclass(frozen=True)
class Input:
    """One changed file, and the command that reads it.

    Attributes:
        path: The file.
        how: In what way it was changed.
        arguments: Of the command.
        names: One of these stands in what is said when the command fails.
        check: What must hold when it does not.
    """

    path: Path
    how: str
    arguments: list[str]
    names: tuple[str, ...]
    check: Check | None


@dataclass(frozen=True)
class Kind:
    """A kind of inputs.

    Attributes:
        name: For people.
        weight: How many of 1,000 are of this kind.
        files: Patterns of files, in the folder of good inputs.
        blind: Share of changes that know nothing of the format.
        change: Those that do.
        commands: One of them is run.
        check: What must hold when it succeeds; for ``run`` and ``parse`` only.
        folders: Whether an error may name a folder that the file lies in: stages, data sets.
    """

    name: str
    weight: int
    files: tuple[str, ...]
    blind: float
    change: Change | None
    commands: Sequence[Sequence[str]]
    check: Check | None = None
    folders: bool = False

    def make(self, sandbox: Path, base: Path, draw: random.Random) -> Input:
        """Change a file in a copy of the good inputs."""
        found = sorted({p for pattern in self.files for p in sandbox.glob(pattern) if p.is_file()})
        path = draw.choice(found)
        if self.change is None or draw.random() < self.blind:
            change = draw.choice(BLIND)
            path.write_bytes(change(path.read_bytes(), draw))
            how = change.__name__
        else:
            how = self.change(path, base, draw)
        command = list(draw.choice(self.commands))
        names = [str(path), str(path.relative_to(sandbox))]
        if self.folders:
            inside = [p for p in path.parents if p.is_relative_to(sandbox) and p != sandbox]
            names += [f"{folder}" for folder in inside if folder.name not in ("out", "given")]
            names += [str(folder.relative_to(sandbox)) for folder in inside if len(inside) > 1]
        check = self.check if command[0] in ("run", "parse") else None
        return Input(path, how, command, tuple(names), check)


def _text(change: Callable[[bytes, random.Random], bytes]) -> Change:
    def change_file(path: Path, base: Path, draw: random.Random) -> str:
        path.write_bytes(change(path.read_bytes(), draw))
        return change.__name__

    return change_file


def _results(path: Path, base: Path, draw: random.Random) -> str:
    """Change results, sometimes as somebody does who knows how the checksum is made."""
    how = _text(change_json)(path, base, draw)
    if draw.random() < 0.3:
        try:
            found = json.loads(path.read_bytes())
            if isinstance(found, dict):
                path.write_text(json.dumps(with_checksum(found)))
                return f"{how}, checksum made anew"
        except (ValueError, RecursionError):
            pass
    return how


_RUN = ("run", "given/lift.yaml", "--out", "out", "--until", LAST)
_SHOW = ("show", "given/lift.yaml", "--out", "out")
_PARSE = ("parse", "given/dataset", "--run", f"out/{RUN}", "--out", "out/parsed")


def _import(name: str, source: str) -> tuple[Sequence[str], ...]:
    """Commands that read demonstrations; parsing also draws, which takes long."""
    run = ("run", f"given/{name}.yaml", "--out", "out", "--until", "demonstrations")
    return (run, run, run, ("parse", f"given/{source}", *_PARSE[2:]))


_STAGES = f"out/{RUN}/stages"
_LEROBOT = _import("from_lerobot", "dataset")

KINDS = [
    Kind(
        "experiment YAML",
        230,
        ("given/lift.yaml",),
        0.3,
        _text(change_yaml),
        [("validate", "given/lift.yaml"), _SHOW],
    ),
    Kind(
        "experiment.yaml of a run",
        60,
        (f"out/{RUN}/experiment.yaml",),
        0.5,
        _text(change_yaml),
        [_RUN, _SHOW, _SHOW, _PARSE],
        same,
        True,
    ),
    Kind(
        "results.json",
        150,
        (f"out/{RUN}/results.json", "given/results.json"),
        0.3,
        _results,
        [
            ("compare", f"out/{RUN}", "given/results.json"),
            ("compare", "given/results.json", f"out/{RUN}/results.json", "--markdown"),
        ],
        None,
        True,
    ),
    Kind(
        "results.json beside a run",
        20,
        (f"out/{RUN}/results.json", f"out/{RUN}/trials-*.json"),
        0.5,
        _text(change_json),
        [_RUN],
        same,
        True,
    ),
    Kind(
        "info.json",
        110,
        ("given/dataset/meta/info.json",),
        0.25,
        _text(change_json),
        _LEROBOT,
        None,
        True,
    ),
    Kind(
        "other JSON of a data set",
        20,
        ("given/dataset/meta/prime.json", "given/dataset/meta/stats.json"),
        0.3,
        _text(change_json),
        _LEROBOT,
        None,
        True,
    ),
    Kind(
        "parquet",
        140,
        (
            "given/dataset/data/*/*.parquet",
            "given/dataset/meta/episodes/*/*.parquet",
            "given/dataset/meta/*.parquet",
        ),
        0.4,
        change_parquet,
        _LEROBOT,
        None,
        True,
    ),
    Kind(
        "HDF5 of robosuite",
        70,
        ("given/robosuite.hdf5",),
        0.4,
        change_hdf5,
        _import("from_robosuite", "robosuite.hdf5"),
    ),
    Kind(
        "HDF5 of robomimic",
        70,
        ("given/robomimic.hdf5",),
        0.4,
        change_hdf5,
        _import("from_robomimic", "robomimic.hdf5"),
    ),
    Kind(
        "safetensors",
        40,
        (f"{_STAGES}/**/*.safetensors",),
        0.5,
        change_safetensors,
        [_RUN, _PARSE],
        same,
        True,
    ),
    Kind(
        "index of a stage",
        40,
        (f"{_STAGES}/*/*/*-info.jsonl",),
        0.3,
        change_index,
        [_RUN, _PARSE, _SHOW],
        same,
        True,
    ),
    Kind(
        "arrays and files of a stage",
        30,
        (
            f"{_STAGES}/*/*/data/*",
            f"{_STAGES}/*/*/dataset/**/*",
            f"{_STAGES}/*/*/model/*.yaml",
            f"{_STAGES}/*/*/timelines/*.png",
        ),
        1.0,
        None,
        [_RUN, _PARSE],
        same,
        True,
    ),
    Kind(
        "marks of a stage",
        20,
        (f"{_STAGES}/*/*/code.json",),
        0.3,
        _text(change_json),
        [_RUN, _SHOW, _PARSE],
        same,
        True,
    ),
    Kind(
        "settings of a stage",
        20,
        (f"{_STAGES}/*/*/*.yaml", f"{_STAGES}/*/*/*.txt", f"{_STAGES}/*/*/inflight.db"),
        0.5,
        None,
        [_RUN, _SHOW, _PARSE],
        same,
        True,
    ),
]
