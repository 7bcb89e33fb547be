"""Fewer faces and fewer parts in a model's looks, for pictures without a GPU.

The Panda comes as some fifty visual meshes of 150 thousand faces. Each face costs time even where
it is smaller than a pixel, and so does each part. Here the parts of a body that look alike become
one mesh, of which a small share of the faces is kept.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from prime_core.errors import PrimeError
from prime_envs_robosuite.pictures.normals import corner_normals

Points = NDArray[np.float64]
Faces = NDArray[np.int64]
LOOKS_GROUP = 1  # robosuite's group of geoms that show
LEAST_FACES = 40


@dataclass(frozen=True)
class _Share:
    """What is kept of some geoms' meshes.

    Attributes:
        prefix: How the geoms' names begin.
        kept: Share of the faces.
        welded: Points that are no farther apart are one [m].
    """

    prefix: str
    kept: float
    welded: float = 1e-5


# What is not named stays whole: objects and fingers have few faces, and lose their shape.
# The mount's mesh is in shreds that cannot be decimated before they are sewn together.
SHARES = (
    _Share("robot0_", 0.12),
    _Share("gripper0_right_hand", 0.2),
    _Share("fixed_mount0_", 0.06, welded=4e-3),
)


def lighten(model: Any) -> None:
    """Merge and decimate a compiled model's large visual meshes in place.

    Args:
        model: A ``mujoco.MjModel`` that no MuJoCo context was made of yet, to look at only.

    Raises:
        PrimeError: If there is nothing to decimate with.
    """
    for share, geoms in _groups(model):
        points, faces = _merged(model, geoms, share.welded)
        target = max(LEAST_FACES, int(share.kept * len(faces)))
        if target < len(faces):
            points, faces = _decimated(points, faces, target)
        _write(model, geoms, points, faces)


def _groups(model: Any) -> list[tuple[_Share, list[int]]]:
    """Return the geoms that are decimated: lists of those that look alike and move together."""
    import mujoco

    meshes = model.geom_type == mujoco.mjtGeom.mjGEOM_MESH
    groups: dict[tuple[Any, ...], list[int]] = {}
    for geom in np.flatnonzero(meshes & (model.geom_group == LOOKS_GROUP)).tolist():
        name = model.geom(geom).name
        for share in SHARES:
            if name.startswith(share.prefix):
                key = (share, int(model.geom_bodyid[geom]), *_look(model, geom))
                groups.setdefault(key, []).append(geom)
    return [(key[0], geoms) for key, geoms in groups.items()]


def _look(model: Any, geom: int) -> tuple[float, ...]:
    """Return what a geom's look depends on; robosuite gives each part a material of its own."""
    values = [model.geom_rgba[geom]]
    material = int(model.geom_matid[geom])
    if material >= 0:
        for key in ("rgba", "specular", "shininess", "reflectance", "emission", "texid"):
            values.append(np.ravel(getattr(model, f"mat_{key}")[material]))
    return tuple(np.concatenate(values).tolist())


def _merged(model: Any, geoms: list[int], welded: float) -> tuple[Points, Faces]:
    """Return all geoms' points in their body's frame, those close together once, and the faces."""
    all_points, all_faces, count = [], [], 0
    for geom in geoms:
        mesh = model.geom_dataid[geom]
        points = model.mesh_vert[_rows(model.mesh_vertadr[mesh], model.mesh_vertnum[mesh])]
        faces = model.mesh_face[_rows(model.mesh_faceadr[mesh], model.mesh_facenum[mesh])]
        all_points.append(points @ _rotation(model, geom).T + model.geom_pos[geom])
        all_faces.append(faces.astype(np.int64) + count)
        count += len(points)
    points, faces = np.concatenate(all_points), np.concatenate(all_faces)
    cells = np.round((points - points.min(axis=0)) / welded).astype(np.int64)
    keys = (cells[:, 0] << 42) | (cells[:, 1] << 21) | cells[:, 2]
    _, first, numbers = np.unique(keys, return_index=True, return_inverse=True)
    faces = numbers[faces]
    return points[first], faces[np.all(faces != np.roll(faces, 1, axis=1), axis=1)]


def _decimated(points: Points, faces: Faces, target: int) -> tuple[Points, Faces]:
    """Return a mesh of about so many faces."""
    try:
        from fast_simplification import simplify
    except ImportError as error:
        raise PrimeError(
            "a picture of light meshes needs the package fast-simplification, which cannot be "
            f"imported ({error}); install it: pip install fast-simplification"
        ) from error
    found = simplify(points, faces.astype(np.int32), target_count=target)
    return np.asarray(found[0], np.float64), np.asarray(found[1], np.int64)


def _write(model: Any, geoms: list[int], points: Points, faces: Faces) -> None:
    """Put a mesh in the place of the geoms' largest one, and hide the others.

    Geoms whose mesh would not fit there are left as they are.
    """
    kept = geoms[int(np.argmax(model.mesh_facenum[model.geom_dataid[geoms]]))]
    mesh = model.geom_dataid[kept]
    room = (model.mesh_vertnum[mesh], model.mesh_facenum[mesh], model.mesh_normalnum[mesh] // 3)
    if len(points) > room[0] or len(faces) > min(room[1:]):
        return
    points = (points - model.geom_pos[kept]) @ _rotation(model, kept)
    normals = corner_normals(points, faces)
    model.mesh_vert[_rows(model.mesh_vertadr[mesh], len(points))] = points
    model.mesh_normal[_rows(model.mesh_normaladr[mesh], len(normals))] = normals
    rows = _rows(model.mesh_faceadr[mesh], len(faces))
    model.mesh_face[rows] = faces
    model.mesh_facenormal[rows] = np.arange(len(normals)).reshape(-1, 3)
    model.mesh_vertnum[mesh], model.mesh_normalnum[mesh] = len(points), len(normals)
    model.mesh_facenum[mesh] = len(faces)
    model.mesh_texcoordadr[mesh] = -1  # the robot is painted in plain colours
    model.geom_rbound[kept] = np.linalg.norm(points, axis=1).max()
    others = [geom for geom in geoms if geom != kept]
    model.geom_group[others] = 0


def _rotation(model: Any, geom: int) -> Points:
    """Return a geom's rotation in its body, ``(3, 3)``."""
    import mujoco

    rotation = np.empty(9)
    mujoco.mju_quat2Mat(rotation, model.geom_quat[geom])
    return rotation.reshape(3, 3)


def _rows(address: Any, count: Any) -> slice:
    return slice(int(address), int(address) + int(count))
