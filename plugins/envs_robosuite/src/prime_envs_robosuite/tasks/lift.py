"""Lift: pick a cube up from a table."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from prime_core.contracts.description import Affordance, ObjectDescription
from prime_core.contracts.scene import Scene
from prime_envs_robosuite.simulation.objects import ObjectMotion, Placement
from prime_envs_robosuite.tasks.robosuite_import import CUBE_HALF_SIZE, make_host
from prime_envs_robosuite.tasks.subtasks import HoldUp, Subtask
from prime_envs_robosuite.tasks.task import QUARTER_TURNS, PlacedTask, sampler_placement

TABLE_TOP = 0.8
SUCCESS_HEIGHT = 0.04  # of the cube's centre above the table, as in robosuite


class LiftTask(PlacedTask):
    """robosuite's Lift with a cube of constant size.

    Solved when the cube is held with its centre more than 0.04 m above the table.
    """

    words = "lift the cube"
    objects = (ObjectDescription("cube", yaw_symmetry=4),)
    body_names = ("cube",)
    # The arm's base is at x = -0.56: the far corners are within its reach of 0.82 m.
    workspace_low = (-0.2, -0.25, TABLE_TOP + 0.01)
    workspace_high = (0.15, 0.25, TABLE_TOP + 0.25)
    lift_height = TABLE_TOP + 0.15

    def make_host(self) -> Any:
        """Build the robosuite environment; see `Task`."""
        return make_host("FixedCubeLift", cube_half_size=CUBE_HALF_SIZE)

    def placements(self, host: Any) -> tuple[Placement, ...]:
        """Return where the cube starts; see `Task`."""
        sampler = host.placement_initializer
        placement = sampler_placement(sampler, host.cube)
        # The sampler knows the size that robosuite drew, not the constant one.
        height = TABLE_TOP + float(sampler.z_offset) + CUBE_HALF_SIZE
        return (replace(placement, height=height),)

    def affordances(self) -> tuple[Affordance, ...]:
        """Return where actions make sense; see `Task`."""
        low, high = TABLE_TOP + CUBE_HALF_SIZE, TABLE_TOP + CUBE_HALF_SIZE + 0.02
        return (
            # Demonstrators grip it up to 1 cm below its centre, and up to 2 cm beside its middle.
            Affordance("grasp", "cube", (-0.02, -0.02, -0.012), (0.02, 0.02, 0.005), QUARTER_TURNS),
            Affordance("reach", "cube", (0.0, 0.0, 0.05), (0.0, 0.0, 0.12), QUARTER_TURNS),
            # Above the table, where demonstrators hold the cube up.
            Affordance(
                "reach", None, (-0.1, -0.15, TABLE_TOP + 0.03), (0.1, 0.15, TABLE_TOP + 0.17)
            ),
            Affordance("place", None, (-0.1, -0.15, low), (0.1, 0.15, high)),
        )

    def subtasks(self) -> tuple[Subtask, ...]:
        """Return what a demonstrator does; see `Task`."""
        return (HoldUp(object_name="cube", care=1.8),)

    def is_success(self, scene: Scene, touched: bool, motions: Sequence[ObjectMotion]) -> bool:
        """Whether the cube is held above the table; see `Task`."""
        height = float(scene.object_positions[0, 2])
        return scene.held == "cube" and height > TABLE_TOP + SUCCESS_HEIGHT
