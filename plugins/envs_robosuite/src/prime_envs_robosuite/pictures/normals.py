"""Normals of a mesh: smooth over curved faces, sharp at edges."""

import numpy as np
from numpy.typing import NDArray

CREASE = np.cos(np.radians(60.0))  # faces that meet at a sharper edge are shaded apart
LEAST_LENGTH = 1e-12


def corner_normals(points: NDArray[np.float64], faces: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return a normal for each corner of each face: the mean of the faces that meet there.

    Large faces count more, and those beyond a crease not at all. One normal a point would round
    off the edges of a decimated mesh.

    Args:
        points: ``(P, 3)``.
        faces: Indices of points, ``(F, 3)``.

    Returns:
        ``(3 F, 3)``: the three corners of the first face, of the second, and so on.
    """
    first, second, third = points[faces].transpose(1, 0, 2)
    areas = np.cross(second - first, third - first)
    units = areas / np.maximum(np.linalg.norm(areas, axis=1, keepdims=True), LEAST_LENGTH)
    corners = faces.reshape(-1)
    # All pairs of two corners at one point.
    at_point = np.argsort(corners, kind="stable")
    counts = np.bincount(corners, minlength=len(points))
    begins = np.cumsum(counts) - counts
    neighbours = counts[corners]
    own = np.repeat(np.arange(len(corners)), neighbours)
    turn = np.arange(len(own)) - np.repeat(np.cumsum(neighbours) - neighbours, neighbours)
    other = at_point[begins[corners[own]] + turn]
    smooth = np.sum(units[own // 3] * units[other // 3], axis=1) > CREASE
    normals = np.zeros((len(corners), 3))
    np.add.at(normals, own[smooth], areas[other[smooth] // 3])
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    normals /= np.maximum(lengths, LEAST_LENGTH)
    return np.where(lengths > LEAST_LENGTH, normals, np.array([0.0, 0.0, 1.0]))
