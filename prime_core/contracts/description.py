"""What never changes in the scenes of an environment: objects, affordances, the robot."""

from dataclasses import dataclass, field

from prime_core.contracts.observations import (
    GRIPPER_WIDTH,
    OBJECT_WIDTH,
)


@dataclass(frozen=True)
class ObjectDescription:
    """One object as the environment declares it.

    Attributes:
        name: Its name, unique in the scene.
        yaw_symmetry: In how many yaw angles it looks the same: 1 (none), 2 (a half turn),
            4 (a quarter turn), ... 0 stands for a round object.
        graspable: Whether the primitive grasp may take it.
        pushable: Whether the primitive push may move it.
    """

    name: str
    yaw_symmetry: int = 1
    graspable: bool = True
    pushable: bool = False


@dataclass(frozen=True)
class Affordance:
    """A place where an action makes sense: the centre of a primitive's parameter prior.

    The centre is uniform in a box. Relative to an object, the box is in the object's own
    yaw frame (z up); otherwise in the world frame. It is where the gripper goes, or, of what
    is held, where the gripper brings the centre of the object that it holds.

    Attributes:
        action: What can be done there: ``"grasp"``, ``"place"``, ``"reach"``, ``"push"``, or
            a word of a third party's primitive.
        reference: The object that the box goes with, or None for the world.
        low: Lower corner of the box of centres [m], ``(3,)``.
        high: Upper corner [m], ``(3,)``.
        yaws: Yaws that make sense [rad], of the gripper or of what is held, relative to the
            reference's yaw if there is one; None where any yaw does.
        of_held: Whether box and yaws are those of the object that the gripper holds. It then
            says nothing while nothing is held.
    """

    action: str
    reference: str | None
    low: tuple[float, float, float]
    high: tuple[float, float, float]
    yaws: tuple[float, ...] | None = None
    of_held: bool = False


@dataclass(frozen=True)
class RobotDescription:
    """An arm's kinematics, for inverse kinematics.

    Attributes:
        mjcf: A MuJoCo model that loads from this string alone: the arm at its base pose in
            the world, the hand and the furniture as simple collision geoms.
        joint_names: The arm's joints, in the order of ``Scene.joint_positions``.
        end_effector: Name of the site whose pose is the gripper's pose.
        hand_geoms: Names of the geoms that must not touch the furniture.
        furniture_geoms: Names of the geoms of tables and bins.
        joint_velocity_limits: [rad/s], ``(J,)``.
        name: As LeRobot calls the robot.
    """

    mjcf: str = field(repr=False)
    joint_names: tuple[str, ...]
    end_effector: str
    hand_geoms: tuple[str, ...] = ()
    furniture_geoms: tuple[str, ...] = ()
    joint_velocity_limits: tuple[float, ...] = ()
    name: str = "unknown"


@dataclass(frozen=True)
class SceneDescription:
    """What is the same in every scene of an environment.

    Attributes:
        objects: The objects, in the order of all object arrays.
        workspace_low: Lower corner of the box of gripper positions [m], ``(3,)``.
        workspace_high: Upper corner [m], ``(3,)``.
        lift_height: World height at which the gripper travels [m].
        affordances: Where actions make sense.
        robot: The arm's kinematics; None where the environment has no model of it.
        joint_count: Number of arm joints in the state vector.
    """

    objects: tuple[ObjectDescription, ...]
    workspace_low: tuple[float, float, float]
    workspace_high: tuple[float, float, float]
    lift_height: float
    affordances: tuple[Affordance, ...] = ()
    robot: RobotDescription | None = None
    joint_count: int = 7

    @property
    def state_width(self) -> int:
        """Length of ``observation.state``."""
        return GRIPPER_WIDTH + self.joint_count

    @property
    def environment_state_width(self) -> int:
        """Length of ``observation.environment_state``."""
        return OBJECT_WIDTH * len(self.objects)

    @property
    def state_names(self) -> list[str]:
        """A name for each number of ``observation.state``."""
        gripper = ["gripper.x", "gripper.y", "gripper.z"]
        gripper += ["gripper.qw", "gripper.qx", "gripper.qy", "gripper.qz"]
        joints = [f"joint_{number}" for number in range(self.joint_count)]
        return [*gripper, "gripper.opening", *joints]

    @property
    def environment_state_names(self) -> list[str]:
        """A name for each number of ``observation.environment_state``."""
        parts = ("x", "y", "z", "qw", "qx", "qy", "qz", "held")
        return [f"{item.name}.{part}" for item in self.objects for part in parts]

    def affordances_for(self, action: str) -> tuple[Affordance, ...]:
        """Return the affordances of an action."""
        return tuple(item for item in self.affordances if item.action == action)
