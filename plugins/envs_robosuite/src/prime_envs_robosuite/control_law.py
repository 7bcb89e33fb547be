"""One control step of robosuite's OSC_POSE law, compiled: 25 physics substeps, no Python.

The compiled function calls MuJoCo's own C functions at their addresses, passed as numbers.
That keeps it free of global callbacks (two threads can step at once), lets numba cache
the machine code on disk, and leaves no Python between two substeps.

Everything the function calls is in this file: numba looks at one file only to tell whether
a cached function is out of date.
"""

from typing import Any, NamedTuple

import numba
import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic
from numpy.typing import NDArray

POSITION_GAIN = 150.0  # kp of the default OSC_POSE controller; its damping is critical
NULLSPACE_GAIN = 10.0


class Functions(NamedTuple):
    """Addresses of MuJoCo's C functions and of the structures they work on.

    Attributes:
        step1: ``mj_step1``: positions, velocities, bias forces.
        step2: ``mj_step2``: forces, constraints, integration.
        full_mass: ``mj_fullM``.
        site_jacobian: ``mj_jacSite``.
        model: The ``mjModel``.
        data: The ``mjData``.
    """

    step1: int
    step2: int
    full_mass: int
    site_jacobian: int
    model: int
    data: int


class Views(NamedTuple):
    """Arrays that share memory with one ``MjData``, and scratch space.

    Attributes:
        positions: ``qpos``, ``(nq,)``.
        velocities: ``qvel``, ``(nv,)``.
        bias: ``qfrc_bias``, ``(nv,)``.
        controls: ``ctrl``, ``(nu,)``.
        packed_mass: ``qM``, MuJoCo's sparse joint-space inertia.
        site_position: Of the grip site [m], world frame, ``(3,)``.
        site_rotation: Of the grip site, row by row, ``(9,)``.
        mass: Scratch for the dense inertia, ``(nv, nv)``.
        linear: Scratch for the linear site Jacobian, ``(3, nv)``.
        angular: Scratch for the angular site Jacobian, ``(3, nv)``.
    """

    positions: NDArray[np.float64]
    velocities: NDArray[np.float64]
    bias: NDArray[np.float64]
    controls: NDArray[np.float64]
    packed_mass: NDArray[np.float64]
    site_position: NDArray[np.float64]
    site_rotation: NDArray[np.float64]
    mass: NDArray[np.float64]
    linear: NDArray[np.float64]
    angular: NDArray[np.float64]


class Arm(NamedTuple):
    """Where the arm is in the model's arrays; ``n`` joints.

    Attributes:
        joints: Addresses in ``qpos``, ``(n,)``.
        dofs: Addresses in ``qvel``, ``(n,)``.
        actuators: Indices in ``ctrl``, ``(n,)``.
        torque_low: Lower torque limits [N m], ``(n,)``.
        torque_high: Upper torque limits [N m], ``(n,)``.
        base_position: Of the frame that actions are given in [m], world frame, ``(3,)``.
        base_rotation: Of that frame, ``(3, 3)``.
        site: Index of the grip site.
    """

    joints: NDArray[np.int64]
    dofs: NDArray[np.int64]
    actuators: NDArray[np.int64]
    torque_low: NDArray[np.float64]
    torque_high: NDArray[np.float64]
    base_position: NDArray[np.float64]
    base_rotation: NDArray[np.float64]
    site: int


@intrinsic
def _c_call(typing_context: Any, address: Any, arguments: Any) -> Any:
    """Call the C function without result at an address, with integers or pointers."""
    signature = types.void(address, arguments)

    def build(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        kinds = signature.args[1]
        unpacked = cgutils.unpack_tuple(  # type: ignore[no-untyped-call]
            builder, values[1], len(kinds)
        )
        words = [context.get_value_type(kind) for kind in kinds]
        pointer = ir.FunctionType(ir.VoidType(), words).as_pointer()
        builder.call(builder.inttoptr(values[0], pointer), unpacked)
        return context.get_dummy_value()

    return signature, build


# numba passes the typing context itself.
_call: Any = _c_call


@numba.njit(nogil=True, cache=True)
def _product(left: Any, right: Any) -> Any:
    """Return ``left @ right``; a call of BLAS costs more than these few products."""
    result = np.empty((left.shape[0], right.shape[1]))
    for row in range(left.shape[0]):
        for column in range(right.shape[1]):
            total = 0.0
            for inner in range(left.shape[1]):
                total += left[row, inner] * right[inner, column]
            result[row, column] = total
    return result


@numba.njit(nogil=True, cache=True)
def _factor(matrix: Any) -> Any:
    """Return the lower Cholesky factor of a symmetric matrix, and whether it is positive."""
    size = matrix.shape[0]
    lower = np.zeros((size, size))
    for row in range(size):
        for column in range(row + 1):
            total = matrix[row, column]
            for inner in range(column):
                total -= lower[row, inner] * lower[column, inner]
            if row > column:
                lower[row, column] = total / lower[column, column]
            elif total > 0.0:
                lower[row, row] = np.sqrt(total)
            else:
                return lower, False
    return lower, True


@numba.njit(nogil=True, cache=True)
def _solve(matrix: Any, right: Any) -> Any:
    """Solve ``matrix @ x = right`` for a symmetric positive matrix, by Cholesky.

    robosuite takes pseudo-inverses by singular values, which cost more than the physics;
    they agree to rounding wherever the matrix is positive, and are used where it is not.
    """
    lower, positive = _factor(matrix)
    if not positive:
        return np.linalg.pinv(matrix) @ right
    size = matrix.shape[0]
    result = right.copy()
    for column in range(result.shape[1]):
        for row in range(size):
            total = result[row, column]
            for inner in range(row):
                total -= lower[row, inner] * result[inner, column]
            result[row, column] = total / lower[row, row]
        for row in range(size - 1, -1, -1):
            total = result[row, column]
            for inner in range(row + 1, size):
                total -= lower[inner, row] * result[inner, column]
            result[row, column] = total / lower[row, row]
    return result


@numba.njit(nogil=True, cache=True)
def _pose_error(goal_position: Any, goal_rotation: Any, views: Any) -> Any:
    """Return position error [m] and orientation error (as a rotation vector), ``(6,)``."""
    error = np.zeros(6)
    rotation = views.site_rotation
    for axis in range(3):
        error[axis] = goal_position[axis] - views.site_position[axis]
    for column in range(3):
        for axis in range(3):
            following, last = (axis + 1) % 3, (axis + 2) % 3
            error[3 + axis] += 0.5 * (
                rotation[3 * following + column] * goal_rotation[last, column]
                - rotation[3 * last + column] * goal_rotation[following, column]
            )
    return error


@numba.njit(nogil=True, cache=True)
def _torques(goal_position: Any, goal_rotation: Any, rest: Any, arm: Any, views: Any) -> Any:
    """Return the joint torques [N m] towards a goal pose in the world frame, ``(n, 1)``."""
    count = arm.dofs.shape[0]
    jacobian = np.empty((6, count))
    mass = np.empty((count, count))
    velocity = np.empty((count, 1))
    pull = np.empty((count, 1))
    for column in range(count):
        dof = arm.dofs[column]
        for axis in range(3):
            jacobian[axis, column] = views.linear[axis, dof]
            jacobian[3 + axis, column] = views.angular[axis, dof]
        for row in range(count):
            mass[row, column] = views.mass[arm.dofs[row], dof]
        velocity[column, 0] = views.velocities[dof]
        offset = rest[column] - views.positions[arm.joints[column]]
        pull[column, 0] = (
            NULLSPACE_GAIN * offset - 2.0 * np.sqrt(NULLSPACE_GAIN) * velocity[column, 0]
        )
    error = _pose_error(goal_position, goal_rotation, views)
    twist = _product(jacobian, velocity)
    demand = np.empty((6, 1))
    for axis in range(6):
        damping = 2.0 * np.sqrt(POSITION_GAIN)
        demand[axis, 0] = POSITION_GAIN * error[axis] - damping * twist[axis, 0]
    mobility = _product(jacobian, _solve(mass, jacobian.T))
    wrench = np.empty((6, 1))
    wrench[:3] = _solve(mobility[:3, :3], demand[:3])
    wrench[3:] = _solve(mobility[3:, 3:], demand[3:])
    # The nullspace projector applied to mass @ pull, without forming it.
    wrench -= _solve(mobility, _product(jacobian, pull))
    return _product(jacobian.T, wrench) + _product(mass, pull)


@numba.njit(nogil=True, cache=True)
def run_control_step(
    functions: Functions,
    views: Views,
    arm: Arm,
    shift: NDArray[np.float64],
    turn: NDArray[np.float64],
    rest: NDArray[np.float64],
    substeps: int,
) -> None:
    """Advance the simulation by one control step.

    Args:
        functions: C functions and structures.
        views: Arrays of the same ``MjData``.
        arm: Where the arm is in them.
        shift: Commanded displacement of the grip site [m], base frame, ``(3,)``.
        turn: Commanded rotation, multiplied from the left, base frame, ``(3, 3)``.
        rest: Joint positions that the nullspace torque pulls towards [rad], ``(n,)``.
        substeps: Number of physics steps.
    """
    model, data = functions.model, functions.data
    goal_position = np.zeros(3)
    goal_rotation = np.zeros((3, 3))
    base = arm.base_rotation
    for substep in range(substeps):
        _call(functions.step1, (model, data))
        if substep == 0:
            # The goal starts from the pose achieved by now, not from the previous goal.
            rotation = views.site_rotation.copy().reshape(3, 3)
            offset = views.site_position - arm.base_position
            goal_position[:] = arm.base_position + base @ (base.T.copy() @ offset + shift)
            goal_rotation[:] = base @ (turn @ (base.T.copy() @ rotation))
        _call(functions.full_mass, (model, views.mass.ctypes.data, views.packed_mass.ctypes.data))
        _call(
            functions.site_jacobian,
            (model, data, views.linear.ctypes.data, views.angular.ctypes.data, arm.site),
        )
        torque = _torques(goal_position, goal_rotation, rest, arm, views)
        for joint in range(arm.dofs.shape[0]):
            total = torque[joint, 0] + views.bias[arm.dofs[joint]]
            limited = min(max(total, arm.torque_low[joint]), arm.torque_high[joint])
            views.controls[arm.actuators[joint]] = limited
        _call(functions.step2, (model, data))
