"""Points that cannot be measurements of the part: found, counted and taken out.

Only what is certain without knowing the gear goes: what is not finite, exact repetitions, and points alone
in space. Strays near the surface stay; registration judges them against the design.
"""

from __future__ import annotations

import numpy as np

from gearwear.arrays import Bools, Floats, Ints
from gearwear.design.quantity import counted
from gearwear.errors import InputError
from gearwear.scan.contents import Contents
from gearwear.scan.triangles import share_vertices, unit, vertex_normals
from gearwear.scan.unique import first_of_each

FARTHEST = 1e9
"""mm; a coordinate beyond it is no measurement."""
LEAST_POINTS = {"cloud": 100, "triangles": 100, "section": 30}
FEW_ALONE = 0.01
"""Share of lonely points at which a cell is taken to hold the neighbours of all others."""


def clean(contents: Contents) -> tuple[Contents, str]:
    """Take out what is no measurement and say what the points are.

    Parameters
    ----------
    contents : Contents
        As read, in mm.

    Returns
    -------
    contents : Contents
        What is left, with the counts by reason added to `rejected`. Normals have length 1, or 0 where unknown.
    kind : str
        "cloud", "triangles" or "section" (loose points in one plane z = constant; it is put to z = 0).

    Raises
    ------
    InputError
        If too few points are left.
    """
    points, normals, triangles = contents.points, contents.normals, contents.triangles
    rejected = dict(contents.rejected)

    def count(reason: str, amount: int) -> None:
        if amount:
            rejected[reason] = rejected.get(reason, 0) + amount

    with np.errstate(invalid="ignore"):
        finite: Bools = np.all(np.abs(points) <= FARTHEST, axis=1)
    total = len(points)
    if not finite.all():
        if not finite.any():
            raise InputError(f"none of its {total:,} points is a finite number: measured coordinates would be right")
        count("non_finite", total - int(finite.sum()))
        points, normals = points[finite], None if normals is None else normals[finite]
        if triangles is not None:
            number = np.cumsum(finite) - 1
            triangles = number[triangles[finite[triangles].all(axis=1)]]

    if triangles is not None:
        points, normals, triangles, unreferenced = share_vertices(points, normals, triangles)
        count("unreferenced", unreferenced)
        kind = "triangles"
        normals = None if normals is None else _known(unit(normals))
        normals = _known(vertex_normals(points, triangles)) if normals is None else normals
    else:
        kind = "section" if len(points) and bool((points[:, 2] == points[0, 2]).all()) else "cloud"
        first, _ = first_of_each(points)
        count("duplicate", len(points) - len(first))
        if len(first) < len(points):
            points, normals = points[first], None if normals is None else normals[first]
        alone = outliers(points)
        count("outlier", int(alone.sum()))
        if alone.any():
            points, normals = points[~alone], None if normals is None else normals[~alone]
        normals = None if normals is None else _known(unit(normals))
        if kind == "section":
            points = points * np.array([1.0, 1.0, 0.0])
    if len(points) < LEAST_POINTS[kind]:
        held = (
            f"{len(points):,} of its {total:,} points can be used" if len(points) < total else f"holds {counted(total, 'point')}"
        )
        raise InputError(f"{held}: at least {LEAST_POINTS[kind]} would be right")
    return Contents(points, normals, triangles, rejected, contents.units), kind


def _known(normals: Floats) -> Floats | None:
    """The normals, or None if all are zero."""
    return normals if normals.any() else None


def outliers(points: Floats) -> Bools:
    """Points that are alone in space, at the scale on which the others have neighbours.

    Parameters
    ----------
    points : (n, 3) float
        Finite.

    Returns
    -------
    (n,) bool

    Notes
    -----
    Points are counted in the cells of a grid, 128 across the scan at first, and each cell with the 26 around it.
    Cells grow twofold until at most 1 % of the points have fewer than 3 (themselves and strays among strays
    included) there, so that a scan of 1,000 points gets large cells; then once more, so that a part four times
    as thin as that keeps its points. A point that is still lonely is at least one cell from its next: never
    noise, never a thin region. Cost: one sort of n integers per size.
    """
    n = len(points)
    if n < 3:
        return np.zeros(n, bool)
    sample = points[:: 1 + n // 20_000]
    centre = np.median(sample, axis=0)
    size = float(np.quantile(np.abs(sample - centre), 0.99)) / 64.0
    for _ in range(7):
        alone = _lonely(points, centre, size)
        if not alone.any():
            return alone
        size *= 2.0
        if alone.mean() <= FEW_ALONE:
            break
    return _lonely(points, centre, size)


def _lonely(points: Floats, centre: Floats, size: float) -> Bools:
    """Points with fewer than 3 (or 1/64 of a typical cell's number) in the 27 cells around theirs."""
    if not size > 0.0:
        return np.zeros(len(points), bool)
    half = 1 << 20  # 21 bits per axis; what is farther off shares the outermost cells
    key = np.zeros(len(points), np.int64)
    for axis in range(3):
        with np.errstate(over="ignore"):  # of cells that are next to nothing: the outermost ones then
            index = np.clip((points[:, axis] - centre[axis]) / size, 1 - half, half - 2)
        key = key << 21 | (np.floor(index).astype(np.int64) + half)
    cells, counts = np.unique(key, return_counts=True)
    order = np.argsort(counts)
    typical = int(counts[order][np.searchsorted(np.cumsum(counts[order]), 0.5 * len(points))])
    few = max(3, typical // 64)
    sparse = cells[counts < few]
    around = np.zeros(len(sparse), np.int64)
    shifts = [(x << 42) + (y << 21) + z for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1)]
    for shift in shifts:
        at = np.minimum(np.searchsorted(cells, sparse + shift), len(cells) - 1)
        around += np.where(cells[at] == sparse + shift, counts[at], 0)
    return _among(key, sparse[around < few])


def _among(key: Ints, chosen: Ints) -> Bools:
    """Which keys are among the chosen, few and sorted, ones."""
    if not len(chosen):
        return np.zeros(len(key), bool)
    at = np.minimum(np.searchsorted(chosen, key), len(chosen) - 1)
    return np.asarray(chosen[at] == key)
