"""A cheap test of whether the hand is near any furniture.

Exact distances between all pairs of geoms cost more than the rest of a step of inverse
kinematics; most steps are made in free air.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

PLANE = 0  # MuJoCo's number of the geom type


class Clearance:
    """Compares the hand's bounding spheres with boxes about the furniture, which never moves.

    Args:
        model: The ``mujoco.MjModel``.
        data: Its ``mujoco.MjData``, with kinematics computed.
        hand: Indices of the hand's geoms.
        furniture: Indices of the furniture's geoms.
        distance: What counts as near [m].
    """

    def __init__(
        self, model: Any, data: Any, hand: list[int], furniture: list[int], distance: float
    ) -> None:
        self._hand = np.array(hand, dtype=np.int64)
        self._reach = model.geom_rbound[self._hand][:, None] + distance
        boxes = [_world_box(model, data, index) for index in furniture]
        self._low = np.array([low for low, _ in boxes]).reshape(-1, 3)
        self._high = np.array([high for _, high in boxes]).reshape(-1, 3)

    def is_near(self, data: Any) -> bool:
        """Whether a geom of the hand may be near furniture.

        Args:
            data: The ``mujoco.MjData``, with kinematics computed.
        """
        centres = data.geom_xpos[self._hand][:, None]
        gaps = np.maximum(self._low - centres, centres - self._high).clip(min=0.0)
        return bool(np.any(np.einsum("hfi,hfi->hf", gaps, gaps) < self._reach**2))


def _world_box(model: Any, data: Any, geom: int) -> tuple[Array, Array]:
    """Return the corners of an upright box about a geom [m], ``(3,)`` each, world frame."""
    if model.geom_type[geom] == PLANE:
        return np.full(3, -np.inf), np.full(3, np.inf)
    rotation = data.geom_xmat[geom].reshape(3, 3)
    centre = data.geom_xpos[geom] + rotation @ model.geom_aabb[geom, :3]
    half = np.abs(rotation) @ model.geom_aabb[geom, 3:]
    return centre - half, centre + half
