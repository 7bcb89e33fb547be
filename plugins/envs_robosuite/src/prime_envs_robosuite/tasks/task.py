"""What tells one robosuite task from another: objects, regions, success."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from prime_core.contracts.description import Affordance, ObjectDescription
from prime_core.contracts.scene import Scene
from prime_envs_robosuite.simulation.objects import ObjectMotion, Placement, Starts, uniform_starts
from prime_envs_robosuite.tasks.subtasks import Subtask

Judge = Callable[[Scene, bool, Sequence[ObjectMotion]], bool]
"""Says whether a task is solved; see `Task.is_success` for what it is told."""

QUARTER_TURNS = (0.0, float(np.pi / 2))
"""Yaws of a gripper across either pair of sides of a box [rad]."""

RELEASE_OPENING = 0.06  # from which the fingers, which open to 0.08 m, count as opened [m]


class Task(ABC):
    """A robosuite task as data, and its success check.

    Attributes:
        words: What is to be done.
        objects: The objects, in the scene's order.
        body_names: Their names in robosuite.
        workspace_low: Lower corner of the gripper's box [m], world frame.
        workspace_high: Upper corner [m].
        lift_height: World height at which the gripper travels [m].
    """

    words: str
    objects: tuple[ObjectDescription, ...]
    body_names: tuple[str, ...]
    workspace_low: tuple[float, float, float]
    workspace_high: tuple[float, float, float]
    lift_height: float

    @abstractmethod
    def make_host(self) -> Any:
        """Build the robosuite environment that the models come from."""

    @abstractmethod
    def starts(self, host: Any) -> Starts:
        """Return what draws where the objects start.

        Args:
            host: What `make_host` built.
        """

    @abstractmethod
    def affordances(self) -> tuple[Affordance, ...]:
        """Return where actions make sense."""

    @abstractmethod
    def subtasks(self) -> tuple[Subtask, ...]:
        """Return what a demonstrator does, one after another."""

    def judge(self, host: Any) -> Judge:
        """Return what says whether the task is solved: `is_success`, unless the host is asked, too.

        Args:
            host: What `make_host` built; it sees the physics that is stepped.
        """
        return self.is_success

    @abstractmethod
    def is_success(self, scene: Scene, touched: bool, motions: Sequence[ObjectMotion]) -> bool:
        """Whether the task is solved.

        Args:
            scene: The scene now.
            touched: Whether a finger touches any of the objects.
            motions: How each object moves.
        """


class PlacedTask(Task):
    """A task whose objects start each in a region of its own."""

    @abstractmethod
    def placements(self, host: Any) -> tuple[Placement, ...]:
        """Return where each object starts.

        Args:
            host: What `make_host` built.
        """

    def starts(self, host: Any) -> Starts:
        """Return what draws each object's start by itself; see `Task`."""
        return uniform_starts(self.placements(host))


def is_let_go(scene: Scene, touched: bool) -> bool:
    """Whether the gripper is open and touches nothing.

    Args:
        scene: The scene now.
        touched: Whether a finger touches any of the objects.
    """
    return not touched and scene.gripper_opening > RELEASE_OPENING


def sampler_placement(sampler: Any, body: Any) -> Placement:
    """Read the start region of an object off robosuite's sampler.

    Args:
        sampler: A robosuite ``UniformRandomSampler`` about z.
        body: The robosuite object model.
    """
    margin = body.horizontal_radius if sampler.ensure_object_boundary_in_range else 0.0
    x, y, z = (float(value) for value in sampler.reference_pos)
    return Placement(
        low=(x + float(min(sampler.x_range)) + margin, y + float(min(sampler.y_range)) + margin),
        high=(x + float(max(sampler.x_range)) - margin, y + float(max(sampler.y_range)) - margin),
        height=z + float(sampler.z_offset) - float(body.bottom_offset[-1]),
        quaternion=tuple(getattr(body, "init_quat", (1.0, 0.0, 0.0, 0.0))),
    )
