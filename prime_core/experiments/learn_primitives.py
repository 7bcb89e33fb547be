"""Trains primitives on a parsed data set, outside of an experiment."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from prime_core.configuration import ConfigDump
from prime_core.contracts.primitive import LearnedPrimitiveConfig, PrimitiveTraining
from prime_core.contracts.training import Progress
from prime_core.errors import ConfigurationError
from prime_core.experiments.reading import apply_setting
from prime_core.learning.primitive_examples import primitive_examples, segment_counts
from prime_core.registry.fields import dump_choice, read_settings
from prime_core.registry.loading import load_plugins


@dataclass(frozen=True)
class Learned:
    """A primitive that was trained.

    Attributes:
        type: What settings name it by.
        segments: How many it was trained on.
        folder: Where it is.
    """

    type: str
    segments: int
    folder: Path


def learn_primitives(
    dataset: Path,
    out: Path,
    names: Sequence[str],
    settings: Sequence[str],
    seed: int,
    progress: Callable[[str], Progress],
) -> list[Learned]:
    """Train primitives, each in a folder of its name; what is trained already is not trained again.

    Args:
        dataset: A LeRobot data set with prime's segments.
        out: Folder of the folders.
        names: Of the segments to learn; all that there are if empty.
        settings: Changes to the primitives' settings, such as ``policy.learning_rate=1e-3``.
        seed: Of the trainings.
        progress: Given a name, returns what is told how far its training is.

    Raises:
        PrimeError: If the data set is broken, has no such segments, or a setting is wrong.
    """
    counts = segment_counts(dataset)
    missing = [name for name in names if name not in counts]
    if missing:
        found = ", ".join(f"{name} ({count})" for name, count in counts.items()) or "none"
        raise ConfigurationError(f"--primitive {missing[0]}: {dataset} has the segments {found}")
    configs = {name: _settings_for(name, dataset, settings) for name in names or counts}
    learned = []
    for name, config in configs.items():
        folder = out / name
        training = PrimitiveTraining(folder=folder, seed=seed, progress=progress(name))
        config.fit(primitive_examples(dataset, name), training)
        learned.append(Learned(str(dump_choice(config)["type"]), counts[name], folder))
    return learned


def _settings_for(name: str, dataset: Path, changes: Sequence[str]) -> LearnedPrimitiveConfig:
    """Return settings of the first registered type that learns segments of a name."""
    for entry in load_plugins().registry.registrations("primitive"):
        if issubclass(entry.config_class, LearnedPrimitiveConfig):
            config = entry.config_class.for_segments(name, dataset)
            if config is not None:
                return _changed(config, changes)
    raise ConfigurationError(
        f"no installed pack learns primitives such as {name!r}: 'pip install "
        "prime-primitives-learned' adds one that does"
    )


def _changed(config: LearnedPrimitiveConfig, changes: Sequence[str]) -> LearnedPrimitiveConfig:
    data: ConfigDump | dict[str, Any] = dump_choice(config)
    for change in changes:
        apply_setting(data, change)
    try:
        return read_settings(LearnedPrimitiveConfig, data)
    except ValueError as error:
        raise ConfigurationError(f"--set {' '.join(changes)}: {error}") from error
