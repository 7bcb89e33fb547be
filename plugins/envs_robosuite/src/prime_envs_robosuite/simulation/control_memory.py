"""The memory that the compiled control law works on: MuJoCo's own, and scratch space."""

import ctypes
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from prime_envs_robosuite.simulation.panda import Panda


class Functions(NamedTuple):
    """Addresses of MuJoCo's C functions and of the structures they work on.

    Attributes:
        step1: ``mj_step1``: positions, velocities, bias forces.
        step2: ``mj_step2``: forces, constraints, integration.
        model: The ``mjModel``.
        data: The ``mjData``.
    """

    step1: int
    step2: int
    model: int
    data: int


class Views(NamedTuple):
    """Arrays that share memory with one ``MjData``.

    Attributes:
        positions: ``qpos``, ``(nq,)``.
        velocities: ``qvel``, ``(nv,)``.
        bias: ``qfrc_bias``, ``(nv,)``.
        controls: ``ctrl``, ``(nu,)``.
        packed_mass: ``qM``, MuJoCo's sparse joint-space inertia.
        axes: ``cdof``, the joints' motion axes, angular then linear, ``(nv, 6)``.
        centre: Row of ``subtree_com`` that the arm's axes refer to [m], ``(3,)``.
        site_position: Of the grip site [m], world frame, ``(3,)``.
        site_rotation: Of the grip site, row by row, ``(9,)``.
    """

    positions: NDArray[np.float64]
    velocities: NDArray[np.float64]
    bias: NDArray[np.float64]
    controls: NDArray[np.float64]
    packed_mass: NDArray[np.float64]
    axes: NDArray[np.float64]
    centre: NDArray[np.float64]
    site_position: NDArray[np.float64]
    site_rotation: NDArray[np.float64]


class Arm(NamedTuple):
    """Where the arm and its gripper are in the model's arrays.

    Attributes:
        indices: Of each joint in ``qpos``, ``qvel`` and ``ctrl``, ``(7, 3)``.
        mass: Where the inertia between two joints is in ``qM``, ``(7, 7)``.
        torques: Lower and upper torque limit of each joint [N m], ``(7, 2)``.
        base_position: Of the frame that actions are given in [m], world frame, ``(3,)``.
        base_rotation: Of that frame, ``(3, 3)``.
        fingers: Of the left and the right finger in ``ctrl``, ``(2,)``.
        strokes: Least and greatest control of each finger [m], ``(2, 2)``.
    """

    indices: NDArray[np.int64]
    mass: NDArray[np.int64]
    torques: NDArray[np.float64]
    base_position: NDArray[np.float64]
    base_rotation: NDArray[np.float64]
    fingers: NDArray[np.int64]
    strokes: NDArray[np.float64]


class Scratch(NamedTuple):
    """Arrays that each substep fills anew; one allocation serves all substeps.

    Attributes:
        goal: Position [m] and, row by row, rotation of the goal, world frame, ``(12,)``.
        jacobian: Of the grip site, linear then angular, transposed, ``(7, 6)``.
        mobility: Inverse of the mass at the site, ``(6, 6)``.
        arm: Its mass [kg m^2] beside the transposed Jacobian, eliminated in place, ``(7, 13)``.
        site: Room to eliminate mobility, demand and what the pull would cause, ``(6, 8)``.
        turning: Room to eliminate its angular block and that part of the demand, ``(3, 4)``.
        torques: Of the joints [N m], ``(7,)``.
        wrench: Demanded accelerations, then force [N] and torque [N m] at the site, ``(6,)``.
        countered: Acceleration of the site that the pull to rest would cause, ``(6,)``.
    """

    goal: NDArray[np.float64]
    jacobian: NDArray[np.float64]
    mobility: NDArray[np.float64]
    arm: NDArray[np.float64]
    site: NDArray[np.float64]
    turning: NDArray[np.float64]
    torques: NDArray[np.float64]
    wrench: NDArray[np.float64]
    countered: NDArray[np.float64]


def find_functions(model: Any, data: Any) -> Functions:
    """Return the addresses of the C functions and structures."""
    library = ctypes.CDLL(str(_library_path()))
    addresses = [
        ctypes.cast(getattr(library, name), ctypes.c_void_p).value
        for name in ("mj_step1", "mj_step2")
    ]
    step1, step2 = (int(address or 0) for address in addresses)
    return Functions(step1, step2, int(model._address), int(data._address))


def _library_path() -> Path:
    """Return the C library that the mujoco package has loaded."""
    import mujoco

    folder = Path(mujoco.__file__).parent
    patterns = ("libmujoco.so*", "libmujoco*.dylib", "mujoco.dll")
    return next(path for pattern in patterns for path in sorted(folder.glob(pattern)))


def find_views(model: Any, data: Any, panda: Panda) -> Views:
    """Return the arrays that the control law reads and writes."""
    arm_body = model.dof_bodyid[panda.dof_addresses[0]]
    return Views(
        positions=data.qpos,
        velocities=data.qvel,
        bias=data.qfrc_bias,
        controls=data.ctrl,
        packed_mass=data.qM,
        axes=data.cdof,
        centre=data.subtree_com[model.body_rootid[arm_body]],
        site_position=data.site_xpos[panda.grip_site],
        site_rotation=data.site_xmat[panda.grip_site],
    )


def find_arm(model: Any, data: Any, panda: Panda) -> Arm:
    """Return where arm and gripper are in those arrays."""
    position, rotation = panda.base_pose(data)
    indices = (panda.joint_addresses, panda.dof_addresses, panda.arm_actuators)
    return Arm(
        indices=np.stack(indices, axis=1),
        mass=_mass_addresses(model, panda.dof_addresses.tolist()),
        torques=model.actuator_ctrlrange[panda.arm_actuators].copy(),
        base_position=position,
        base_rotation=rotation,
        fingers=panda.finger_actuators,
        strokes=model.actuator_ctrlrange[panda.finger_actuators].copy(),
    )


def _mass_addresses(model: Any, dofs: list[int]) -> NDArray[np.int64]:
    """Return where in ``qM`` the inertia between two joints of a chain is, ``(n, n)``.

    MuJoCo keeps, for each joint, its own inertia and then those between it and each joint that
    carries it, from the nearest to the base.
    """
    addresses = np.empty((len(dofs), len(dofs)), dtype=np.int64)
    for row, dof in enumerate(dofs):
        address, carrier = int(model.dof_Madr[dof]), dof
        while carrier >= 0:
            if carrier in dofs:
                column = dofs.index(carrier)
                addresses[row, column] = addresses[column, row] = address
            address, carrier = address + 1, int(model.dof_parentid[carrier])
    return addresses
