"""Makes sure that an experiment's parts go together, before hours of work."""

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from prime_core.configuration import ConfigDump
from prime_core.contracts.calls import ParameterSpace
from prime_core.contracts.primitive import LearnedPrimitiveConfig, PrimitiveConfig
from prime_core.errors import ConfigurationError
from prime_core.execution.world import World, check_names
from prime_core.experiments.settings import ExperimentConfig
from prime_core.registry.building import build_world
from prime_core.registry.fields import dump_choice

if TYPE_CHECKING:  # `prime validate` needs no stages, which take seconds to import
    from prime_core.experiments.experiment import Experiment


def check_primitives(config: ExperimentConfig) -> None:
    """Make sure that primitives are told apart by their names.

    To know a name takes building the environment, which takes seconds: it is done where two are
    registered under the same last word, as ``scripted/reach`` and ``mylab/reach``. The settings of
    learned primitives say it; they need not be trained yet.

    Args:
        config: With its variants.

    Raises:
        ConfigurationError: If two primitives have the same name.
    """
    members = {"": config}
    members |= {f"variants.{name}.": item for name, item in config.resolved_variants.items()}
    seen = []
    for prefix, member in members.items():
        called, others = _called(member.primitives)
        parts = dump_choice(member.environment), others, called
        words = [*called, *(str(dump["type"]).rpartition("/")[2] for dump in others)]
        if len(set(words)) < len(words) and parts not in seen:
            seen.append(parts)
            try:
                check_names((*called, *build_world(*parts[:2]).space.names))
            except ConfigurationError as error:
                raise ConfigurationError(f"{prefix}{error}") from error


def _called(
    primitives: Sequence[PrimitiveConfig],
) -> tuple[tuple[str, ...], tuple[ConfigDump, ...]]:
    """Return what learned primitives are called, and the settings of the others."""
    learned = [item for item in primitives if isinstance(item, LearnedPrimitiveConfig)]
    others = (item for item in primitives if not isinstance(item, LearnedPrimitiveConfig))
    return tuple(item.called for item in learned), tuple(map(dump_choice, others))


def check_environments(experiment: "Experiment") -> None:
    """Make sure that models mean the same where they learn as where the task is.

    Nothing is built where all rollouts come from the task's environment, or where the
    demonstrations are parsed already.

    Args:
        experiment: With its variants.

    Raises:
        ConfigurationError: If an environment of the collection has other objects, another arm or
            other parameters of primitives than the task's.
    """
    members = {"": experiment}
    members |= {f"variants.{name}.": variant for name, variant in experiment.variants.items()}
    for prefix, member in members.items():
        task = member.demonstrations.environment
        others = _other_environments(member, task)
        if not others or not member.parsing.missing():
            continue
        _, primitives = _called(member.config.primitives)
        right = dict(_seen_by_models(build_world(task, primitives)))
        for index, environment in others.items():
            for part, found in _seen_by_models(build_world(environment, primitives)):
                if found != right[part]:
                    raise ConfigurationError(
                        f"{prefix}collection.environments.{index}: found {environment['type']!r}, "
                        f"which has other {part} than the task's environment {task['type']!r}: "
                        f"{found}, not {right[part]}. What is learnt in the one is used in the "
                        "other: name environments that agree"
                    )


def _other_environments(experiment: "Experiment", task: ConfigDump) -> dict[int, ConfigDump]:
    """Return where rollouts are collected by places in the list, but for the task's."""
    environments = enumerate(experiment.collection.environments)
    return {index: environment for index, environment in environments if environment != task}


def _seen_by_models(world: World) -> Iterator[tuple[str, str]]:
    """Yield what inputs and outputs of models depend on, and how it is there."""
    objects = [f"{item.name} ({item.yaw_symmetry})" for item in world.description.objects]
    yield "objects (and yaw symmetry)", ", ".join(objects)
    yield "arm joints", str(world.description.joint_count)
    for name, parameters in zip(world.space.names, world.space.parameter_spaces, strict=True):
        yield f"parameters of {name}", _bounds(parameters)


def _bounds(space: ParameterSpace) -> str:
    return ", ".join(
        f"{item.name} {item.low:g} to {item.high:g} {item.unit}" for item in space.parameters
    )
