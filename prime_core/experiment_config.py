"""The schema of an experiment, and how it is read from YAML."""

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Literal, Self

import yaml
from pydantic import Field, TypeAdapter, ValidationError, field_validator, model_validator

from prime_core.choices import (
    DemonstratorChoice,
    EnvironmentChoice,
    IdmChoice,
    ParserChoice,
    PolicyChoice,
    PrimitiveChoice,
)
from prime_core.collection import CollectionConfig
from prime_core.configuration import Config
from prime_core.errors import ConfigurationError
from prime_core.evaluation import EvaluationConfig
from prime_core.pair_data import PairConfig
from prime_core.policy_data import AugmentationConfig
from prime_core.variants import Changes, with_changes

SLURM_KEYS = ("partition", "account", "qos", "constraint", "memory_gb", "minutes", "setup")
"""Keys of `ComputeConfig` that mean nothing on this machine alone."""


class ComputeConfig(Config):
    """Where an experiment runs; no result depends on it."""

    cluster: Literal["local", "slurm"] = "local"
    """``local`` uses processes of this machine, ``slurm`` submits jobs, whose nodes must see the
    run's folder and this environment under the same paths."""
    workers: int = Field(2, ge=0)
    """Processes or jobs that share the work of a stage; 0 does it all in the process itself."""
    partition: str | None = None
    """Of Slurm; its default if there is none."""
    account: str | None = None
    """Of Slurm, to charge."""
    qos: str | None = None
    """Of Slurm."""
    constraint: str | None = None
    """Of Slurm, on what nodes there are."""
    memory_gb: float = Field(3.0, gt=0)
    """Of a Slurm job."""
    minutes: int = Field(720, ge=1)
    """That a Slurm job may take; what it has finished by then is kept."""
    setup: tuple[str, ...] = ()
    """Shell commands at the start of a Slurm job, such as ``module load ...``."""

    @model_validator(mode="after")
    def _slurm_keys_go_with_slurm(self) -> Self:
        fields = type(self).model_fields
        given = [name for name in SLURM_KEYS if getattr(self, name) != fields[name].default]
        if self.cluster == "local" and given:
            raise ValueError(
                f"found {given[0]!r} with 'cluster: local': it is for 'cluster: slurm'"
            )
        if self.cluster == "slurm" and not self.workers:
            raise ValueError("found 0 workers with 'cluster: slurm': at least 1 job is needed")
        return self


class ExperimentConfig(Config):
    """An experiment: what a YAML file holds."""

    name: str
    """Of the folder under ``runs/``."""
    seed: int = Field(0, ge=0)
    """Of demonstrations, collection and the IDM."""
    environment: EnvironmentChoice
    """Where the task is."""
    primitives: tuple[PrimitiveChoice, ...] = Field(min_length=1)
    """The library of primitives."""
    demonstrations: DemonstratorChoice
    """Where the demonstrations come from."""
    collection: CollectionConfig = CollectionConfig()
    """How random rollouts are collected."""
    pairs: PairConfig = PairConfig()
    """What the IDM is trained on."""
    idm: IdmChoice
    """The inverse dynamics model."""
    parser: ParserChoice
    """The parser."""
    augmentation: AugmentationConfig = AugmentationConfig()
    """What the policies are trained on."""
    policies: dict[str, PolicyChoice] = Field(min_length=1)
    """Policies to train and compare, by names of your choice."""
    seeds: tuple[int, ...] = Field((1, 2, 3), min_length=1)
    """Of the policies' trainings."""
    evaluation: EvaluationConfig = EvaluationConfig()
    """How policies are evaluated."""
    compute: ComputeConfig = ComputeConfig()
    """Where the experiment runs."""
    variants: dict[str, Changes] = Field(default_factory=dict)
    """The experiment with some keys changed, by names of your choice."""

    @field_validator("name")
    @classmethod
    def _name_is_a_folder(cls, name: str) -> str:
        if not re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9_.-]*", name):
            raise ValueError(f"found {name!r}: use letters, digits, '-', '_' and '.' only")
        return name

    @field_validator("policies", "variants")
    @classmethod
    def _names_are_words(cls, named: dict[str, Any]) -> dict[str, Any]:
        for name in named:
            if not re.fullmatch(r"[A-Za-z0-9_-]+", name):
                raise ValueError(f"found the name {name!r}: use letters, digits, '-', '_' only")
        return named

    @field_validator("seeds")
    @classmethod
    def _seeds_differ(cls, seeds: tuple[int, ...]) -> tuple[int, ...]:
        if len(set(seeds)) != len(seeds):
            raise ValueError(f"found {list(seeds)}: each seed may be named once only")
        return seeds

    @model_validator(mode="after")
    def _variants_are_experiments(self) -> Self:
        self.resolved_variants()
        return self

    def resolved_variants(self) -> dict[str, "ExperimentConfig"]:
        """Return the experiments that the variants are, by their names.

        Raises:
            pydantic.ValidationError: If one is wrong; its place begins with ``variants``.
        """
        if not self.variants:
            return {}
        data = self.model_dump(mode="json", exclude={"variants"})
        changed = {name: with_changes(data, changes) for name, changes in self.variants.items()}
        # In mappings as in the experiment, so that the place of a mistake reads as it does there.
        places = TypeAdapter(dict[str, dict[str, ExperimentConfig]])
        return places.validate_python({"variants": changed})["variants"]


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
    for name, variant in config.resolved_variants().items():
        resolved = variant.model_dump(mode="json", exclude={"variants"})
        data["variants"][name] = {key: new for key, new in resolved.items() if new != data[key]}
    return yaml.safe_dump(data, sort_keys=False)
