"""One physics simulation of a Panda task: exact states, resets, and what is in it now."""

import importlib.metadata
import math
from collections.abc import Sequence
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from prime_core.contracts.observations import (
    ENVIRONMENT_STATE_KEY,
    GRIPPER_WIDTH,
    OBJECT_WIDTH,
    STATE_KEY,
    Observations,
)
from prime_core.errors import PrimeError
from prime_envs_robosuite.simulation.object_geoms import Geoms
from prime_envs_robosuite.simulation.objects import ObjectMotion, Starts
from prime_envs_robosuite.simulation.panda import Panda
from prime_envs_robosuite.simulation.physics_model import physics_model, show_physics
from prime_envs_robosuite.simulation.stepping import (
    CompiledStepper,
    Stepper,
    Stepping,
    StockStepper,
    check_control_law,
)

Array = NDArray[np.float64]

PLACEMENT_DRAWS = 1000
GREATEST_OVERLAP = 0.001  # what stands on something may be that deep in it at the start [m]


class Simulation:
    """A MuJoCo model and data, and the stepper that moves them.

    Args:
        host: The robosuite environment that the model comes from.
        body_names: The objects' names in robosuite.
        starts: Draws where they start, in the same order.
        stepping: ``"compiled"``, or ``"stock"`` for robosuite's own step.
        geoms: Of objects that are to have other shapes, with compiled stepping.

    Attributes:
        host: The robosuite environment.
        model: The ``mujoco.MjModel``.
        data: Its ``mujoco.MjData``.
        panda: Where the robot is in them.
        stepper: Advances them.
        object_bodies: Names of the objects' bodies, in the scene's order.
    """

    def __init__(
        self,
        host: Any,
        body_names: Sequence[str],
        starts: Starts,
        stepping: Stepping,
        geoms: Geoms = MappingProxyType({}),
    ) -> None:
        import mujoco

        self.host = host
        self.model: Any
        self.data: Any
        self.stepper: Stepper
        if stepping == "compiled":
            check_control_law(importlib.metadata.version("robosuite"))
            self.model = physics_model(self.host, geoms)
            self.data = mujoco.MjData(self.model)
            show_physics(self.host, self.model, self.data)
        else:
            self.model = self.host.sim.model._model
            self.data = self.host.sim.data._data
        mujoco.mj_forward(self.model, self.data)
        self.panda = Panda.find(self.model)
        if stepping == "compiled":
            self.stepper = CompiledStepper(self.model, self.data, self.panda)
        else:
            self.stepper = StockStepper(self.host)
        self._starts = starts
        roots = {item.name: item.root_body for item in self.host.model.mujoco_objects}
        self.object_bodies = [roots[name] for name in body_names]
        bodies = [self.model.body(name) for name in self.object_bodies]
        self._bodies = np.array([body.id for body in bodies])
        joints = [self.model.joint(int(body.jntadr[0])) for body in bodies]
        self._object_addresses = [int(joint.qposadr[0]) for joint in joints]
        self._object_dofs = [int(joint.dofadr[0]) for joint in joints]
        self._integration = int(mujoco.mjtState.mjSTATE_INTEGRATION)
        self._physics_size = mujoco.mj_stateSize(self.model, self._integration)

    @property
    def state_size(self) -> int:
        """Length of a state."""
        return int(self._physics_size) + 1 + len(self.panda.joint_addresses)

    def get_state(self) -> Array:
        """Return MuJoCo's integration state, the gripper's command and the rest posture."""
        import mujoco

        state = np.empty(self.state_size)
        physics = state[: self._physics_size]
        mujoco.mj_getState(self.model, self.data, physics, self._integration)
        state[self._physics_size] = self.stepper.gripper_command
        state[self._physics_size + 1 :] = self.stepper.rest
        return state

    def set_state(self, state: Array) -> None:
        """Restore what `get_state` returned, ``(state_size,)``."""
        import mujoco

        physics = np.ascontiguousarray(state[: self._physics_size])
        mujoco.mj_setState(self.model, self.data, physics, self._integration)
        self.stepper.gripper_command = float(state[self._physics_size])
        self.stepper.rest = np.array(state[self._physics_size + 1 :])
        self.refresh()

    def reset(self, rng: np.random.Generator) -> None:
        """Draw the start of an episode: the arm's joints, then each object's place and yaw.

        Args:
            rng: Where all draws come from.
        """
        import mujoco

        mujoco.mj_resetData(self.model, self.data)
        robot = self.host.robots[0]
        noise = rng.standard_normal(len(robot.init_qpos)) * robot.initialization_noise["magnitude"]
        positions = self.data.qpos
        positions[self.panda.joint_addresses] = robot.init_qpos + noise
        positions[self.panda.finger_addresses] = robot.gripper["right"].init_qpos
        for _ in range(PLACEMENT_DRAWS):
            poses = self._starts(rng)
            for pose, address in zip(poses, self._object_addresses, strict=True):
                positions[address : address + 7] = pose
            if not self._objects_overlap():
                break
        else:
            raise PrimeError(
                f"no start with all objects apart was found in {PLACEMENT_DRAWS} draws: the task's "
                "placements overlap, or lie in furniture"
            )
        self._restart_controller(0.0)

    def _objects_overlap(self) -> bool:
        """Whether an object is inside another one, furniture or the arm."""
        self.refresh()
        contacts = self.data.contact
        owners = self.model.geom_bodyid[contacts.geom[: self.data.ncon]]
        deep = contacts.dist[: self.data.ncon] < -GREATEST_OVERLAP
        return bool(np.isin(owners[deep], self._bodies).any())

    def set_joint_state(
        self, positions: Array, velocities: Array, gripper_command: float | None = None
    ) -> None:
        """Put all joints where they are told to be and start the controller afresh.

        Args:
            positions: ``qpos`` in the model's order, ``(nq,)``.
            velocities: ``qvel``, ``(nv,)``.
            gripper_command: In [-1, 1]; None for the one that holds the fingers where they
                are, which does not press on an object between them.

        Raises:
            PrimeError: If the lengths are not the model's.
        """
        import mujoco

        expected = (self.model.nq, self.model.nv)
        given = (np.shape(positions), np.shape(velocities))
        if given != ((expected[0],), (expected[1],)):
            raise PrimeError(
                f"a joint state of this model has {expected[0]} positions and {expected[1]} "
                f"velocities; the shapes given are {given[0]} and {given[1]}"
            )
        mujoco.mj_resetData(self.model, self.data)
        self.data.qpos[:] = positions
        self.data.qvel[:] = velocities
        if gripper_command is None:
            low, high = self.model.actuator_ctrlrange[self.panda.finger_actuators[0]]
            share = (self.data.qpos[self.panda.finger_addresses[0]] - low) / (high - low)
            gripper_command = float(np.clip(1.0 - 2.0 * share, -1.0, 1.0))
        self._restart_controller(gripper_command)

    def _restart_controller(self, gripper_command: float) -> None:
        import mujoco

        self.stepper.rest = self.data.qpos[self.panda.joint_addresses].copy()
        self.stepper.gripper_command = gripper_command
        mujoco.mj_forward(self.model, self.data)

    def refresh(self) -> None:
        """Bring poses and contacts up to the present joints; leaves the state alone.

        After a step they lag a substep behind, up to 2 mm.
        """
        import mujoco

        mujoco.mj_kinematics(self.model, self.data)
        mujoco.mj_collision(self.model, self.data)

    def object_poses(self) -> tuple[Array, Array]:
        """Return the objects' positions [m] ``(k, 3)`` and quaternions ``(k, 4)``."""
        return self.data.xpos[self._bodies].copy(), self.data.xquat[self._bodies].copy()

    def positions_at(self, seen: Observations) -> Array:
        """Return the joints at stored instants: ``qpos`` in the model's order, ``(N, nq)``.

        Both fingers are taken to be half the opening from the middle. The simulation's own
        state is left alone.

        Raises:
            PrimeError: If object poses are not known, or the robot or the objects are others.
        """
        if seen.environment_state is None:
            raise PrimeError(
                f"object poses are not known in these observations ({ENVIRONMENT_STATE_KEY} is "
                "missing): a picture of a stored instant needs them"
            )
        joints, objects = self.panda.joint_addresses, self._object_addresses
        widths = (GRIPPER_WIDTH + len(joints), OBJECT_WIDTH * len(objects))
        given = (seen.state.shape[1], seen.environment_state.shape[1])
        if given != widths:
            raise PrimeError(
                f"these observations are of another robot or of other objects: {STATE_KEY} and "
                f"{ENVIRONMENT_STATE_KEY} have {given[0]} and {given[1]} numbers, here they have "
                f"{widths[0]} and {widths[1]}"
            )
        positions = np.zeros((len(seen), self.model.nq))
        positions[:, joints] = seen.joint_positions
        positions[:, self.panda.finger_addresses] = seen.gripper_opening[:, None] * [0.5, -0.5]
        for index, address in enumerate(objects):
            positions[:, address : address + 3] = seen.object_positions[:, index]
            positions[:, address + 3 : address + 7] = seen.object_quaternions[:, index]
        return positions

    def motions(self) -> list[ObjectMotion]:
        """Return how each object moves."""
        velocities = [self.data.qvel[dof : dof + 6].tolist() for dof in self._object_dofs]
        return [ObjectMotion(math.hypot(*item[:3]), math.hypot(*item[3:])) for item in velocities]

    def touches(self) -> list[tuple[bool, bool]]:
        """Return for each object whether the left and the right finger touch it."""
        left, right = self.panda.touching(self.data)
        owners = self.model.geom_bodyid
        sides = [{int(owners[geom]) for geom in side} for side in (left, right)]
        return [(body in sides[0], body in sides[1]) for body in self._bodies.tolist()]
