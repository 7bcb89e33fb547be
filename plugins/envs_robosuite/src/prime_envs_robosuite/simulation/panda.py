"""Where robosuite's Panda is in a MuJoCo model, and what its gripper is doing."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

JOINT_NAMES = tuple(f"robot0_joint{number}" for number in range(1, 8))
GRIP_SITE = "gripper0_right_grip_site"
BASE_SITE = "robot0_right_center"
FINGER_JOINTS = ("gripper0_right_finger_joint1", "gripper0_right_finger_joint2")
FINGER_BODIES = ("gripper0_right_leftfinger", "gripper0_right_rightfinger")

# The grip site's axes at the neutral pose are a quarter turn about z from the gripper's:
# the gripper's x axis points forward and its fingers slide along y.
SITE_TO_GRIPPER = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])


@dataclass(frozen=True, eq=False)
class Panda:
    """Indices of the arm and the gripper in a model.

    Attributes:
        joint_addresses: Arm joints in ``qpos``, ``(7,)``.
        dof_addresses: Arm joints in ``qvel``, ``(7,)``.
        arm_actuators: In ``ctrl``, ``(7,)``.
        finger_addresses: Finger joints in ``qpos``, ``(2,)``.
        finger_actuators: In ``ctrl``, ``(2,)``.
        finger_geoms: All collision geoms of the left and of the right finger, not the pads
            alone: an object can be held by the upper part of a finger.
        grip_site: Index of the site between the fingertips.
        base_site: Index of the site of the frame that robosuite's actions are given in.
    """

    joint_addresses: Indices
    dof_addresses: Indices
    arm_actuators: Indices
    finger_addresses: Indices
    finger_actuators: Indices
    finger_geoms: tuple[frozenset[int], frozenset[int]]
    grip_site: int
    base_site: int

    @classmethod
    def find(cls, model: Any) -> "Panda":
        """Look the Panda up by robosuite's names.

        Args:
            model: A ``mujoco.MjModel`` made by robosuite with one Panda.
        """
        joints = [model.joint(name) for name in JOINT_NAMES]
        fingers = [model.joint(name) for name in FINGER_JOINTS]
        left, right = (_geoms_below(model, model.body(name).id) for name in FINGER_BODIES)
        return cls(
            joint_addresses=np.array([joint.qposadr[0] for joint in joints], dtype=np.int64),
            dof_addresses=np.array([joint.dofadr[0] for joint in joints], dtype=np.int64),
            arm_actuators=_actuators(model, [joint.id for joint in joints]),
            finger_addresses=np.array([joint.qposadr[0] for joint in fingers], dtype=np.int64),
            finger_actuators=_actuators(model, [joint.id for joint in fingers]),
            finger_geoms=(left, right),
            grip_site=model.site(GRIP_SITE).id,
            base_site=model.site(BASE_SITE).id,
        )

    def gripper_pose(self, data: Any) -> tuple[Array, Array]:
        """Return the gripper's position [m] ``(3,)`` and rotation ``(3, 3)``, world frame."""
        return data.site_xpos[self.grip_site].copy(), self.gripper_rotation(data)

    def gripper_rotation(self, data: Any) -> Array:
        """Return the gripper's rotation ``(3, 3)``, world frame."""
        rotation: Array = data.site_xmat[self.grip_site].reshape(3, 3) @ SITE_TO_GRIPPER
        return rotation

    def base_pose(self, data: Any) -> tuple[Array, Array]:
        """Return the base's position [m] ``(3,)`` and rotation ``(3, 3)``, world frame."""
        rotation = data.site_xmat[self.base_site].reshape(3, 3)
        return data.site_xpos[self.base_site].copy(), rotation.copy()

    def opening(self, data: Any) -> float:
        """Return the distance between the fingers [m]."""
        left, right = data.qpos[self.finger_addresses]
        return float(left - right)

    def touching(self, data: Any) -> tuple[set[int], set[int]]:
        """Return the geoms that touch the left and the right finger."""
        pairs = data.contact.geom[: data.ncon]
        left: set[int] = set()
        right: set[int] = set()
        for first, second in pairs.tolist():
            for own, other in ((first, second), (second, first)):
                if own in self.finger_geoms[0]:
                    left.add(other)
                elif own in self.finger_geoms[1]:
                    right.add(other)
        return left, right


def _geoms_below(model: Any, body: int) -> frozenset[int]:
    """Return the collision geoms of a body and of the bodies fixed to it."""
    bodies = {body}
    for index in range(body + 1, model.nbody):
        if model.body_parentid[index] in bodies:
            bodies.add(index)
    collides = (model.geom_contype != 0) | (model.geom_conaffinity != 0)
    return frozenset(
        index for index in np.flatnonzero(collides).tolist() if model.geom_bodyid[index] in bodies
    )


def _actuators(model: Any, joints: list[int]) -> Indices:
    """Return the actuators that drive joints, in their order."""
    driven = model.actuator_trnid[:, 0].tolist()
    return np.array([driven.index(joint) for joint in joints], dtype=np.int64)
