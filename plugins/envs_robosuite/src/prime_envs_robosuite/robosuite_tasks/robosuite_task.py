"""Any task of robosuite's for one arm, with what its model says of it."""

import re
from collections.abc import Sequence
from typing import Any

from prime_core.contracts.description import Affordance, ObjectDescription
from prime_core.contracts.scene import Scene
from prime_core.errors import ConfigurationError
from prime_envs_robosuite.robosuite_tasks.default_affordances import (
    grasps,
    over_the_table,
    place_on,
    reaches_above,
)
from prime_envs_robosuite.robosuite_tasks.start_region import SampledStarts, StartRegion
from prime_envs_robosuite.simulation.objects import ObjectMotion, Starts
from prime_envs_robosuite.tasks.robosuite_import import GRIPPER, make_robosuites_own
from prime_envs_robosuite.tasks.subtasks import Subtask
from prime_envs_robosuite.tasks.task import Judge, Task


class RobosuiteTask(Task):
    """A task by its robosuite name: all objects that lie loose, and robosuite's word on success.

    Objects start where robosuite's sampler puts them. Sizes, symmetries of the hulls and where
    objects start are read from the model, and affordances made of them: grasp where the fingers
    fit, place over the region where things start and on the other objects, reach above them.

    Args:
        name: robosuite's name of the task.

    Raises:
        ConfigurationError: If robosuite has no such task, or it is none for one Panda with its
            gripper and things that lie loose.
    """

    def __init__(self, name: str) -> None:
        self.name = name
        self.words = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", name).lower()
        host = self.make_host()
        loose = [item for item in host.model.mujoco_objects if _is_loose(host, item)]
        _check(host, name, loose)
        self.body_names = tuple(item.name for item in loose)
        region = StartRegion.read(host, loose)
        host.close()
        self.shapes = dict(zip(self.body_names, region.shapes, strict=True))
        self.region = region
        self.workspace_low, self.workspace_high = region.workspace_low, region.workspace_high
        self.lift_height = region.lift_height
        self.objects = tuple(
            ObjectDescription(item, shape.yaw_symmetry(), graspable=bool(grasps(item, shape)))
            for item, shape in self.shapes.items()
        )

    def make_host(self) -> Any:
        """Build the robosuite environment; see `Task`."""
        return make_robosuites_own(self.name)

    def starts(self, host: Any) -> Starts:
        """Return robosuite's own sampler; see `Task`."""
        return SampledStarts(host, self.body_names, self.region)

    def affordances(self) -> tuple[Affordance, ...]:
        """Return what shapes and starts say of where actions make sense; see `Task`."""
        spots = [spot for name, shape in self.shapes.items() for spot in grasps(name, shape)]
        if not spots:
            return ()
        names = list(self.shapes)
        onto = [
            place_on(
                name, self.shapes[name], [self.shapes[other] for other in names if other != name]
            )
            for name in names
            if len(names) > 1
        ]
        return (
            *spots,
            *onto,
            *map(reaches_above, spots),
            *over_the_table(
                spots, self.shapes, self.region.surface, self.workspace_low, self.workspace_high
            ),
        )

    def subtasks(self) -> tuple[Subtask, ...]:
        """Raise: what a demonstrator does is not in the model; see `Task`.

        Raises:
            ConfigurationError: Always.
        """
        raise ConfigurationError(
            f"how robosuite's {self.name} is done is not known, so that no simulated teleoperator "
            "can show it: take recordings (demonstrations of type robosuite-hdf5 or lerobot)"
        )

    def judge(self, host: Any) -> Judge:
        """Return robosuite's word on success, and ours; see `Task`."""
        return lambda *now: bool(host._check_success()) and self.is_success(*now)

    def is_success(self, scene: Scene, touched: bool, motions: Sequence[ObjectMotion]) -> bool:
        """Whether what we ask for beside robosuite's check is so: nothing; see `Task`."""
        return True


def _is_loose(host: Any, item: Any) -> bool:
    """Whether an object of robosuite's moves freely."""
    import mujoco

    kinds = [host.sim.model._model.joint(name).type for name in item.joints]
    return kinds == [mujoco.mjtJoint.mjJNT_FREE]


def _check(host: Any, name: str, loose: Sequence[Any]) -> None:
    """Raise if a task is none that `RobosuiteTask` can be."""
    start = f"environment 'robosuite/task': robosuite's {name}"
    gripper = type(host.robots[0].gripper["right"]).__name__
    if gripper != GRIPPER:
        raise ConfigurationError(
            f"{start} has a {gripper}; only tasks with the {GRIPPER} are known"
        )
    if not loose:
        joints = [joint for item in host.model.mujoco_objects for joint in item.joints]
        has = f"joints ({', '.join(joints)}) of things that are fixed" if joints else "no objects"
        raise ConfigurationError(
            f"{start} has {has}; what is missing are objects that lie loose (a free joint): scenes "
            "tell of those alone"
        )
