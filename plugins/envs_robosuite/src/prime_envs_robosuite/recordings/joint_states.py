"""Joint positions and velocities of a recording, found by the names of joints.

A recorded state is time, ``qpos`` and ``qvel`` of the model that it was recorded with.
"""

import re
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from prime_core.errors import DemonstrationError
from prime_envs_robosuite.recordings.hdf5_file import array_of, text_of

Array = NDArray[np.float64]

ARM, FINGERS = 7, 2
WIDTHS = {"free": (7, 6), "ball": (4, 3)}  # of a joint in qpos and qvel; of all others 1
POSE = 7
OBSERVED_OBJECT = (10, 14)
"""Widths of robosuite's ``object`` observation of one object, which begins with its pose: Lift adds
where it is from the gripper, PickPlace how it is turned from there, too."""
NORM_TOLERANCE = 0.05  # of a recorded quaternion
MOST_TURNED = 2 * np.pi  # radians of a joint of the arm
WIDEST = 0.3  # metres that a finger may be from the middle
FARTHEST = 10.0  # metres from the origin where an object may be
FASTEST = 1e4  # metres or radians a second; float32 holds more, physics does not


@dataclass(frozen=True, eq=False)
class JointState:
    """Of arm, fingers and one object in each frame, as our environments have them.

    Attributes:
        positions: ``(N, 16)``.
        velocities: ``(N, 15)``.
    """

    positions: Array
    velocities: Array

    def check(self, where: str) -> None:
        """Raise if the numbers cannot be radians, metres and quaternions.

        Raises:
            DemonstrationError: If so.
        """
        for what, values, most, units in (
            ("a joint of the arm is at", self.positions[:, :ARM], MOST_TURNED, "radians"),
            ("a finger is at", self.positions[:, ARM : ARM + FINGERS], WIDEST, "metres"),
            ("the object is at", self.positions[:, -POSE:-4], FARTHEST, "metres"),
            ("a velocity is", self.velocities, FASTEST, "metres or radians a second"),
        ):
            found = float(np.abs(values).max())
            if found > most:
                raise DemonstrationError(
                    f"{where}: {what} {found:.4g}; it should be {units}, at most {most:g}"
                )
        lengths = np.linalg.norm(self.positions[:, -4:], axis=1)
        if np.any(np.abs(lengths - 1) > NORM_TOLERANCE):
            frame = int(np.argmax(np.abs(lengths - 1)))
            raise DemonstrationError(
                f"{where}: the object's quaternion has the length {lengths[frame]:.3g} in row "
                f"{frame}; it must be 1"
            )


def read_joint_state(
    where: str, path: Path, group: Any, objects: Sequence[str], wanted: str
) -> JointState:
    """Return the joint state of a demonstration.

    Args:
        where: File and group, for errors.
        path: Of the file; models may lie beside it.
        group: Of the demonstration.
        objects: Those of the task, in the order in which robosuite has them.
        wanted: The one that our environment has.

    Raises:
        DemonstrationError: If it holds no such states or observations.
    """
    if "states" not in group and "obs" in group:
        return _observed(f"{where}/obs", group["obs"], wanted)
    states = array_of(where, group, "states")
    model = _model_of(where, path, group)
    if model is None:
        widths = [*[("", 1, 1)] * (ARM + FINGERS), *((name, 7, 6) for name in objects)]
        chosen = [*range(ARM + FINGERS), ARM + FINGERS + objects.index(wanted)]
        what = f"of a Panda and {len(objects)} object(s)"
    else:
        widths = list(_joints(model))
        chosen = _find(where, [name for name, *_ in widths], wanted)
        what = "of its model_file"
    positions, velocities = (_columns([row[part] for row in widths], chosen) for part in (1, 2))
    count, speeds = (sum(row[part] for row in widths) for part in (1, 2))
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


def _model_of(where: str, path: Path, group: Any) -> ElementTree.Element | None:
    """Return the world of a demonstration's model, None where the recording has no model."""
    text = text_of(where, group, "model_file")
    if text is None:
        return None
    try:
        if not text.lstrip().startswith("<"):  # robosuite 1.0 kept models in files of their own
            text = (path.parent / "models" / Path(text).name).read_text(encoding="utf-8")
        world = ElementTree.fromstring(text).find("worldbody")
    except OSError:
        return None
    except (ElementTree.ParseError, ValueError) as error:
        raise DemonstrationError(f"{where}: its model_file is no XML: {error}") from None
    if world is None:
        raise DemonstrationError(f"{where}: its model_file has no worldbody: no MuJoCo model")
    return world


def _joints(body: ElementTree.Element) -> Iterator[tuple[str, int, int]]:
    """Yield name and widths in qpos and qvel of all joints, in MuJoCo's order."""
    for joint in body:
        if joint.tag in ("joint", "freejoint"):
            kind = "free" if joint.tag == "freejoint" else joint.get("type", "hinge")
            yield joint.get("name", ""), *WIDTHS.get(kind, (1, 1))
    for child in body.findall("body"):
        yield from _joints(child)


def _find(where: str, names: Sequence[str], wanted: str) -> list[int]:
    """Return which joints are a Panda's, its fingers' and the wanted object's."""
    patterns = [rf"robot0_joint{number}" for number in range(1, ARM + 1)]
    patterns += [rf"gripper0_(right_)?finger_joint{number}" for number in range(1, FINGERS + 1)]
    patterns += [rf"{re.escape(wanted)}_(joint|jnt)0"]
    found = []
    for pattern in patterns:
        hits = [k for k, name in enumerate(names) if re.fullmatch(pattern, name, re.IGNORECASE)]
        if len(hits) != 1:
            raise DemonstrationError(
                f"{where}: its model_file has the joints {', '.join(names)}; wanted are those of "
                f"a Panda, of its two fingers and of {wanted!r} (robosuite's names)"
            )
        found += hits
    return found


def _observed(where: str, group: Any, wanted: str) -> JointState:
    """Return the joint state that robosuite's observations tell; velocities may be missing."""
    arm = _exactly(where, array_of(where, group, "robot0_joint_pos"), "robot0_joint_pos", (ARM,))
    key = "robot0_gripper_qpos"
    fingers = _exactly(where, array_of(where, group, key), key, (FINGERS,))
    names = {name.lower(): name for name in group}
    own = [names.get(f"{wanted}_{part}") for part in ("pos", "quat")]
    if own[0] is not None and own[1] is not None:
        pose = np.hstack([array_of(where, group, name) for name in own])
        pose = _exactly(where, pose, f"{own[0]} and {own[1]}", (POSE,))
    else:
        values = array_of(where, group, "object")
        pose = _exactly(where, values, "object", OBSERVED_OBJECT)[:, :POSE]
    speeds = np.zeros((len(arm), ARM + FINGERS + 6))
    for key, columns in (
        ("robot0_joint_vel", slice(0, ARM)),
        ("robot0_gripper_qvel", slice(ARM, ARM + FINGERS)),
    ):
        if key in group:
            width = columns.stop - columns.start
            speeds[:, columns] = _exactly(where, array_of(where, group, key), key, (width,))
    # Observations have the quaternion's w last, MuJoCo has it first.
    return JointState(np.hstack((arm, fingers, pose[:, [0, 1, 2, 6, 3, 4, 5]])), speeds)


def _exactly(where: str, values: Array, name: str, widths: Sequence[int]) -> Array:
    if values.shape[1] not in widths:
        right = " or ".join(map(str, widths))
        raise DemonstrationError(
            f"{where}/{name} has rows of {values.shape[1]} numbers, must have {right}"
        )
    return values
