"""Reading what robosuite's own recorder wrote: human demonstrations in an HDF5 file."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from prime_core.configuration import LocalPath
from prime_core.contracts.demonstration import Demonstration, DemonstratorConfig
from prime_core.contracts.environment import ACTION_LIMIT, EnvironmentConfig
from prime_core.errors import DatasetError
from prime_envs_robosuite.config import LiftConfig, PickPlaceConfig
from prime_envs_robosuite.recordings.hdf5_file import array_of, data_of, names_of, open_file

if TYPE_CHECKING:
    from prime_envs_robosuite.environment import RobosuiteEnvironment

Array = NDArray[np.float64]

NAME = "robosuite-hdf5"
OSC_WIDTH = 7  # displacement, rotation vector, gripper
ROBOT_JOINTS = 9  # 7 of the arm, 2 fingers
POSE_WIDTH, TWIST_WIDTH = 7, 6  # of a free body in qpos and qvel


class RobosuiteHdf5Config(DemonstratorConfig):
    """Human demonstrations, recorded with robosuite's ``collect_human_demonstrations``.

    Every frame's joint positions and velocities are put into the environment and read off
    as it sees them. Recordings leave out part of the simulator's state, and our environment
    keeps the gripper pointing down where it was let tilt: a frame is where the demonstrator was,
    but stepping on from it is only near to what followed.
    """

    path: LocalPath
    """The HDF5 file."""

    episodes: tuple[str, ...] | None = None
    """Groups to take, such as ``[demo_1, demo_3]``; all by default, in the order of their
    numbers."""

    ends_when_solved: bool = False
    """Whether what was recorded after the task was solved is left out."""

    @classmethod
    def reads(cls, source: Path) -> bool:
        """Whether it is a file by one of HDF5's usual endings."""
        return source.is_file() and source.suffix in (".hdf5", ".h5")

    def count_available(self) -> int:
        """How many demonstrations the file has or the settings name."""
        with open_file(self.path) as file:
            return len(names_of(self.path, data_of(self.path, file), self.episodes))

    def demonstrate(self, environment: EnvironmentConfig, index: int, seed: int) -> Demonstration:
        """Return one recording; the seed changes nothing. See `DemonstratorConfig`.

        Raises:
            DatasetError: If the file is not such a recording, or not of this environment.
        """
        from prime_envs_robosuite.recorder import build_for_recording

        with open_file(self.path) as file:
            data = data_of(self.path, file)
            names = names_of(self.path, data, self.episodes)
            if not 0 <= index < len(names):
                raise DatasetError(
                    f"{self.path}: has demonstrations 0 to {len(names) - 1}, not {index}"
                )
            name = names[index]
            recorded = _recorded_objects(self.path, data, environment)
            states = array_of(self.path, data, f"{name}/states")
            actions = array_of(self.path, data, f"{name}/actions")
        _check_shapes(f"{self.path}: data/{name}", len(recorded), states, actions)
        built = build_for_recording(environment, NAME)
        try:
            joints = _joint_state(states, recorded, built.description.objects[0].name)
            shown = _restore(built, *joints, motor_actions(actions), self.ends_when_solved)
            if not built.is_success():
                raise DatasetError(f"{self.path}: data/{name} does not end in success")
        finally:
            built.close()
        return shown


def _recorded_objects(path: Path, data: Any, environment: EnvironmentConfig) -> tuple[str, ...]:
    """Return the objects of a recording, in order.

    Raises:
        DatasetError: If it is of another task than the environment.
    """
    wanted, objects = _recorded_task(environment)
    found = data.attrs.get("env")
    found = found.decode() if isinstance(found, bytes) else found
    if found is None:
        raise DatasetError(f"{path}: group 'data' has no attribute 'env', the recorded task")
    if found != wanted:
        raise DatasetError(
            f"{path}: attribute 'env' of 'data' is {found!r}; the environment "
            f"{type(environment).__name__} takes recordings of {wanted!r}"
        )
    return objects


def _recorded_task(environment: EnvironmentConfig) -> tuple[str | None, tuple[str, ...]]:
    """Return robosuite's name of an environment and the objects of its recordings, in order."""
    if isinstance(environment, LiftConfig):
        return "Lift", ("cube",)
    if isinstance(environment, PickPlaceConfig):
        # robosuite keeps the objects that are not to be moved, out of the way.
        name = f"PickPlace{environment.object.capitalize()}"
        return name, ("milk", "bread", "cereal", "can")
    return None, ()


def _check_shapes(where: str, objects: int, states: Array, actions: Array) -> None:
    """Raise if arrays do not fit the model or each other.

    Args:
        where: File and group.
        objects: Number of recorded objects.
        states: ``(N, 1 + nq + nv)``.
        actions: ``(N, 7)``.
    """
    positions = ROBOT_JOINTS + POSE_WIDTH * objects
    velocities = ROBOT_JOINTS + TWIST_WIDTH * objects
    expected = 1 + positions + velocities
    if states.shape[1] != expected:
        raise DatasetError(
            f"{where}/states has rows of {states.shape[1]} numbers, must have {expected}: time, "
            f"{positions} joint positions and {velocities} joint velocities of a Panda and "
            f"{objects} object(s)"
        )
    if actions.shape != (len(states), OSC_WIDTH):
        raise DatasetError(
            f"{where}/actions has shape {actions.shape}, must have ({len(states)}, {OSC_WIDTH}): "
            "an OSC_POSE action for each state"
        )


def _restore(
    environment: "RobosuiteEnvironment",
    positions: Array,
    velocities: Array,
    actions: Array,
    ends_when_solved: bool,
) -> Demonstration:
    """Read every recorded state as the environment sees it.

    Args:
        environment: Of the recorded task.
        positions: ``qpos`` of each frame, ``(N, nq)``.
        velocities: ``qvel`` of each frame, ``(N, nv)``.
        actions: Motor actions, ``(N, 5)``.
        ends_when_solved: Whether to leave out what comes after the task was solved.
    """
    from prime_envs_robosuite.recorder import Recorder
    from prime_envs_robosuite.simulation.osc_scales import GRIPPER_SPEED

    recorder = Recorder(environment)
    gripper = 0.0  # half open, as robosuite starts
    for index, action in enumerate(actions):
        environment.set_joint_state(positions[index], velocities[index], gripper)
        if index == len(actions) - 1:
            break
        recorder.add(action)
        # Not recorded, but robosuite adds the commands up just so.
        gripper = float(np.clip(gripper + GRIPPER_SPEED * action[4], -1.0, 1.0))
    return recorder.finish(float(actions[-1, 4]), ends_when_solved)


def _joint_state(states: Array, recorded: Sequence[str], wanted: str) -> tuple[Array, Array]:
    """Return the joint positions and velocities without the objects that we leave out.

    Args:
        states: Time, ``qpos`` and ``qvel`` of arm, fingers and objects, ``(N, M)``.
        recorded: The objects that were recorded, in order.
        wanted: The one that our environment has.

    Returns:
        ``(N, 16)`` and ``(N, 15)``.
    """
    place = recorded.index(wanted)
    split = 1 + ROBOT_JOINTS + POSE_WIDTH * len(recorded)
    poses, twists = states[:, 1:split], states[:, split:]
    robot = np.arange(ROBOT_JOINTS)
    pose = ROBOT_JOINTS + POSE_WIDTH * place + np.arange(POSE_WIDTH)
    twist = ROBOT_JOINTS + TWIST_WIDTH * place + np.arange(TWIST_WIDTH)
    return poses[:, np.append(robot, pose)], twists[:, np.append(robot, twist)]


def motor_actions(actions: Array) -> Array:
    """Turn recorded OSC_POSE actions into our motor actions.

    robosuite's 1.4 gave displacements and rotations in the world frame, 1.5 gives them in the
    base frame; a Panda's base is not turned in the tasks that are imported here.

    Args:
        actions: Displacement, rotation vector, gripper, as recorded: devices may exceed 1,
            which robosuite's controller clips, ``(N, 7)``.

    Returns:
        dx, dy, dz [m], dyaw [rad], gripper (-1 open, 1 close), world frame, ``(N, 5)``.
    """
    clipped = np.clip(actions, -1.0, 1.0)
    gripper = np.sign(clipped[:, 6:])
    return np.asarray(np.hstack((clipped[:, :3], clipped[:, 5:6], gripper)) * ACTION_LIMIT)
