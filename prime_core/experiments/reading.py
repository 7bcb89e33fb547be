"""Reads experiments from YAML, with changes from the command line."""

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import yaml
from pydantic import ValidationError

from prime_core.errors import ConfigurationError
from prime_core.experiments.settings import ExperimentConfig


def read_experiment(path: Path, settings: Sequence[str] = ()) -> ExperimentConfig:
    """Read an experiment from YAML.

    Args:
        path: The file.
        settings: Changes to it, each ``key.in.dots=value``, the value in YAML.

    Raises:
        ConfigurationError: If something is wrong; the text names the file and the key, what was
            found and what would be right.
    """
    try:
        text = path.read_text(encoding="utf-8")
    except FileNotFoundError:
        raise ConfigurationError(f"{path}: there is no such file") from None
    except (OSError, UnicodeDecodeError) as error:
        raise ConfigurationError(f"{path}: cannot be read as text: {error}") from None
    data = _load_yaml(text, str(path))
    if not isinstance(data, dict):
        raise ConfigurationError(
            f"{path}: found {type(data).__name__} at the top: an experiment is a mapping of keys, "
            "such as 'name: lift'"
        )
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


def explain(error: ValidationError, source: str) -> str:
    """Return one line for each mistake: file, key, what was found and what would be right."""
    lines = []
    for item in error.errors():
        key = ".".join(str(part) for part in item["loc"])
        text = item["msg"].removeprefix("Value error, ")
        if item["type"] == "missing":
            text = "this key is missing"
        elif item["type"] != "value_error":
            text = f"found {item['input']!r}: {text[:1].lower()}{text[1:]}"
        lines.append(f"{source}: {key}: {text}" if key else f"{source}: {text}")
    return "\n".join(lines)


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
    value = _load_yaml(text, f"--set {key}")
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
    if not part.isdigit() or int(part) >= len(node):
        raise ConfigurationError(
            f"--set {setting}: {part!r} is no place in a list of {len(node)}: use a number below "
            f"{len(node)}"
        )
    return int(part)


class _Loader(yaml.SafeLoader):
    """YAML in which 1e-4 is a number, as people expect, and a key stands once only."""

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
        keys = [self.construct_object(key, deep=True) for key, _ in node.value]
        for key in keys:
            if keys.count(key) > 1:
                raise yaml.MarkedYAMLError(
                    problem=f"the key {key!r} stands twice", problem_mark=node.start_mark
                )
        return super().construct_mapping(node, deep)


_Loader.add_implicit_resolver(
    "tag:yaml.org,2002:float",
    re.compile(r"^[-+]?(\d+\.?\d*|\.\d+)[eE][-+]?\d+$"),
    list("-+.0123456789"),
)


def _load_yaml(text: str, source: str) -> Any:
    try:
        return yaml.load(text, Loader=_Loader)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark
        where = f", line {mark.line + 1}, column {mark.column + 1}" if mark else ""
        raise ConfigurationError(f"{source}{where}: not YAML: {error.problem}") from None
    except yaml.YAMLError as error:
        raise ConfigurationError(f"{source}: not YAML: {error}") from None


def dump_experiment(config: ExperimentConfig) -> str:
    """Return an experiment as YAML, all defaults written out, those of variants' changes too."""
    data = config.model_dump(mode="json")
    for name, variant in config.resolved_variants.items():
        resolved = variant.model_dump(mode="json", exclude={"variants"})
        data["variants"][name] = {key: new for key, new in resolved.items() if new != data[key]}
    return yaml.safe_dump(data, sort_keys=False)
