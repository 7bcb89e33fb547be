"""Sizes, yaw symmetries and parts of objects, read from a MuJoCo model.

All is told from points on the convex hulls of geoms, which is what MuJoCo collides.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from prime_core.arrays import Array
from prime_core.rotations import yaw_of

Corner = tuple[float, float, float]
"""Of a box: x, y, z [m]."""

AROUND = 48  # points around a round geom
SYMMETRIES = (4, 2)  # that are looked for, besides round ones
ROUND_TURNS = (2 * np.pi / 5, 2 * np.pi / 7)  # a regular polygon survives one of them at most [rad]
SAME = 0.0015  # between two shapes that count as the same [m]


@dataclass(frozen=True, eq=False)
class ObjectShape:
    """An object as it lies at the start, in its own yaw frame (z up, origin at its body's).

    Attributes:
        parts: Points on the hull of each of its geoms [m], ``(n, 3)``.
        handle: Where robosuite says that it is to be held [m], ``(3,)``; None where it does not.
    """

    parts: tuple[Array, ...]
    handle: Array | None = None

    @property
    def low(self) -> Array:
        """Lower corner of the box around it [m], ``(3,)``."""
        return np.asarray(np.min([part.min(axis=0) for part in self.parts], axis=0))

    @property
    def high(self) -> Array:
        """Upper corner [m], ``(3,)``."""
        return np.asarray(np.max([part.max(axis=0) for part in self.parts], axis=0))

    def yaw_symmetry(self) -> int:
        """Return in how many yaws its hull is the same, as in ``ObjectDescription``; 0 if round."""
        points = np.concatenate(self.parts)
        if all(_survives(points, turn) for turn in ROUND_TURNS):
            return 0
        return next((count for count in SYMMETRIES if _survives(points, 2 * np.pi / count)), 1)


def read_shape(model: Any, data: Any, body: int, handle: str | None = None) -> ObjectShape:
    """Read an object where it is now.

    Args:
        model: A ``mujoco.MjModel``.
        data: Its ``mujoco.MjData``, with poses that are up to date.
        body: Index of the body that the object hangs on.
        handle: Name of the site that it is to be held at, if there is one.
    """
    yaw = float(yaw_of(data.xquat[body]))
    cosine, sine = np.cos(yaw), np.sin(yaw)
    to_world = np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])
    origin = data.xpos[body]
    parts = []
    for geom in np.flatnonzero(model.body_rootid[model.geom_bodyid] == body).tolist():
        if model.geom_contype[geom] or model.geom_conaffinity[geom]:
            parts.append((world_points(model, data, geom) - origin) @ to_world)
    held_at = None if handle is None else (data.site(handle).xpos - origin) @ to_world
    return ObjectShape(tuple(parts), held_at)


def world_points(model: Any, data: Any, geom: int) -> Array:
    """Return points whose convex hull is a geom's [m], world frame, ``(n, 3)``."""
    rotation = data.geom_xmat[geom].reshape(3, 3)
    return np.asarray(data.geom_xpos[geom] + _hull_points(model, geom) @ rotation.T)


def _survives(points: Array, turn: float) -> bool:
    """Whether the convex hull of points ``(n, 3)`` is the same after a turn about z [rad]."""
    azimuths = np.linspace(0.0, 2 * np.pi, 2 * AROUND, endpoint=False)
    heights = np.repeat([-1.0, 0.0, 1.0], len(azimuths))

    def reach(angles: Array) -> Array:
        angles = np.tile(angles, 3)
        directions = np.stack((np.cos(angles), np.sin(angles), heights), axis=1)
        return np.asarray((points @ directions.T).max(axis=0))

    return bool(np.all(np.abs(reach(azimuths) - reach(azimuths + turn)) < SAME))


def _hull_points(model: Any, geom: int) -> Array:
    """Return points whose convex hull is a geom's, in its own frame [m], ``(n, 3)``."""
    import mujoco

    kinds = mujoco.mjtGeom
    kind, size = model.geom_type[geom], model.geom_size[geom]
    if kind == kinds.mjGEOM_MESH:
        mesh = model.geom_dataid[geom]
        start = model.mesh_vertadr[mesh]
        return np.asarray(model.mesh_vert[start : start + model.mesh_vertnum[mesh]], np.float64)
    if kind == kinds.mjGEOM_BOX:
        corners = np.stack(np.meshgrid(*[(-1.0, 1.0)] * 3), axis=-1).reshape(-1, 3)
        return np.asarray(corners * size)
    angles = np.linspace(0.0, 2 * np.pi, AROUND, endpoint=False)
    ring = np.stack((np.cos(angles), np.sin(angles), np.zeros(AROUND)), axis=1)
    if kind == kinds.mjGEOM_CYLINDER:
        return np.concatenate([ring * size[0] + [0, 0, z] for z in (-size[1], size[1])])
    ball = np.concatenate(
        [ring * np.cos(tilt) + [0, 0, np.sin(tilt)] for tilt in np.linspace(-1, 1, 13) * np.pi / 2]
    )
    if kind == kinds.mjGEOM_CAPSULE:
        return np.concatenate([ball * size[0] + [0, 0, z] for z in (-size[1], size[1])])
    # Spheres have one radius, ellipsoids three.
    return np.asarray(ball * (size if kind == kinds.mjGEOM_ELLIPSOID else size[0]))
