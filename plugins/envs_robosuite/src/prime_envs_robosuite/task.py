"""What tells one robosuite task from another: objects, regions, success."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from prime_core.contracts.description import Affordance, ObjectDescription
from prime_core.contracts.scene import Scene
from prime_envs_robosuite.jobs import Job

RELEASE_OPENING = 0.06  # the fingers open to 0.08 m
REST_SPEED = 0.05  # [m/s]
REST_TURNING = 0.5  # [rad/s]


@dataclass(frozen=True)
class Placement:
    """Where an object may lie at the start; place and yaw are uniform.

    Attributes:
        low: Smallest x and y of the object's centre [m], world frame.
        high: Greatest x and y [m].
        height: z of the object's centre [m].
        quaternion: Its orientation at yaw 0, ``(4,)``, w-x-y-z.
        yaws: Smallest and greatest yaw [rad].
    """

    low: tuple[float, float]
    high: tuple[float, float]
    height: float
    quaternion: tuple[float, float, float, float] = (1.0, 0.0, 0.0, 0.0)
    yaws: tuple[float, float] = (0.0, 2.0 * np.pi)


@dataclass(frozen=True)
class Motion:
    """How fast an object moves.

    Attributes:
        speed: Of its centre [m/s].
        turning: Its rate of turn [rad/s].
    """

    speed: float
    turning: float

    @property
    def at_rest(self) -> bool:
        """Whether a person would say that it lies still."""
        return self.speed < REST_SPEED and self.turning < REST_TURNING


class Task(ABC):
    """A robosuite task as data, and its success check.

    Attributes:
        words: What is to be done.
        objects: The objects, in the scene's order.
        body_names: Their names in robosuite, without the ``_main`` of the body.
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
    def placements(self, host: Any) -> tuple[Placement, ...]:
        """Return where each object starts.

        Args:
            host: What `make_host` built.
        """

    @abstractmethod
    def affordances(self) -> tuple[Affordance, ...]:
        """Return where actions make sense."""

    @abstractmethod
    def jobs(self) -> tuple[Job, ...]:
        """Return what a person has to do, one job after another."""

    @abstractmethod
    def is_success(self, scene: Scene, touched: bool, motions: Sequence[Motion]) -> bool:
        """Whether the task is solved.

        Args:
            scene: The scene now.
            touched: Whether a finger touches any of the objects.
            motions: How each object moves.
        """


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
