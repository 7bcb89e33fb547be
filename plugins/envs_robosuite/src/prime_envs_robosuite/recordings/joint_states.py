"""Joint positions and velocities of a recording, found by the names of joints.

A recorded state is time, ``qpos`` and ``qvel`` of the model that it was recorded with.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from prime_core.errors import DemonstrationError
from prime_envs_robosuite.recordings.hdf5_file import array_of
from prime_envs_robosuite.recordings.recorded_model import ARM, FINGERS, RecordedModel

Array = NDArray[np.float64]

POSE, SPEED = 7, 6  # widths of an object in qpos and qvel
OBSERVED_OBJECTS = {(1, 10): 7, (1, 14): 14, (2, 23): 7, (2, 28): 14, (4, 56): 14}
"""From one object's pose to the next in robosuite's ``object`` observation, by how many objects
there are and how many numbers. Each object's begin with its pose. Lift adds where it is from the
gripper, PickPlace and NutAssembly how it is turned from there, too, since 1.5 before the pose;
Stack adds all that at the end."""
NORM_TOLERANCE = 0.05  # of a recorded quaternion
MOST_TURNED = 2 * np.pi  # radians of a joint of the arm
WIDEST = 0.3  # metres that a finger may be from the middle
FARTHEST = 10.0  # metres from the origin where an object may be
FASTEST = 1e4  # metres or radians a second; float32 holds more, physics does not


@dataclass(frozen=True, eq=False)
class JointState:
    """Of arm, fingers and ``k`` objects in each frame, as our environments have them.

    Attributes:
        positions: ``(N, 9 + 7 k)``.
        velocities: ``(N, 9 + 6 k)``.
    """

    positions: Array
    velocities: Array

    def check(self, where: str) -> None:
        """Raise if the numbers cannot be radians, metres and quaternions.

        Raises:
            DemonstrationError: If so.
        """
        poses = self.positions[:, ARM + FINGERS :].reshape(len(self.positions), -1, POSE)
        for what, values, most, units in (
            ("a joint of the arm is at", self.positions[:, :ARM], MOST_TURNED, "radians"),
            ("a finger is at", self.positions[:, ARM : ARM + FINGERS], WIDEST, "metres"),
            ("the object is at", poses[:, :, :3], FARTHEST, "metres"),
            ("a velocity is", self.velocities, FASTEST, "metres or radians a second"),
        ):
            found = float(np.abs(values).max())
            if found > most:
                raise DemonstrationError(
                    f"{where}: {what} {found:.4g}; it should be {units}, at most {most:g}"
                )
        lengths = np.linalg.norm(poses[:, :, 3:], axis=2)
        away = np.abs(lengths - 1)
        if np.any(away > NORM_TOLERANCE):
            frame, item = np.unravel_index(int(np.argmax(away)), away.shape)
            raise DemonstrationError(
                f"{where}: the object's quaternion has the length {lengths[frame, item]:.3g} in "
                f"row {frame}; it must be 1"
            )


def read_joint_state(
    where: str,
    group: Any,
    model: RecordedModel | None,
    recorded: Sequence[str],
    wanted: Sequence[str],
) -> JointState:
    """Return the joint state of a demonstration.

    Args:
        where: File and group, for errors.
        group: Of the demonstration.
        model: That it was recorded with; None where that is not known.
        recorded: All objects that robosuite has in the task, in its order, for want of a model.
        wanted: Those that our environment has, by robosuite's names, in the order of its joints.

    Raises:
        DemonstrationError: If it holds no such states or observations.
    """
    if "states" not in group and "obs" in group:
        return _observed(f"{where}/obs", group["obs"], wanted)
    states = array_of(where, group, "states")
    if model is None:
        widths = [(1, 1)] * (ARM + FINGERS) + [(POSE, SPEED)] * len(recorded)
        places = [ARM + FINGERS + recorded.index(name) for name in wanted]
        chosen = [*range(ARM + FINGERS), *places]
        what = f"of a Panda and {len(recorded)} object(s)"
    else:
        widths, chosen = model.widths, model.find(wanted)
        what = "of its model_file"
    positions, velocities = (_columns([row[part] for row in widths], chosen) for part in (0, 1))
    count, speeds = (sum(row[part] for row in widths) for part in (0, 1))
    if states.shape[1] != 1 + count + speeds:
        raise DemonstrationError(
            f"{where}/states has rows of {states.shape[1]} numbers, must have "
            f"{1 + count + speeds}: time, {count} joint positions and {speeds} joint velocities "
            f"{what}"
        )
    return JointState(states[:, 1 + positions], states[:, 1 + count + velocities])


def _columns(widths: Sequence[int], chosen: Sequence[int]) -> NDArray[np.int64]:
    """Return the columns of some joints of a row that holds all of them one after another."""
    ends = np.cumsum(widths)
    return np.concatenate([np.arange(ends[j] - widths[j], ends[j]) for j in chosen])


def _observed(where: str, group: Any, wanted: Sequence[str]) -> JointState:
    """Return the joint state that robosuite's observations tell; velocities may be missing."""
    arm = _exactly(where, array_of(where, group, "robot0_joint_pos"), "robot0_joint_pos", (ARM,))
    key = "robot0_gripper_qpos"
    fingers = _exactly(where, array_of(where, group, key), key, (FINGERS,))
    poses = _observed_poses(where, group, wanted)
    speeds = np.zeros((len(arm), ARM + FINGERS + SPEED * len(wanted)))
    for key, columns in (
        ("robot0_joint_vel", slice(0, ARM)),
        ("robot0_gripper_qvel", slice(ARM, ARM + FINGERS)),
    ):
        if key in group:
            width = columns.stop - columns.start
            speeds[:, columns] = _exactly(where, array_of(where, group, key), key, (width,))
    return JointState(np.hstack((arm, fingers, *poses)), speeds)


def _observed_poses(where: str, group: Any, wanted: Sequence[str]) -> list[Array]:
    """Return the pose of each object in each frame as MuJoCo has it, ``(N, 7)`` each."""
    names = {name.lower(): name for name in group}
    poses = []
    for item in wanted:
        own = [names.get(f"{item.lower()}_{part}") for part in ("pos", "quat")]
        if own[0] is None or own[1] is None:
            break
        pose = np.hstack([array_of(where, group, name) for name in own])
        poses.append(_exactly(where, pose, f"{own[0]} and {own[1]}", (POSE,)))
    else:
        return [pose[:, [0, 1, 2, 6, 3, 4, 5]] for pose in poses]  # w is last in observations
    values = array_of(where, group, "object")
    counts = [width for count, width in OBSERVED_OBJECTS if count == len(wanted)]
    step = OBSERVED_OBJECTS[len(wanted), _exactly(where, values, "object", counts).shape[1]]
    first = POSE if step == 2 * POSE and _is_relative_first(where, group, values) else 0
    starts = [first + step * index for index in range(len(wanted))]
    return [values[:, start : start + POSE][:, [0, 1, 2, 6, 3, 4, 5]] for start in starts]


def _is_relative_first(where: str, group: Any, values: Array) -> bool:
    """Whether an object's pose stands after where it is from the gripper, as robosuite 1.5 has it.

    Told by the distance between both, where the gripper's position is there, too.
    """
    if "robot0_eef_pos" not in group:
        return False
    gripper = _exactly(where, array_of(where, group, "robot0_eef_pos"), "robot0_eef_pos", (3,))
    first, second = values[:, :3], values[:, POSE : POSE + 3]
    misses = [
        np.abs(np.linalg.norm(position - gripper, axis=1) - np.linalg.norm(away, axis=1)).mean()
        for position, away in ((first, second), (second, first))
    ]
    return bool(misses[1] < misses[0])


def _exactly(where: str, values: Array, name: str, widths: Sequence[int]) -> Array:
    if values.shape[1] not in widths:
        right = " or ".join(map(str, widths))
        raise DemonstrationError(
            f"{where}/{name} has rows of {values.shape[1]} numbers, must have {right}"
        )
    return values
