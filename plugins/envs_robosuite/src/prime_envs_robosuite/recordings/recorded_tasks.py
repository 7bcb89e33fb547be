"""Which environment of ours a recording of robosuite's fits: the one table of their names."""

from dataclasses import dataclass

from prime_core.contracts.environment import EnvironmentConfig
from prime_core.errors import DatasetError
from prime_envs_robosuite.config import (
    LiftConfig,
    NutAssemblyConfig,
    PickPlaceConfig,
    RobosuiteConfig,
    StackConfig,
    TaskConfig,
)
from prime_envs_robosuite.tasks.robosuite_import import GROCERIES, NUTS


@dataclass(frozen=True)
class RecordedTask:
    """A task of robosuite's that people record.

    Attributes:
        environment: Ours, with the settings that choose the task.
        objects: robosuite's names of all objects in its recordings, in the order of their states;
            with one object to be moved it keeps the others, out of the way.
    """

    environment: RobosuiteConfig
    objects: tuple[str, ...]


RECORDED_TASKS: dict[str, RecordedTask] = {
    "Lift": RecordedTask(LiftConfig(), ("cube",)),
    "Stack": RecordedTask(StackConfig(), ("cubeA", "cubeB")),
    "PickPlace": RecordedTask(PickPlaceConfig(object="all"), GROCERIES),
    "PickPlaceMilk": RecordedTask(PickPlaceConfig(object="milk"), GROCERIES),
    "PickPlaceBread": RecordedTask(PickPlaceConfig(object="bread"), GROCERIES),
    "PickPlaceCereal": RecordedTask(PickPlaceConfig(object="cereal"), GROCERIES),
    "PickPlaceCan": RecordedTask(PickPlaceConfig(object="can"), GROCERIES),
    "NutAssembly": RecordedTask(NutAssemblyConfig(nut="both"), NUTS),
    "NutAssemblySquare": RecordedTask(NutAssemblyConfig(nut="square"), NUTS),
    "NutAssemblyRound": RecordedTask(NutAssemblyConfig(nut="round"), NUTS),
}
"""By robosuite's name of the task, which a recording's ``env`` or ``env_name`` says. Recordings of
all other tasks fit ``robosuite/task`` of that name."""

CHOICES = ("object", "nut")  # the settings that choose the task


def environment_of(name: str) -> RobosuiteConfig:
    """Return our environment for the recordings of a task.

    Args:
        name: robosuite's name of it; it need not be one that there is.
    """
    known = RECORDED_TASKS.get(name)
    return TaskConfig(name=name) if known is None else known.environment


def recorded_task(environment: EnvironmentConfig, demonstrator: str) -> str:
    """Return robosuite's name of the task whose recordings fit an environment.

    Args:
        environment: Settings of the environment.
        demonstrator: Who asks, for the error.

    Raises:
        DatasetError: If it is no task of robosuite's.
    """
    if isinstance(environment, TaskConfig):
        return environment.name
    wanted = _choice(environment)
    for name, known in RECORDED_TASKS.items():
        if _choice(known.environment) == wanted:
            return name
    raise DatasetError(
        f"demonstrator {demonstrator!r} reads recordings of robosuite's tasks "
        f"({', '.join(RECORDED_TASKS)}, or any other in 'robosuite/task'); there are none of "
        f"{type(environment).__name__}"
    )


def _choice(environment: EnvironmentConfig) -> tuple[object, ...]:
    """Return what tells the task of an environment: its class and what is to be moved."""
    return type(environment), *(getattr(environment, key, None) for key in CHOICES)
