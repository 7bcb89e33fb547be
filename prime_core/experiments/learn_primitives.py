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
from prime_core.learning.primitive_examples import examples_of, primitive_examples
from prime_core.registry.fields import dump_choice, read_settings
from prime_core.registry.loading import load_plugins


@dataclass(frozen=True)
class Learned:
    """A primitive that was trained.

    Attributes:
        settings: That build it, as plain data, what is as usual left out.
        segments: How many it was trained on.
    """

    settings: ConfigDump
    segments: int


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
    found = primitive_examples(dataset)
    chosen = {name: examples_of(name, found, dataset) for name in names or found}
    configs = {name: _settings_for(name, dataset, settings) for name in chosen}
    learned = []
    for name, config in configs.items():
        folder = out / name
        training = PrimitiveTraining(folder=folder, seed=seed, progress=progress(name))
        config.fit(chosen[name], training)
        built = config.with_trained(folder)
        usual = {"type": dump_choice(config)["type"]}
        usual |= built.model_dump(mode="json", exclude_unset=True)
        learned.append(Learned(usual, len(chosen[name].executions)))
    return learned


def _settings_for(name: str, dataset: Path, changes: Sequence[str]) -> LearnedPrimitiveConfig:
    """Return settings of a registered type that learns segments of a name, its namesake first."""
    found = load_plugins().registry.registrations("primitive")
    for entry in sorted(found, key=lambda entry: entry.name.rpartition("/")[2] != name):
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
