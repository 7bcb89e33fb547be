"""How many motor actions a motion may take, from the way that it has to go.

A limit is there for motions that never end. It must not cut off one that is on its way: it leaves
a motion twice the time that the arm takes.
"""

import math

import numpy as np
from numpy.typing import NDArray

from prime_core.affordances.goals import plane_distance
from prime_core.contracts.description import SceneDescription
from prime_core.contracts.scene import Scene
from prime_core.rotations import wrap_angle

Array = NDArray[np.float64]

SLOWEST = 0.006  # [m] a step; robosuite's controller makes 13 mm, near the arm's full stretch less
SLOWEST_TURN = 0.04  # [rad] a step; it makes 0.08
SETTLING = 25  # steps in which a motion comes to rest, or finds out that it is blocked
OUTSIDE = 0.2  # [m] from which outside of the workspace a motion may start


def approach_limit(scene: Scene, goal: Array) -> int:
    """Return the motor actions for lifting, travelling, turning and descending to a goal.

    Args:
        scene: Where it starts.
        goal: x, y, z [m] and yaw [rad], ``(4,)``.
    """
    height = scene.description.lift_height
    lifting = abs(height - float(scene.gripper_position[2])) + abs(height - float(goal[2]))
    turn = abs(float(wrap_angle(goal[3] - scene.gripper_yaw)))
    return way_limit(lifting + plane_distance(scene, goal), turn)


def greatest_approach_limit(description: SceneDescription) -> int:
    """Return the limit of the longest way in a workspace."""
    low, high = np.array(description.workspace_low), np.array(description.workspace_high)
    across = float(np.linalg.norm((high - low)[:2])) + OUTSIDE
    height = description.lift_height
    lifting = max(abs(height - float(low[2])), abs(height - float(high[2]))) + OUTSIDE
    return way_limit(2 * lifting + across, math.pi)


def way_limit(way: float, turn: float = 0.0) -> int:
    """Return the motor actions for a way [m] and a turn [rad]."""
    return SETTLING + math.ceil(way / SLOWEST + turn / SLOWEST_TURN)
