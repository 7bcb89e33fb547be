"""Two ways to advance robosuite's Panda by one control step, with one face.

Both take robosuite's own 7-number action at 20 Hz and leave the same state to rounding.
"""

from typing import Any, Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from prime_core.errors import PrimeError
from prime_envs_robosuite.simulation.control_memory import find_arm, find_functions, find_views
from prime_envs_robosuite.simulation.panda import Panda

Array = NDArray[np.float64]

Stepping = Literal["compiled", "stock"]

SUBSTEPS = 25  # of 2 ms, in a control step of 50 ms
COMPARED_VERSIONS = ("1.5.1",)  # of robosuite, with the compiled control law


class Stepper(Protocol):
    """Advances one simulation; holds what the control law remembers between steps.

    Attributes:
        gripper_command: What the gripper's commands have added up to, in [-1, 1]; -1 is
            open.
        rest: Joint positions that the nullspace torque pulls towards [rad], ``(7,)``.
    """

    gripper_command: float
    rest: Array

    def step(self, action: Array) -> None:
        """Advance by one control step.

        Args:
            action: ``(7,)`` in [-1, 1]: displacement, rotation vector (both in the base
                frame, scaled by 0.05 m and 0.5 rad), gripper (below 0 opens, above closes).
        """


class CompiledStepper:
    """Steps a plain MuJoCo model with the compiled control law.

    It holds addresses inside the model and its data: it keeps both alive, and must be made
    anew for other ones.

    Args:
        model: The ``mujoco.MjModel``.
        data: Its ``mujoco.MjData``.
        panda: Where the arm and gripper are in them.
    """

    def __init__(self, model: Any, data: Any, panda: Panda) -> None:
        # numba takes a second to import: only where it is used.
        from prime_envs_robosuite.simulation.control_law import run_control_step

        self.gripper_command = 0.0
        self.rest: Array = np.zeros(len(panda.joint_addresses))
        self._owners = (model, data)
        self._run = run_control_step
        self._functions = find_functions(model, data)
        self._views = find_views(model, data, panda)
        self._arm = find_arm(model, data, panda)

    def step(self, action: Array) -> None:
        """Advance by one control step; see `Stepper`."""
        self.gripper_command = self._run(
            self._functions,
            self._views,
            self._arm,
            action,
            self.gripper_command,
            self.rest,
            SUBSTEPS,
        )


class StockStepper:
    """Steps a robosuite environment by its own ``step``.

    Args:
        host: The robosuite environment, with one Panda and ``ignore_done``.
    """

    def __init__(self, host: Any) -> None:
        self._host = host
        robot = host.robots[0]
        self._gripper = robot.gripper["right"]
        self._controllers = tuple(robot.part_controllers.values())
        self._arm_controller = robot.part_controllers["right"]

    @property
    def gripper_command(self) -> float:
        """What the gripper's commands have added up to, in [-1, 1]."""
        return float(self._gripper.current_action[-1])

    @gripper_command.setter
    def gripper_command(self, value: float) -> None:
        self._gripper.current_action = np.array([-value, value])

    @property
    def rest(self) -> Array:
        """Joint positions that the nullspace torque pulls towards [rad], ``(7,)``."""
        return np.array(self._arm_controller.initial_joint)

    @rest.setter
    def rest(self, value: Array) -> None:
        self._arm_controller.initial_joint = np.array(value)

    def step(self, action: Array) -> None:
        """Advance by one control step; see `Stepper`."""
        for controller in self._controllers:
            # Else the first step after a reset or a restored state uses an old pose.
            controller.new_update = True
        self._host.step(np.asarray(action, dtype=np.float64))


def check_control_law(version: str) -> None:
    """Raise if a version of robosuite was not compared with the compiled control law.

    Args:
        version: Of robosuite, such as ``"1.5.1"``.

    Raises:
        PrimeError: If the compiled law may differ from that version's.
    """
    if version not in COMPARED_VERSIONS:
        known = ", ".join(COMPARED_VERSIONS)
        raise PrimeError(
            f"stepping: compiled was compared with robosuite {known}, not with the installed "
            f"{version}: install robosuite=={COMPARED_VERSIONS[-1]} or set stepping: stock"
        )
