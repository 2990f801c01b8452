"""Triangles as indices: polygons cut up, corners shared, normals of the vertices."""

from __future__ import annotations

import numpy as np

from gearwear.arrays import Floats, Ints
from gearwear.errors import InputError
from gearwear.memory import check_memory
from gearwear.scan.unique import first_of_each


def fan(flat: Ints, start: Ints, corners: Ints) -> Ints:
    """Cut polygons into triangles from their first corner.

    Parameters
    ----------
    flat : (k,) int
        Numbers among which the corner indices stand.
    start : (p,) int
        Where in `flat` each polygon's first corner is.
    corners : (p,) int
        How many corners it has; fewer than 3 make no triangle.

    Returns
    -------
    (m, 3) int64
        Vertex indices, polygons of one size together.

    Raises
    ------
    InputError
        If a polygon lists more corners than stand in `flat`, or its triangles take more memory than may be used.

    Examples
    --------
    >>> fan(np.array([7, 8, 9, 4]), np.array([0]), np.array([4]))
    array([[7, 8, 9],
           [7, 9, 4]])
    """
    if (start + corners > len(flat)).any() or (start < 0).any():
        raise InputError(
            "a face lists more corners than the file holds: it is cut off or damaged; a complete file would be right"
        )
    check_memory(triangles=int(np.maximum(corners - 2, 0).sum()))
    pieces = [np.empty((0, 3), np.int64)]
    order = np.argsort(
        corners, kind="stable"
    )  # once: with a search for each size, many sizes would take the square of their number
    sizes, first_of_size = np.unique(corners[order], return_index=True)
    for count, those in zip(sizes, np.split(order, first_of_size[1:]), strict=True):
        if count < 3:
            continue
        first = start[those, None, None]
        fans = np.column_stack([np.zeros(count - 2, np.int64), np.arange(1, count - 1), np.arange(2, count)])
        pieces.append(flat[first + fans].reshape(-1, 3).astype(np.int64))
    return np.concatenate(pieces)


def check_indices(triangles: Ints, vertices: int) -> Ints:
    """The triangles, if every index names one of the vertices."""
    if triangles.size and not (triangles.min() >= 0 and triangles.max() < vertices):
        bad = triangles[(triangles < 0) | (triangles >= vertices)][0]
        raise InputError(
            f"a triangle uses vertex {bad} and there are {vertices:,} (counted from 0): indices of existing vertices would be right"
        )
    return triangles


def share_vertices(points: Floats, normals: Floats | None, triangles: Ints) -> tuple[Floats, Floats | None, Ints, int]:
    """Merge vertices at exactly the same place and drop what then has no area or no triangle.

    Parameters
    ----------
    points : (n, 3) float
        Vertices; triangles with one that is not finite must be gone.
    normals : (n, 3) float or None
        Of the vertices; the first of the merged ones is kept.
    triangles : (m, 3) int
        Indices into `points`.

    Returns
    -------
    points, normals, triangles, unreferenced
        The number of vertices that no triangle uses comes last.
    """
    kept, label = first_of_each(points)
    merged = label[triangles]
    a, b, c = merged.T
    merged = merged[(a != b) & (b != c) & (c != a)]
    used = np.zeros(len(kept), bool)
    used[merged] = True
    kept_used = kept[used]
    unreferenced = len(kept) - len(kept_used)
    number = np.cumsum(used) - 1
    return points[kept_used], None if normals is None else normals[kept_used], number[merged], unreferenced


def vertex_normals(points: Floats, triangles: Ints) -> Floats:
    """Unit normals of the vertices, (n, 3): the mean of their triangles' weighted by area.

    The cross product of two edges is twice the area long; a vertex without a clear side gets zeros.
    """
    a, b, c = (points[triangles[:, i]] for i in range(3))
    area = np.cross(b - a, c - a)
    corner = triangles.ravel()
    total = np.empty_like(points)
    for axis in range(3):
        total[:, axis] = np.bincount(corner, np.repeat(area[:, axis], 3), minlength=len(points))
    return unit(total)


def unit(vectors: Floats) -> Floats:
    """The vectors at length 1; zeros for those with no length or not finite."""
    with np.errstate(all="ignore"):
        length = np.sqrt(np.einsum("ij,ij->i", vectors, vectors))
        good = np.isfinite(length) & (length > 0.0)
        return np.where(good[:, None], vectors / np.where(good, length, 1.0)[:, None], 0.0)
