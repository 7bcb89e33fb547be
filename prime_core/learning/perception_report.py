"""How well a perception does on frames that it has not seen."""

from typing import Any

import numpy as np

from prime_core.arrays import Floats
from prime_core.contracts.description import SceneDescription
from prime_core.contracts.observations import Observations
from prime_core.contracts.perception import Perception
from prime_core.rotations import wrap_angle, yaw_of

NEAR = 0.12
"""From the gripper [m]: there an object is in the wrist camera's view, and about to be grasped."""


def report_on_perception(
    perception: Perception, held_out: Observations, description: SceneDescription
) -> dict[str, Any]:
    """Test a perception on held-out frames, whose object poses are known.

    Args:
        perception: The trained one.
        held_out: Frames that it has not seen, with images.
        description: Of the scenes.

    Returns:
        For each object the number of frames, median and 90th percentile of the distance [mm]
        between told and true position, of all frames and of those where it is near the gripper and
        not held; the median angle [degrees] of its yaw, if it has one, and in which share of frames
        it is told rightly whether the object is held.
    """
    found = perception.see(held_out.only(("proprioception", "images")))
    misses = np.linalg.norm(found.object_positions - held_out.object_positions, axis=-1) * 1e3
    reach = held_out.object_positions - held_out.gripper_position[:, None]
    near = (np.linalg.norm(reach, axis=-1) < NEAR) & (held_out.held == 0)
    report: dict[str, Any] = {}
    for index, item in enumerate(description.objects):
        entry: dict[str, Any] = {
            "frames": len(held_out),
            "position_mm": _percentiles(misses[:, index]),
            "near_gripper_mm": _percentiles(misses[near[:, index], index]),
        }
        if item.yaw_symmetry:
            turns = [yaw_of(each.object_quaternions[:, index]) for each in (found, held_out)]
            angles = wrap_angle(turns[0] - turns[1], 2 * np.pi / item.yaw_symmetry)
            entry["yaw_degrees"] = float(np.degrees(np.median(np.abs(angles))))
        held = found.held[:, index] == held_out.held[:, index]
        report[item.name] = {**entry, "held_accuracy": float(np.mean(held))}
    return report


def _percentiles(values: Floats) -> dict[str, float | None]:
    if not len(values):
        return {"median": None, "p90": None}
    return {"median": float(np.median(values)), "p90": float(np.percentile(values, 90))}
