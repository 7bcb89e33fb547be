"""What a recording says of itself: task, robot, controller, rate."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from prime_core.contracts.environment import ACTION_LIMIT, CONTROL_FREQUENCY
from prime_core.errors import DatasetError
from prime_envs_robosuite.recordings.hdf5_file import table_of, text_of
from prime_envs_robosuite.simulation.osc_scales import POSITION_SCALE, ROTATION_SCALE

ROBOT = "Panda"
ROBOSUITE = 1  # robomimic's number for environments of robosuite
MOST_INPUT = 1e6  # of a number that a device gives
MOST_OUTPUT = 1.0  # metres or radians in a step
Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class ActionScale:
    """How robosuite's controller reads the first six numbers of an action.

    Attributes:
        input_low: What they are clipped to, ``(6,)``.
        input_high: The same, upwards.
        output_low: Displacement [m] and rotation vector [rad] at ``input_low``, ``(6,)``.
        output_high: The same at ``input_high``.
    """

    input_low: Array
    input_high: Array
    output_low: Array
    output_high: Array

    def motor_actions(self, actions: Array) -> Array:
        """Turn recorded OSC_POSE actions into our motor actions.

        robosuite's 1.4 gave displacements and rotations in the world frame, 1.5 gives them in the
        base frame; a Panda's base is not turned in the tasks that are imported here.

        Args:
            actions: Displacement, rotation vector, gripper, as recorded: devices may exceed
                what the controller clips them to, ``(N, 7)``.

        Returns:
            dx, dy, dz [m], dyaw [rad], gripper (-1 open, 1 close), world frame, ``(N, 5)``.
        """
        clipped = np.clip(actions[:, :6], self.input_low, self.input_high)
        share = (clipped - self.input_low) / (self.input_high - self.input_low)
        moved = self.output_low + share * (self.output_high - self.output_low)
        gripper = np.sign(actions[:, 6:])
        ours = np.hstack((moved[:, :3], moved[:, 5:6], gripper))
        return np.asarray(np.clip(ours, -ACTION_LIMIT, ACTION_LIMIT))


_SCALES = np.repeat([POSITION_SCALE, ROTATION_SCALE], 3)
ROBOSUITES_SCALE = ActionScale(-np.ones(6), np.ones(6), -_SCALES, _SCALES)
"""That of robosuite's default for a Panda."""


def read_task_of(path: Path, data: Any) -> str:
    """Return robosuite's name of the task that a file was recorded in.

    Args:
        path: Of the file.
        data: The group of demonstrations.

    Raises:
        DatasetError: If the file names none.
    """
    where = f"{path}: group 'data'"
    arguments = table_of(where, data, "env_args") or {}
    found = text_of(where, data, "env") or arguments.get("env_name")
    if not isinstance(found, str) or not found:
        raise DatasetError(
            f"{where} names no recorded task: it has neither an attribute 'env' (robosuite) nor "
            "'env_args' with an env_name (robomimic)"
        )
    return found


def read_settings_of(path: Path, data: Any, task: str) -> ActionScale:
    """Check what a file says of itself.

    Args:
        path: Of the file.
        data: The group of demonstrations, whose attributes say it.
        task: robosuite's name of the task that is wanted.

    Returns:
        How its actions are scaled.

    Raises:
        DatasetError: If it was recorded in another task, with another robot or gripper, another
            controller or at another rate, or says nothing of the task.
    """
    where = f"{path}: group 'data'"
    named = {"env": text_of(where, data, "env")}
    told = {"env_info": table_of(where, data, "env_info")}
    arguments = table_of(where, data, "env_args")
    if arguments is not None:
        kind = arguments.get("type", ROBOSUITE)
        if kind != ROBOSUITE:
            raise DatasetError(
                f"{path}: 'env_args' of 'data' says type {kind!r}; type {ROBOSUITE}, an "
                "environment of robosuite, is read"
            )
        named["env_args"] = arguments.get("env_name")
        told["env_args"] = arguments.get("env_kwargs") or {}
    for source, found in named.items():
        if found is not None and found != task:
            raise DatasetError(
                f"{path}: attribute {source!r} of 'data' names {found!r}; the environment takes "
                f"recordings of {task!r}"
            )
    read_task_of(path, data)
    scale = ROBOSUITES_SCALE
    for source, settings in told.items():
        if settings is not None:
            scale = _Told(f"{path}: {source!r} of 'data'", settings).scale(task)
    return scale


@dataclass(frozen=True)
class _Told:
    """Settings of an environment as robosuite takes them.

    Attributes:
        where: File and attribute.
        settings: The table.
    """

    where: str
    settings: Any

    def scale(self, task: str) -> ActionScale:
        """Check all that matters here and return how actions are scaled."""
        if not isinstance(self.settings, dict):
            raise self._refusal("settings", self.settings, "a table")
        for key, right in (("env_name", task), ("control_freq", CONTROL_FREQUENCY)):
            found = self.settings.get(key)
            if found is not None and (isinstance(found, bool) or found != right):
                raise self._refusal(key, found, repr(right))
        for key, rights in (
            ("robots", (ROBOT,)),
            ("gripper_types", ("default", f"{ROBOT}Gripper")),
        ):
            found = _only(self.settings.get(key))
            if found is not None and found not in rights:
                raise self._refusal(key, found, repr(rights[0]))
        controller = _only(self.settings.get("controller_configs"))
        return ROBOSUITES_SCALE if controller is None else self._controller(controller)

    def _controller(self, composite: Any) -> ActionScale:
        arm = self._arm(composite)
        if arm.get("type") != "OSC_POSE":
            raise self._refusal("controller type", arm.get("type"), "'OSC_POSE'")
        if arm.get("control_delta", True) is not True or arm.get("input_type", "delta") != "delta":
            key = "control_delta" if "control_delta" in arm else "input_type"
            raise self._refusal(
                key, arm[key], "true or 'delta': absolute actions are not read, displacements are"
            )
        for key, rights in (
            ("impedance_mode", ("fixed",)),
            ("input_ref_frame", ("base", "world")),
        ):
            if arm.get(key, rights[0]) not in rights:
                raise self._refusal(key, arm[key], " or ".join(map(repr, rights)))
        default = ROBOSUITES_SCALE
        scale = ActionScale(
            self._six(arm, "input_min", default.input_low),
            self._six(arm, "input_max", default.input_high),
            self._six(arm, "output_min", default.output_low),
            self._six(arm, "output_max", default.output_high),
        )
        if np.any(scale.input_low >= scale.input_high):
            raise self._refusal("input_min", arm["input_min"], "less than input_max")
        return scale

    def _arm(self, composite: Any) -> Mapping[str, Any]:
        """Return the controller of the arm; since 1.5 it is a part of a composite one."""
        if not isinstance(composite, dict):
            raise self._refusal("controller_configs", composite, "a table")
        if "body_parts" not in composite:
            return composite
        parts = composite["body_parts"]
        parts = parts.get("arms", parts) if isinstance(parts, dict) else {}
        arm = parts.get("right") if isinstance(parts, dict) else None
        if composite.get("type", "BASIC") != "BASIC" or not isinstance(arm, dict):
            found = composite.get("type") if isinstance(arm, dict) else composite["body_parts"]
            raise self._refusal("controller", found, "'BASIC' with a controller of the right arm")
        return arm

    def _six(self, arm: Mapping[str, Any], key: str, default: Array) -> Array:
        """Return a limit of the first six numbers; one number stands for all."""
        found = arm.get(key, default)
        values = np.asarray(found) if isinstance(found, np.ndarray) or _is_numeric(found) else None
        if values is None or values.shape not in ((), (6,)):
            raise self._refusal(key, found, "one number or six")
        is_output = key.startswith("output")
        most, unit = (MOST_OUTPUT, " metre or radian a step") if is_output else (MOST_INPUT, "")
        if not np.all(np.abs(values) <= most):  # nor is it NaN
            raise self._refusal(key, found, f"at most {most:g}{unit}")
        return np.broadcast_to(values.astype(np.float64), (6,))

    def _refusal(self, key: str, found: Any, right: str) -> DatasetError:
        return DatasetError(f"{self.where} says {key} {found!r}; it must be {right}")


def _only(value: Any) -> Any:
    """Return the one item of a list of one."""
    return value[0] if isinstance(value, list) and len(value) == 1 else value


def _is_numeric(value: Any) -> bool:
    """Whether a value of JSON is a number or a list of numbers."""
    items = value if isinstance(value, list) else [value]
    return all(isinstance(item, int | float) and not isinstance(item, bool) for item in items)
