"""Which environment of ours a recording of robosuite's fits: the one table of their names."""

from dataclasses import dataclass

from prime_core.configuration import ConfigDump
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
        type: Of our environment.
        config_class: Of its settings.
        choice: The settings that choose the task.
        objects: robosuite's names of all objects in its recordings, in the order of their states;
            with one object to be moved it keeps the others, out of the way.
    """

    type: str
    config_class: type[RobosuiteConfig]
    choice: dict[str, str]
    objects: tuple[str, ...]


def _pick_place(choice: str) -> RecordedTask:
    return RecordedTask("robosuite/pick-place", PickPlaceConfig, {"object": choice}, GROCERIES)


def _nut_assembly(choice: str) -> RecordedTask:
    return RecordedTask("robosuite/nut-assembly", NutAssemblyConfig, {"nut": choice}, NUTS)


RECORDED_TASKS = {
    "Lift": RecordedTask("robosuite/lift", LiftConfig, {}, ("cube",)),
    "Stack": RecordedTask("robosuite/stack", StackConfig, {}, ("cubeA", "cubeB")),
    "PickPlace": _pick_place("all"),
    "PickPlaceMilk": _pick_place("milk"),
    "PickPlaceBread": _pick_place("bread"),
    "PickPlaceCereal": _pick_place("cereal"),
    "PickPlaceCan": _pick_place("can"),
    "NutAssembly": _nut_assembly("both"),
    "NutAssemblySquare": _nut_assembly("square"),
    "NutAssemblyRound": _nut_assembly("round"),
}
"""By robosuite's name of the task, which a recording's ``env`` or ``env_name`` says. Recordings of
all other tasks fit ``robosuite/task`` of that name."""


def environment_of(name: str) -> ConfigDump:
    """Return our environment for the recordings of a task, as plain data with its ``type``.

    Args:
        name: robosuite's name of it; it need not be one that there is.
    """
    known = RECORDED_TASKS.get(name)
    if known is None:
        return {"type": "robosuite/task", "name": name}
    return {"type": known.type, **known.choice}


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
    for name, known in RECORDED_TASKS.items():
        if isinstance(environment, known.config_class) and all(
            getattr(environment, key) == value for key, value in known.choice.items()
        ):
            return name
    raise DatasetError(
        f"demonstrator {demonstrator!r} reads recordings of robosuite's tasks "
        f"({', '.join(RECORDED_TASKS)}, or any other in 'robosuite/task'); there are none of "
        f"{type(environment).__name__}"
    )
