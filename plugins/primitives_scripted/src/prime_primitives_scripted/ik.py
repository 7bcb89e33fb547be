"""Inverse kinematics with limits: the only module that imports mink.

A differential step solves, for the change of joint positions dq,

    minimise  |W (J dq - e)|^2 + cost dq' M dq   subject to   G dq <= h

where e is the error of the gripper's pose (6,), J its Jacobian (6, J), and G, h hold the
joint position, joint velocity and collision limits. M is the arm's inertia: of the ways to
move the gripper the arm then takes the one that an operational-space controller takes, which
also moves light joints rather than heavy ones. Every solve starts cold from the joints
it is given, so that results do not depend on what was solved before.
"""

from typing import Any

import mink
import mujoco
import numpy as np
from numpy.typing import NDArray

from prime_core.affordances.goals import offset
from prime_core.contracts.description import RobotDescription
from prime_core.errors import PrimeError
from prime_core.rotations import gripper_down, yaw_of
from prime_primitives_scripted.clearance import Clearance
from prime_primitives_scripted.elbow import Elbow

Array = NDArray[np.float64]

SHOULDER, WRIST = 1, -2  # joints whose distance is the arm's length, in a serial arm
SOLVER = "daqp"
DAMPING = 1e-6
INERTIA_COST = 1e-3  # [m^2/J]
ORIENTATION_COST = 2.0  # [m/rad]; the arm keeps the hand upright, so position has to give way
TRACKING_TIME = 0.17  # [s] in which a compliant arm follows a command, for velocity limits
CLEARANCE = 0.002  # [m] to keep between hand and furniture
NOTICE_DISTANCE = 0.05  # [m] from which furniture counts
LIMIT_GAIN = 0.5  # share of the way to a limit in TRACKING_TIME: the arm has momentum
FREE_ANGLE = 0.3  # [rad] from a limit, where a step may be made without solving
SLACK = 0.1  # [rad] to keep from the margins at the end of a motion
SOLVE_STEPS = 40
IDLE_STEPS = 6  # without getting a tenth nearer, after which it is given up
PRECISION = 1e-3  # [m]
ERROR_WEIGHTS = np.array([1.0, 1.0, 1.0, 0.1, 0.1, 0.1])  # [1, m/rad]


class InverseKinematics:
    """Solves for joint positions of one arm; not to be shared between threads.

    Args:
        robot: The arm.
        joint_margin: Distance to keep from the joints' limits [rad]. A stretched elbow
            locks an operational-space controller, so it must not be zero.

    Raises:
        PrimeError: If the robot's model has other joints than the arm's.
    """

    def __init__(self, robot: RobotDescription, joint_margin: float = 0.1) -> None:
        self._model = mujoco.MjModel.from_xml_string(robot.mjcf)
        self._order = _joint_order(self._model, robot)
        self._site = self._model.site(robot.end_effector).id
        self._configuration = mink.Configuration(self._model)
        self._elbow = self._find_elbow()
        if self._elbow is not None:
            self._model.jnt_range[:] = self._elbow.narrow(self._model.jnt_range)
        ranges = np.where(self._model.jnt_limited[:, None] > 0, self._model.jnt_range, [-1e3, 1e3])
        self._low = ranges[:, 0] + joint_margin
        self._high = ranges[:, 1] - joint_margin
        self._task = mink.FrameTask(robot.end_effector, "site", 1.0, ORIENTATION_COST)
        inertia = mink.KineticEnergyRegularizationTask(INERTIA_COST)
        inertia.set_dt(1.0)
        self._tasks = [self._task, inertia]
        self._limits: list[Any] = [mink.ConfigurationLimit(self._model, LIMIT_GAIN, joint_margin)]
        if robot.joint_velocity_limits:
            speeds = dict(zip(robot.joint_names, robot.joint_velocity_limits, strict=True))
            self._limits.append(mink.VelocityLimit(self._model, speeds))
        hand, furniture = (
            [int(self._model.geom(name).id) for name in names]
            for names in (robot.hand_geoms, robot.furniture_geoms)
        )
        data = self._configuration.data
        self._clearance = Clearance(self._model, data, hand, furniture)
        self._collision_limit = mink.CollisionAvoidanceLimit(
            self._model,
            [(hand, furniture)],
            minimum_distance_from_collisions=CLEARANCE,
            collision_detection_distance=NOTICE_DISTANCE,
        )

    def is_locked(self, joints: Array) -> bool:
        """Whether the arm is stretched beyond where it can be pulled in again.

        Args:
            joints: Joint positions [rad], ``(J,)``.
        """
        if self._elbow is None:
            return False
        ordered = np.empty(self._model.nq)
        ordered[self._order] = joints
        return self._elbow.is_locked(ordered)

    def forward(self, joints: Array) -> Array:
        """Return the goal ``(4,)`` that joint positions ``(J,)`` [rad] put the gripper at."""
        self._configuration.update(self._inside(joints))
        return self._gripper_goal()

    def step(self, joints: Array, move: Array) -> Array:
        """Return the part of a move that the arm should make from its joints.

        Args:
            joints: Joint positions [rad], ``(J,)``.
            move: x, y, z [m] and yaw [rad] of the gripper, ``(4,)``; a few centimetres.

        Returns:
            ``(4,)``.
        """
        data = self._configuration.data
        data.qpos[self._order] = joints
        mujoco.mj_kinematics(self._model, data)
        here = self._gripper_goal()
        if self._elbow is not None:
            arm = data.xanchor[WRIST] - data.xanchor[SHOULDER]
            move = self._elbow.braked(move, arm)
        clear = self._clearance.allows(data, move, CLEARANCE)
        if clear and self.room(joints) > FREE_ANGLE:
            return move
        self._configuration.update(self._inside(joints))
        self._aim(here + move)
        self._advance(avoid_collisions=not clear)
        return offset(self._gripper_goal(), here)

    def solve(self, joints: Array, goal: Array) -> Array | None:
        """Return joint positions that put the gripper at a goal, within all limits.

        Args:
            joints: Where to start from [rad], ``(J,)``.
            goal: x, y, z [m] and yaw [rad], ``(4,)``.

        Returns:
            Joint positions [rad], ``(J,)``, or None if none are found. Next to a limit counts
            as not found: the arm's own controller may miss the way along it.
        """
        self._configuration.update(self._inside(joints))
        self._aim(goal)
        best, idle = np.inf, 0
        for _ in range(SOLVE_STEPS):
            error = self._task.compute_error(self._configuration)
            left = float(np.linalg.norm(error * ERROR_WEIGHTS))
            if left < PRECISION:
                joints = np.array(self._configuration.q[self._order])
                return joints if self.room(joints) > SLACK and self._is_clear() else None
            idle = 0 if left < 0.9 * best else idle + 1
            if idle == IDLE_STEPS:
                return None
            best = min(best, left)
            # The goal says where the hand ends up; whether it is clear there is asked then.
            self._advance(avoid_collisions=False)
        return None

    def room(self, joints: Array) -> float:
        """Return the distance of the nearest joint from its margin [rad]; below 0 beyond it."""
        low, high = self._low[self._order], self._high[self._order]
        return float(np.minimum(joints - low, high - joints).min())

    def _is_clear(self) -> bool:
        """Whether the hand is outside of all furniture."""
        return self._clearance.exceeds(self._configuration.data, -CLEARANCE)

    def _find_elbow(self) -> Elbow | None:
        """Return the elbow of an arm whose joints all have limits."""
        model, data = self._model, self._configuration.data
        if model.njnt < SHOULDER + 1 - WRIST or not np.all(model.jnt_limited):
            return None

        def length(joints: Array) -> float:
            data.qpos[:] = joints
            mujoco.mj_kinematics(model, data)
            return float(np.linalg.norm(data.xanchor[WRIST] - data.xanchor[SHOULDER]))

        return Elbow.find(model.jnt_range, length)

    def _inside(self, joints: Array) -> Array:
        """Return model positions within the margins: from there, standing still is feasible."""
        positions = np.empty(self._model.nq)
        positions[self._order] = joints
        return np.clip(positions, self._low, self._high)

    def _aim(self, goal: Array) -> None:
        pose = mink.SE3(wxyz_xyz=np.concatenate((gripper_down(goal[3]), goal[:3])))
        self._task.set_target(pose)

    def _advance(self, *, avoid_collisions: bool) -> None:
        limits = [*self._limits, self._collision_limit] if avoid_collisions else self._limits
        try:
            velocity = self._velocity(limits)
        except mink.NoSolutionFound:
            # A hand that was pushed into furniture cannot get out of it within a step's joint
            # velocities; heading for the goal without the collision limit leads away from it.
            velocity = self._velocity(self._limits)
        self._configuration.integrate_inplace(velocity, TRACKING_TIME)

    def _velocity(self, limits: list[Any]) -> Array:
        velocity: Array = mink.solve_ik(
            self._configuration, self._tasks, TRACKING_TIME, SOLVER, DAMPING, limits=limits
        )
        return velocity

    def _gripper_goal(self) -> Array:
        data = self._configuration.data
        quaternion = np.empty(4)
        mujoco.mju_mat2Quat(quaternion, data.site_xmat[self._site])
        return np.append(data.site_xpos[self._site], yaw_of(quaternion))


def _joint_order(model: mujoco.MjModel, robot: RobotDescription) -> NDArray[np.int64]:
    """Return where the arm's joints are in the model's positions, ``(J,)``."""
    names = {model.joint(index).name for index in range(model.njnt)}
    if names != set(robot.joint_names) or model.nq != len(robot.joint_names):
        raise PrimeError(
            f"a robot's model must have the joints {', '.join(robot.joint_names)} and no other; "
            f"it has {', '.join(sorted(names)) or 'none'}"
        )
    addresses = [int(model.joint(name).qposadr[0]) for name in robot.joint_names]
    return np.array(addresses, dtype=np.int64)
