"""How far the hand is from furniture, as far as that matters.

Exact distances between all pairs of geoms cost more than the rest of a step of inverse
kinematics; most pairs are told apart by spheres and boxes about them.
"""

import math
from collections.abc import Iterator
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

LEVER = 0.15  # [m] from the gripper's axis to the farthest point of the hand, at most
PLANE = 0  # MuJoCo's number of the geom type


class Clearance:
    """Compares the hand with the furniture, which never moves.

    Args:
        model: The ``mujoco.MjModel``.
        data: Its ``mujoco.MjData``, with kinematics computed.
        hand: Indices of the hand's geoms.
        furniture: Indices of the furniture's geoms.
    """

    def __init__(self, model: Any, data: Any, hand: list[int], furniture: list[int]) -> None:
        self._model = model
        self._hand = np.array(hand, dtype=np.int64)
        self._furniture = furniture
        self._radii = model.geom_rbound[self._hand][:, None]
        boxes = [_world_box(model, data, index) for index in furniture]
        self._low = np.array([low for low, _ in boxes]).reshape(-1, 3)
        self._high = np.array([high for _, high in boxes]).reshape(-1, 3)

    def exceeds(self, data: Any, distance: float) -> bool:
        """Whether every geom of the hand is farther from all furniture than a distance.

        Args:
            data: The ``mujoco.MjData``, with kinematics computed.
            distance: [m]; below 0, how deep in furniture a geom may be.
        """
        return all(apart > distance for apart, _ in self._neighbours(data, distance))

    def allows(self, data: Any, move: Array, distance: float) -> bool:
        """Whether the hand stays farther than a distance from all furniture on a straight way.

        Bodies without hollows stay apart as long as neither crosses the plane between them.

        Args:
            data: The ``mujoco.MjData``, with kinematics computed.
            move: x, y, z [m] and yaw [rad] of the gripper, ``(4,)``.
            distance: [m], at least 0.
        """
        x, y, z = move[:3].tolist()
        swing = LEVER * abs(float(move[3]))
        reach = math.hypot(x, y, z) + swing + distance
        for apart, way in self._neighbours(data, reach):
            if apart <= distance:
                return False
            closing = (x * way[0] + y * way[1] + z * way[2]) / apart
            if apart - max(closing, 0.0) - swing <= distance:
                return False
        return True

    def _neighbours(self, data: Any, distance: float) -> Iterator[tuple[float, list[float]]]:
        """Yield how far geoms are from furniture within a distance [m], and the way there [m]."""
        centres = data.geom_xpos[self._hand][:, None]
        gaps = np.maximum(self._low - centres, centres - self._high)
        np.maximum(gaps, 0.0, out=gaps)
        near = (gaps * gaps).sum(axis=2) <= np.maximum(self._radii + distance, 0.0) ** 2
        beyond = max(distance, 0.0) + 1e-3  # what is farther is not worth a number
        ends = np.empty(6)
        for hand, item in np.argwhere(near).tolist():
            apart = mujoco.mj_geomDistance(
                self._model, data, int(self._hand[hand]), self._furniture[item], beyond, ends
            )
            if apart < beyond:
                yield apart, (ends[3:] - ends[:3]).tolist()


def _world_box(model: Any, data: Any, geom: int) -> tuple[Array, Array]:
    """Return the corners of an upright box about a geom [m], ``(3,)`` each, world frame."""
    if model.geom_type[geom] == PLANE:
        return np.full(3, -np.inf), np.full(3, np.inf)
    rotation = data.geom_xmat[geom].reshape(3, 3)
    centre = data.geom_xpos[geom] + rotation @ model.geom_aabb[geom, :3]
    half = np.abs(rotation) @ model.geom_aabb[geom, 3:]
    return centre - half, centre + half
