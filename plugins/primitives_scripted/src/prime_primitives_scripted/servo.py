"""From the move that is wanted of the gripper to one that the arm can make in a step."""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from prime_core.affordances.goals import equivalent_goals
from prime_core.contracts.description import SceneDescription
from prime_core.contracts.environment import ACTION_LIMIT
from prime_core.contracts.scene import Scene
from prime_core.errors import PrimeError

if TYPE_CHECKING:
    from prime_primitives_scripted.ik import InverseKinematics

Array = NDArray[np.float64]

COMFORT = 0.4
"""Distance from the joints' limits with which the shorter turn is taken [rad]."""
REMEMBERED = 4  # plans; a motion asks for two at most, those that its draw was judged by
MOVE_LIMIT = ACTION_LIMIT[:4]


class Servo:
    """Makes moves that an action can hold, along a straight line."""

    def is_stuck(self, scene: Scene) -> bool:
        """Whether no move would bring the gripper where it is told to go."""
        return False

    def move(self, scene: Scene, wanted: Array) -> Array:
        """Return the move that one action can make of the one that is wanted.

        Args:
            scene: The scene now.
            wanted: x, y, z [m] and yaw [rad], ``(4,)``.

        Returns:
            ``(4,)``, within the limits of an action.
        """
        return limited(wanted)

    def plan(self, scene: Scene, parameters: Array) -> Array | None:
        """Return the goal to head for, or None if the arm cannot get there.

        Args:
            scene: Where the motion starts.
            parameters: x, y, z [m] and the jaws' yaw [rad], ``(4,)``.

        Returns:
            The goal with the shorter turn that can be reached, ``(4,)``.
        """
        return equivalent_goals(parameters, scene.gripper_yaw)[0]


class KinematicServo(Servo):
    """Makes moves within the limits of the arm's joints and clear of furniture.

    Args:
        inverse_kinematics: Of the arm in the scenes.
        lift_height: World height at which the gripper travels [m].
    """

    def __init__(self, inverse_kinematics: "InverseKinematics", lift_height: float) -> None:
        self._inverse_kinematics = inverse_kinematics
        self._lift_height = lift_height
        self._answered: dict[bytes, Array | None] = {}

    def is_stuck(self, scene: Scene) -> bool:
        """Whether the arm is stretched so far that its elbow is locked."""
        return self._inverse_kinematics.is_locked(scene.joint_positions)

    def plan(self, scene: Scene, parameters: Array) -> Array | None:
        """Return the nearest goal that can be reached from above; see `Servo`."""
        # A motion starts with the plan that was asked for before it was tried.
        numbers = (scene.joint_positions, scene.gripper_quaternion, parameters)
        question = b"".join(np.ascontiguousarray(item).tobytes() for item in numbers)
        if question not in self._answered:
            if len(self._answered) >= REMEMBERED:
                self._answered.pop(next(iter(self._answered)))
            self._answered[question] = self._solve(scene, parameters)
        return self._answered[question]

    def move(self, scene: Scene, wanted: Array) -> Array:
        """Return the nearest move that the arm's limits allow; see `Servo`."""
        return limited(self._inverse_kinematics.step(scene.joint_positions, limited(wanted)))

    def _solve(self, scene: Scene, parameters: Array) -> Array | None:
        best, widest = None, 0.0
        for goal in equivalent_goals(parameters, scene.gripper_yaw):
            room = self._room(scene, goal)
            # The longer turn has to be worth it.
            if room > widest + (0.0 if best is None else COMFORT / 2):
                best, widest = goal, room
            if widest > COMFORT:
                break
        return best

    def _room(self, scene: Scene, goal: Array) -> float:
        """Return how far from its limits the arm stays at and above a goal [rad], or 0."""
        solver = self._inverse_kinematics
        above = solver.solve(
            scene.joint_positions, np.array([goal[0], goal[1], self._lift_height, goal[3]])
        )
        at_goal = None if above is None else solver.solve(above, goal)
        if above is None or at_goal is None:
            return 0.0
        return min(solver.room(above), solver.room(at_goal))


def limited(move: Array) -> Array:
    """Shorten a move until an action holds it; way and turn keep their proportion.

    Turning at full speed drags the gripper aside: a turn that ends with the way is gentler.

    Args:
        move: x, y, z [m] and yaw [rad], ``(4,)``.

    Returns:
        ``(4,)``.
    """
    excess = max(1.0, float((np.abs(move) / MOVE_LIMIT).max()))
    shortened: Array = np.minimum(np.maximum(move / excess, -MOVE_LIMIT), MOVE_LIMIT)
    return shortened


def make_servo(description: SceneDescription, inverse_kinematics: bool) -> Servo:
    """Return the servo for the scenes of an environment.

    Args:
        description: Of the scenes; without a robot there is nothing to solve.
        inverse_kinematics: Whether to respect the limits of the arm.

    Raises:
        PrimeError: If MuJoCo cannot be imported.
    """
    if description.robot is None or not inverse_kinematics:
        return Servo()
    # mink and mujoco take most of a second to import: only when they are used.
    try:
        from prime_primitives_scripted.ik import InverseKinematics
    except (AttributeError, ImportError, RuntimeError) as error:  # of its picture library
        raise PrimeError(
            f"MuJoCo cannot be imported ({error}): leave MUJOCO_GL unset, or name a library that "
            "is there"
        ) from error

    return KinematicServo(InverseKinematics(description.robot), description.lift_height)
