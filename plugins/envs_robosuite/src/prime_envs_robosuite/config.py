"""Settings of the environments."""

from typing import TYPE_CHECKING, Literal

from pydantic import Field

from prime_core.configuration import Count
from prime_core.contracts.environment import Environment, EnvironmentConfig

if TYPE_CHECKING:
    from prime_envs_robosuite.tasks.task import Task


class RobosuiteConfig(EnvironmentConfig):
    """What all robosuite tasks can be told."""

    stepping: Literal["compiled", "stock"] = "compiled"
    """``compiled`` runs robosuite's control law as machine code; ``stock`` calls robosuite.

    They agree to rounding in one step; compiled is several times as fast."""

    cameras: tuple[str, ...] = ()
    """Cameras whose images are part of the observations: ``agentview``, ``wrist``, or any of
    robosuite's."""

    image_size: int = Field(84, ge=1, le=4096)
    """Height and width of those images [pixels]."""

    horizon: Count | None = None
    """Steps after which an episode is truncated; none by default."""

    def _around(self, task: "Task") -> Environment:
        """Make the environment of a task."""
        from prime_envs_robosuite.mujoco_import import import_mujoco

        import_mujoco()
        from prime_envs_robosuite.environment import RobosuiteEnvironment

        return RobosuiteEnvironment(
            task, self.stepping, self.cameras, self.image_size, self.horizon
        )


class LiftConfig(RobosuiteConfig):
    """robosuite's Lift: hold a cube more than 4 cm above the table.

    The cube's half size is always 0.021 m, where robosuite draws 0.020 to 0.022 m.
    """

    def build(self) -> Environment:
        """Make the environment."""
        from prime_envs_robosuite.tasks.lift import LiftTask

        return self._around(LiftTask())


class NutAssemblyConfig(RobosuiteConfig):
    """robosuite's NutAssembly: put one nut or both around their pegs and let go."""

    nut: Literal["round", "square", "both"] = "round"
    """The nut to move, to the peg of its shape; ``both`` is robosuite's own task."""

    initial_range: Literal["paper", "robosuite"] = "paper"
    """How the nut may lie at the start: ``paper`` with its handle on the robot's side,
    ``robosuite`` at any yaw."""

    def build(self) -> Environment:
        """Make the environment."""
        from prime_envs_robosuite.tasks.nut_assembly import NutAssemblyTask

        return self._around(NutAssemblyTask(self.nut, self.initial_range))


class PickPlaceConfig(RobosuiteConfig):
    """robosuite's PickPlace: put one object or all into their own quarters and let go."""

    object: Literal["milk", "can", "bread", "cereal", "all"] = "milk"
    """The object to move; ``all`` is robosuite's own task, with all four."""

    def build(self) -> Environment:
        """Make the environment."""
        from prime_envs_robosuite.tasks.pick_place import PickPlaceTask

        return self._around(PickPlaceTask(self.object))


class StackConfig(RobosuiteConfig):
    """robosuite's Stack: put cube A, the smaller one, onto cube B and let go."""

    def build(self) -> Environment:
        """Make the environment."""
        from prime_envs_robosuite.robosuite_tasks.stack import StackTask

        return self._around(StackTask())


class TaskConfig(RobosuiteConfig):
    """Any task of robosuite's for one arm, solved when robosuite says so.

    Objects, their sizes and symmetries, where they start and where it makes sense to grasp, place
    and reach are read from its model; see `docs/environments.md` for what that cannot tell.
    """

    name: str = "Lift"
    """robosuite's name of the task, such as ``Stack`` or ``PickPlaceCan``; a task that a lab
    registers with robosuite in a pack of its own, too."""

    def build(self) -> Environment:
        """Make the environment.

        Raises:
            ConfigurationError: If there is no such task, or none for one Panda with its gripper.
        """
        from prime_envs_robosuite.mujoco_import import import_mujoco

        import_mujoco()
        from prime_envs_robosuite.robosuite_tasks.robosuite_task import RobosuiteTask

        return self._around(RobosuiteTask(self.name))


class TidyUpConfig(RobosuiteConfig):
    """The paper's TidyUp: two small boxes into a bin, a large one pushed onto a mat."""

    variant: Literal["A", "B", "C", "D"] = "D"
    """Where bins and mats are, and how they look. The paper's task is D."""

    def build(self) -> Environment:
        """Make the environment."""
        from prime_envs_robosuite.tasks.tidy_up import TidyUpTask

        return self._around(TidyUpTask(self.variant))


class CleanUpConfig(RobosuiteConfig):
    """The paper's CleanUp: push a popcorn box to the serving area, and put butter away."""

    variant: Literal["bin", "stack"] = "bin"
    """Where the butter belongs: in the bin, or on top of the popcorn box."""

    def build(self) -> Environment:
        """Make the environment."""
        from prime_envs_robosuite.tasks.clean_up import CleanUpTask

        return self._around(CleanUpTask(self.variant))
