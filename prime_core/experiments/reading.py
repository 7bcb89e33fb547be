"""Reads experiments from YAML, with changes from the command line."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from prime_core.configuration import Config
from prime_core.errors import ConfigurationError
from prime_core.experiments.settings import ExperimentConfig
from prime_core.experiments.yaml_text import dump_yaml, load_yaml, read_mapping
from prime_core.registry.fields import read_settings

LONGEST = 200
"""Characters of what was found that an error shows."""

_MEANT = {
    "tuple_type": "a list, such as [1, 2]",
    "list_type": "a list, such as [1, 2]",
    "dict_type": "a mapping of keys, such as {key: value}",
    "path_type": "the path of a file or folder",
}
"""What is right, in YAML's words, where pydantic has Python's."""


def read_experiment(path: Path, settings: Sequence[str] = ()) -> ExperimentConfig:
    """Read an experiment from YAML.

    Args:
        path: The file.
        settings: Changes to it, each ``key.in.dots=value``, the value in YAML.

    Raises:
        ConfigurationError: If something is wrong; the text names the file and the key, what was
            found and what would be right.
    """
    data = read_mapping(path)
    for setting in settings:
        apply_setting(data, setting)
    return validate_experiment(data, str(path))


def validate_experiment(data: Mapping[str, Any], source: str) -> ExperimentConfig:
    """Make an experiment from plain data.

    Args:
        data: As read from YAML.
        source: What the error text calls it.

    Raises:
        ConfigurationError: If something is wrong.
    """
    try:
        return ExperimentConfig.model_validate(data)
    except ValidationError as error:
        raise ConfigurationError(explain(error, source)) from None


def read_choice[AnyConfig: Config](
    base: type[AnyConfig], data: dict[str, Any], settings: Sequence[str], told: str
) -> AnyConfig:
    """Return the settings of a registered type that was named outside of an experiment.

    Args:
        base: The contract that it must be of.
        data: Its ``type`` and keys.
        settings: Changes to them; see `read_experiment`.
        told: What named it, for errors.

    Raises:
        ConfigurationError: If there is no such type or key, or a value is wrong.
    """
    for setting in settings:
        apply_setting(data, setting)
    try:
        return read_settings(base, data)
    except ValidationError as error:
        raise ConfigurationError(explain(error, told)) from None
    except ValueError as error:
        raise ConfigurationError(f"{told}: {error}") from None


def explain(error: ValidationError, source: str) -> str:
    """Return one line for each mistake: file, key, what was found and what would be right."""
    lines = []
    for item in error.errors():
        if item["type"] == "too_short" and len(item["input"]) >= item["ctx"]["min_length"]:
            continue  # long enough, but pydantic does not count items that are wrong
        place, found = item["loc"], _shortened(repr(item["input"]))
        text = item["msg"].removeprefix("Value error, ")
        if item["type"] == "missing":
            text = "this key is missing"
        elif place[-1:] == ("[key]",):
            place, text = place[:-2], f"found the key {found}: a name is text, so put it in quotes"
        elif item["type"] in _MEANT:
            text = f"found {found}: it must be {_MEANT[item['type']]}"
        elif item["type"] != "value_error":
            text = f"found {found}: {text[:1].lower()}{text[1:]}"
        key = ".".join(str(part) for part in place)
        lines.append(f"{source}: {key}: {text}" if key else f"{source}: {text}")
    return "\n".join(lines)


def _shortened(text: str) -> str:
    return text if len(text) <= LONGEST else f"{text[:LONGEST]} ..."


def apply_setting(data: dict[str, Any], setting: str) -> None:
    """Change plain data by ``key.in.dots=value``.

    Raises:
        ConfigurationError: If the setting is not of this form or goes through a value.
    """
    key, equals, text = setting.partition("=")
    parts = key.strip().split(".")
    if not equals or not all(parts):
        raise ConfigurationError(
            f"--set {setting}: it must be key=value, such as 'policies.prime.learning_rate=1e-4'"
        )
    value = load_yaml(text, f"--set {key}")
    node: Any = data
    for depth, part in enumerate(parts[:-1]):
        if isinstance(node, list):
            node = node[_index(node, part, setting)]
        else:
            node = node.setdefault(part, {})
        if not isinstance(node, (dict, list)):
            inner = ".".join(parts[: depth + 1])
            raise ConfigurationError(f"--set {setting}: {inner} is {node!r}, it has no keys")
    if isinstance(node, list):
        node[_index(node, parts[-1], setting)] = value
    else:
        node[parts[-1]] = value


def _index(node: list[Any], part: str, setting: str) -> int:
    if not (part.isascii() and part.isdigit()) or int(part) >= len(node):
        raise ConfigurationError(
            f"--set {setting}: {part!r} is no place in a list of {len(node)}: use a number below "
            f"{len(node)}"
        )
    return int(part)


def dump_experiment(config: ExperimentConfig) -> str:
    """Return an experiment as YAML, all defaults written out, those of variants' changes too."""
    data = config.model_dump(mode="json")
    for name, variant in config.resolved_variants.items():
        resolved = variant.model_dump(mode="json", exclude={"variants"})
        data["variants"][name] = {key: new for key, new in resolved.items() if new != data[key]}
    return dump_yaml(data)
