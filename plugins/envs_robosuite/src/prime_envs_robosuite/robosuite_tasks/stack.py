"""Stack: put a cube onto a larger one."""

from collections.abc import Sequence

from prime_core.contracts.description import Affordance
from prime_core.contracts.scene import Scene
from prime_envs_robosuite.robosuite_tasks.robosuite_task import RobosuiteTask
from prime_envs_robosuite.simulation.objects import ObjectMotion
from prime_envs_robosuite.tasks.subtasks import ArmReach, Neighbour, PutOnto, Subtask
from prime_envs_robosuite.tasks.task import QUARTER_TURNS

UPPER, LOWER = "cubeA", "cubeB"
LOWER_HALF_SIZE = 0.025  # [m]
STACKED = 0.045  # of the upper cube's centre above the lower one's [m]
RELEASE_GAP = 0.005  # of the upper cube above the lower one when it is let go of [m]
EASY_REACH = ArmReach(base=(-0.56, 0.0), distance=0.72)  # of the arm at the table's edge


class StackTask(RobosuiteTask):
    """robosuite's Stack, with cube A the one to be taken.

    Solved when robosuite says so (A is on B, above the table, not gripped), no finger touches a
    cube and both are at rest. robosuite looks at the pads alone, and so at times calls A stacked
    while it is still held.
    """

    def __init__(self) -> None:
        super().__init__("Stack")
        self.words = "put cube A on top of cube B"

    def affordances(self) -> tuple[Affordance, ...]:
        """Return where actions make sense; see `Task`."""
        low, high = (0.0, 0.0, STACKED), (0.0, 0.0, STACKED + RELEASE_GAP)
        above = (0.0, 0.0, STACKED + 0.04), (0.0, 0.0, STACKED + 0.1)
        return (
            # As for Lift's cube, which is as large.
            Affordance("grasp", UPPER, (-0.02, -0.02, -0.01), (0.02, 0.02, 0.005), QUARTER_TURNS),
            Affordance("place", LOWER, low, high, of_held=True),
            Affordance("reach", UPPER, (0.0, 0.0, 0.05), (0.0, 0.0, 0.12), QUARTER_TURNS),
            Affordance("reach", LOWER, *above, of_held=True),
            Affordance("place", None, (-0.15, -0.15, 0.82), (0.15, 0.15, 0.84)),
            Affordance("reach", None, (-0.15, -0.15, 0.85), (0.15, 0.15, 0.95)),
        )

    def subtasks(self) -> tuple[Subtask, ...]:
        """Return what a demonstrator does; see `Task`."""
        return (
            PutOnto(
                object_name=UPPER,
                point=(0.0, 0.0, STACKED),
                reach=EASY_REACH,
                clearance=0.06,
                drop=(0.002, RELEASE_GAP),
                retreat=(0.06, 0.11),
                reference=LOWER,
                neighbours=(Neighbour(LOWER, (LOWER_HALF_SIZE,) * 3),),
                any_yaw=True,
            ),
        )

    def is_success(self, scene: Scene, touched: bool, motions: Sequence[ObjectMotion]) -> bool:
        """Whether it is let go of and at rest, beside robosuite's check; see `Task`."""
        return not touched and all(motion.at_rest for motion in motions)
