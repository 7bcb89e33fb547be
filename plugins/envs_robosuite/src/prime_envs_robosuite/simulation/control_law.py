"""One control step of robosuite's OSC_POSE law, compiled: 25 physics substeps, no Python.

The compiled function calls MuJoCo's own C functions at their addresses, passed as numbers.
That keeps it free of global callbacks (two threads can step at once), lets numba cache
the machine code on disk, and leaves no Python between two substeps.

Every compiled function is in this file: numba looks at one file only to tell whether a cached
function is out of date. Only functions with one signature are cached: numba's index of several is
not locked, and processes that start on an empty cache could mix up their machine code. Sums run
over the last axis of small arrays wherever they can, so that the compiler adds several at once
without changing the order of any sum.
"""

from typing import Any

import numba
import numpy as np
from numpy.typing import NDArray

from prime_envs_robosuite.simulation.c_call import call
from prime_envs_robosuite.simulation.control_memory import Arm, Functions, Scratch, Views
from prime_envs_robosuite.simulation.osc_scales import GRIPPER_SPEED, POSITION_SCALE, ROTATION_SCALE

POSITION_GAIN = 150.0  # kp of the default OSC_POSE controller
DAMPING = 2.0 * np.sqrt(POSITION_GAIN)  # critical
NULLSPACE_GAIN = 10.0
NULLSPACE_DAMPING = 2.0 * np.sqrt(NULLSPACE_GAIN)
JOINTS = 7  # of the arm; a constant, so that loops over them are unrolled

_compiled = numba.njit(nogil=True, cache=True, error_model="numpy")
_inlined = numba.njit(nogil=True, error_model="numpy", forceinline=True)


def _elimination(rows: int, columns: int) -> Any:
    """Return a function that eliminates below the diagonal of a symmetric matrix.

    Args:
        rows: Of the matrix.
        columns: Of the matrix and the right sides that stand beside it. Loops over constant
            numbers of columns become a few vector instructions.

    Returns:
        Takes a table ``(rows, columns)``, which becomes the upper Cholesky factor, its diagonal
        inverted, and the inverse of the lower one times the right sides; returns whether the
        matrix is positive.
    """

    @_inlined
    def eliminate(table: Any) -> bool:
        for pivot in range(rows):
            square = table[pivot, pivot]
            if not square > 0.0:
                return False
            scale = 1.0 / np.sqrt(square)
            for column in range(columns):
                table[pivot, column] *= scale
            for row in range(pivot + 1, rows):
                share = table[pivot, row]
                for column in range(columns):
                    table[row, column] -= share * table[pivot, column]
            table[pivot, pivot] = scale
        return True

    return eliminate


_eliminate_arm = _elimination(JOINTS, JOINTS + 6)
_eliminate_site = _elimination(6, 8)
_eliminate_turning = _elimination(3, 4)


@_inlined
def _substitute(table: Any, rows: int, column: int, solution: Any) -> None:
    """Write the solution for one right side of an eliminated table; see `_elimination`."""
    for row in range(rows - 1, -1, -1):
        total = table[row, column]
        for inner in range(row + 1, rows):
            total -= table[row, inner] * solution[inner]
        solution[row] = total * table[row, row]


@_inlined
def _read_arm(rest: Any, arm: Any, views: Any, scratch: Any) -> None:
    """Fill mass and Jacobian, torques that pull to rest, the site's twist and what they cause."""
    offset_x = views.site_position[0] - views.centre[0]
    offset_y = views.site_position[1] - views.centre[1]
    offset_z = views.site_position[2] - views.centre[2]
    twist, countered, torques = scratch.wrench, scratch.countered, scratch.torques
    twist[:] = 0.0
    countered[:] = 0.0
    for joint in range(JOINTS):
        torques[joint] = views.bias[arm.indices[joint, 1]]
    for joint in range(JOINTS):
        position, dof = arm.indices[joint, 0], arm.indices[joint, 1]
        x, y, z = views.axes[dof, 0], views.axes[dof, 1], views.axes[dof, 2]
        row = scratch.jacobian[joint]
        row[0] = views.axes[dof, 3] + y * offset_z - z * offset_y
        row[1] = views.axes[dof, 4] + z * offset_x - x * offset_z
        row[2] = views.axes[dof, 5] + x * offset_y - y * offset_x
        row[3], row[4], row[5] = x, y, z
        speed = views.velocities[dof]
        away = rest[joint] - views.positions[position]
        pull = NULLSPACE_GAIN * away - NULLSPACE_DAMPING * speed
        for axis in range(6):
            twist[axis] += row[axis] * speed
            countered[axis] += row[axis] * pull
        for other in range(JOINTS):
            inertia = views.packed_mass[arm.mass[joint, other]]
            scratch.arm[joint, other] = inertia
            torques[other] += inertia * pull
        for axis in range(6):
            scratch.arm[joint, JOINTS + axis] = row[axis]


@_inlined
def _demand_accelerations(views: Any, scratch: Any) -> None:
    """Turn the site's twist into the accelerations that the law demands of it."""
    demand, goal, rotation = scratch.wrench, scratch.goal, views.site_rotation
    for axis in range(3):
        error = goal[axis] - views.site_position[axis]
        demand[axis] = POSITION_GAIN * error - DAMPING * demand[axis]
    for axis in range(3):
        following, last = (axis + 1) % 3, (axis + 2) % 3
        error = 0.0
        for column in range(3):
            error += 0.5 * (
                rotation[3 * following + column] * goal[3 + 3 * last + column]
                - rotation[3 * last + column] * goal[3 + 3 * following + column]
            )
        demand[3 + axis] = POSITION_GAIN * error - DAMPING * demand[3 + axis]


@_inlined
def _find_mobility(scratch: Any) -> bool:
    """Fill the inverse of the mass at the site; False if the arm's mass is not positive."""
    table, mobility = scratch.arm, scratch.mobility
    if not _eliminate_arm(table):
        return False
    for first in range(6):
        for second in range(first + 1):
            total = 0.0
            for row in range(JOINTS):
                total += table[row, JOINTS + first] * table[row, JOINTS + second]
            mobility[first, second] = mobility[second, first] = total
    return True


@_inlined
def _solve_wrench(scratch: Any) -> bool:
    """Turn demanded accelerations into the wrench that causes them, less what the pull does.

    Returns:
        Whether the mobility is positive; else nothing is changed.
    """
    wrench, countered, mobility = scratch.wrench, scratch.countered, scratch.mobility
    site, turning = scratch.site, scratch.turning
    for row in range(6):
        for column in range(6):
            site[row, column] = mobility[row, column]
        site[row, 6] = wrench[row]
        site[row, 7] = countered[row]
    for row in range(3):
        for column in range(3):
            turning[row, column] = mobility[3 + row, 3 + column]
        turning[row, 3] = wrench[3 + row]
    if not (_eliminate_site(site) and _eliminate_turning(turning)):
        return False
    # The factor of the linear block is the first part of the whole one's.
    _substitute(site, 3, 6, wrench)
    _substitute(turning, 3, 3, wrench[3:])
    _substitute(site, 6, 7, countered)
    for axis in range(6):
        wrench[axis] -= countered[axis]
    return True


@_compiled
def _solve_singular(packed: Any, places: Any, jacobian: Any, wrench: Any, countered: Any) -> None:
    """Do what `_find_mobility` and `_solve_wrench` do, by pseudo-inverses, as robosuite does.

    Those cost more than the physics; they agree to rounding wherever a matrix is positive.
    """
    mass = np.empty((JOINTS, JOINTS))
    for row in range(JOINTS):
        for column in range(JOINTS):
            mass[row, column] = packed[places[row, column]]
    mobility = jacobian.T.copy() @ (np.linalg.pinv(mass) @ jacobian)
    for block in (slice(0, 3), slice(3, 6)):
        wrench[block] = np.linalg.pinv(mobility[block, block].copy()) @ wrench[block].copy()
    wrench -= np.linalg.pinv(mobility) @ countered


@_inlined
def _command_arm(rest: Any, arm: Any, views: Any, scratch: Any) -> None:
    """Set the arm's torques for one substep."""
    _read_arm(rest, arm, views, scratch)
    _demand_accelerations(views, scratch)
    if not (_find_mobility(scratch) and _solve_wrench(scratch)):
        _solve_singular(
            views.packed_mass, arm.mass, scratch.jacobian, scratch.wrench, scratch.countered
        )
    for joint in range(JOINTS):
        torque = scratch.torques[joint]
        # The nullspace projector applied to the pull's torques, without forming it.
        for axis in range(6):
            torque += scratch.jacobian[joint, axis] * scratch.wrench[axis]
        limited = min(max(torque, arm.torques[joint, 0]), arm.torques[joint, 1])
        views.controls[arm.indices[joint, 2]] = limited


@_inlined
def _turn_of(vector: Any) -> Any:
    """Return the matrix ``(3, 3)`` of a rotation vector [rad], rounded as robosuite rounds it.

    robosuite makes a quaternion and casts it to float32 on the way: without that its goals are
    missed by 1e-9 rad.
    """
    angle = np.sqrt(vector[0] ** 2 + vector[1] ** 2 + vector[2] ** 2)
    scaled = np.zeros(4, dtype=np.float32)
    if angle == 0.0:
        scaled[0] = 1.0
    else:
        scaled[0] = np.cos(angle / 2.0)
        for axis in range(3):
            scaled[1 + axis] = vector[axis] / angle * np.sin(angle / 2.0)
    squared = np.dot(scaled, scaled)
    scaled *= np.sqrt(2.0 / squared)
    products = np.outer(scaled, scaled)
    turn = np.empty((3, 3))
    for axis in range(3):
        following, last = (axis + 1) % 3, (axis + 2) % 3
        lower, upper = 1 + min(following, last), 1 + max(following, last)
        turn[axis, axis] = 1.0 - products[lower, lower] - products[upper, upper]
        turn[axis, following] = products[1 + axis, 1 + following] - products[1 + last, 0]
        turn[axis, last] = products[1 + axis, 1 + last] + products[1 + following, 0]
    return turn


@_inlined
def _set_goal(action: Any, arm: Any, views: Any, goal: Any) -> None:
    """Write the goal: from the pose achieved by now, not from the previous goal."""
    base = arm.base_rotation
    inverse = base.T.copy()
    rotation = views.site_rotation.copy().reshape(3, 3)
    offset = views.site_position - arm.base_position
    turn = _turn_of(action[3:6] * ROTATION_SCALE)
    goal[:3] = arm.base_position + base @ (inverse @ offset + action[:3] * POSITION_SCALE)
    goal[3:] = (base @ (turn @ (inverse @ rotation))).ravel()


@_inlined
def _command_fingers(gripper: float, arm: Any, views: Any) -> None:
    """Set the fingers' controls; they move against each other."""
    for finger in range(2):
        low, high = arm.strokes[finger, 0], arm.strokes[finger, 1]
        share = gripper if finger == 1 else -gripper
        target = 0.5 * (high + low) + 0.5 * (high - low) * share
        views.controls[arm.fingers[finger]] = min(max(target, low), high)


@_compiled
def run_control_step(
    functions: Functions,
    views: Views,
    arm: Arm,
    action: NDArray[np.float64],
    gripper: float,
    rest: NDArray[np.float64],
    substeps: int,
) -> float:
    """Advance the simulation by one control step.

    Args:
        functions: C functions and structures.
        views: Arrays of the same ``MjData``.
        arm: Where arm and gripper are in them.
        action: Displacement, rotation vector (both in the base frame) and gripper as shares of
            the greatest ones; clipped to [-1, 1], ``(7,)``.
        gripper: What the gripper's commands have added up to, in [-1, 1].
        rest: Joint positions that the nullspace torque pulls towards [rad], ``(7,)``.
        substeps: Number of physics steps.

    Returns:
        What the gripper's commands have added up to now.
    """
    arm_shape, site_shape = (JOINTS, JOINTS + 6), (6, 8)
    jacobian, torques = np.empty((JOINTS, 6)), np.empty(JOINTS)
    tables = np.empty((6, 6)), np.empty(arm_shape), np.empty(site_shape), np.empty((3, 4))
    scratch = Scratch(np.empty(12), jacobian, *tables, torques, np.empty(6), np.empty(6))
    clipped = np.minimum(np.maximum(action, -1.0), 1.0)
    gripper = min(max(gripper + GRIPPER_SPEED * np.sign(clipped[6]), -1.0), 1.0)
    _command_fingers(gripper, arm, views)
    for substep in range(substeps):
        call(functions.step1, (functions.model, functions.data))
        if substep == 0:
            _set_goal(clipped, arm, views, scratch.goal)
        _command_arm(rest, arm, views, scratch)
        call(functions.step2, (functions.model, functions.data))
    return gripper
