"""Several views of one gear, each in a frame of its own, brought together on the design."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from gearwear.arrays import Bools, Floats, Ints
from gearwear.design.gear import Gear
from gearwear.design.surface import END_LOW, SurfacePoints, locate
from gearwear.placing.accord import ViewAccord, view_accords
from gearwear.placing.cells import CellGrid, Cells, bin_points
from gearwear.placing.pose import Pose
from gearwear.placing.registration import Registration, refine, register, rough_pose
from gearwear.robust import evenly_drawn

DRAWN_BY = 2e-4
"""Modules over which it changes by where a point lies whether it is kept: far below what points scatter, far above what a pose repeats to."""


@dataclass(frozen=True, slots=True)
class View:
    """One view on the design.

    Parameters
    ----------
    registration : Registration
        Its pose.
    points : int
        Points read.
    kept : int
        Points left after thinning the overlaps.
    offset : float
        How far it lies above the mean of all views where they overlap, mm (0 where nothing overlaps).
    mismatch : float
        Root mean square of that difference over the overlapping cells, mm.
    accord : ViewAccord
        Its place and scale against the other views.
    """

    registration: Registration
    points: int
    kept: int
    offset: float
    mismatch: float
    accord: ViewAccord


@dataclass(frozen=True, slots=True)
class PlacedScan:
    """A scan, or several views merged, on the design.

    Parameters
    ----------
    registration : Registration
        Of the whole; its `pose` takes the first view's own frame to the design.
    views : tuple of View
        Empty for a single scan.
    located : SurfacePoints
        Every used point.
    thinned : int
        Points left out where views overlap.
    """

    registration: Registration
    views: tuple[View, ...]
    located: SurfacePoints
    thinned: int

    @property
    def measured(self) -> Floats:
        """(n, 3) the points themselves in the design frame, mm."""
        located = self.located
        return np.asarray(located.position + located.normal * np.nan_to_num(located.deviation)[:, None], dtype=np.float64)


def place(
    views: Sequence[Floats],
    gear: Gear,
    normals: Sequence[Floats | None],
    planar: bool = False,
    start: PlacedScan | None = None,
    ignore: frozenset[int] = frozenset(),
) -> PlacedScan:
    """Register one scan, or several views and their union.

    Parameters
    ----------
    views : sequence of (n, 3) float
        Points of each view in its own frame, mm.
    gear : Gear
        The nominal gear.
    normals : sequence of (n, 3) float or None
        Normals of the files, where there are any.
    planar : bool
        True for planar sections.
    start : PlacedScan or None
        The same views, nearly right: nothing is searched for then.
    ignore : frozenset of int
        Codes of surfaces that are no datum.

    Returns
    -------
    PlacedScan

    Raises
    ------
    InputError
        If a view does not fit the design.

    Notes
    -----
    Each view is registered to the design by itself. A spur gear looks alike from every tooth, so a further view takes the pose that
    turns it least against the first: views must be in about one frame (within half a pitch).
    """
    if len(views) == 1:
        rough = rough_pose(views[0], gear, normals[0], planar) if start is None else start.registration.pose
        registration, located = refine(views[0], gear, rough, planar, ignore)
        return PlacedScan(registration, (), located, 0)
    registrations: list[Registration] = []
    for i, (points, normals_of_view) in enumerate(zip(views, normals, strict=True)):
        if start is not None:
            registrations.append(refine(points, gear, start.views[i].registration.pose, planar, ignore)[0])
        else:
            registrations.append(
                register(points, gear, normals_of_view, planar, start=registrations[0].pose if registrations else None)
            )
    placed = np.vstack([registration.pose.apply(points) for registration, points in zip(registrations, views, strict=True)])
    label = np.repeat(np.arange(len(views)), [len(points) for points in views])
    overlapping = locate(placed, gear, registrations[0].bands)
    overlap = _overlap(overlapping, label, gear, len(views), planar)
    kept, offset, mismatch = _thin_overlap(overlap, label, overlapping.position)
    accords = view_accords(overlap.views, float(np.median([registration.noise for registration in registrations])))
    whole, located = refine(placed[kept], gear, Pose.identity(), planar, ignore)
    total = [replace(registration, pose=registration.pose.then(whole.pose)) for registration in registrations]
    merged = tuple(
        View(total[i], len(views[i]), int((kept & (label == i)).sum()), float(offset[i]), float(mismatch[i]), accords[i])
        for i in range(len(views))
    )
    return PlacedScan(replace(whole, pose=total[0].pose), merged, located, int(len(placed) - kept.sum()))


def turned(placed: PlacedScan, motion: Pose) -> PlacedScan:
    """A start for `place`: the same scans with their gear laid otherwise on the design, by a symmetry of the gear."""

    def moved(registration: Registration) -> Registration:
        return replace(registration, pose=registration.pose.then(motion))

    views = tuple(replace(view, registration=moved(view.registration)) for view in placed.views)
    return replace(placed, registration=moved(placed.registration), views=views)


@dataclass(frozen=True, slots=True)
class Overlap:
    """What several views saw of the same cells.

    Parameters
    ----------
    grid : CellGrid
    cell : (n,) int
        Of each point; −1: none.
    views : tuple of Cells
        Each view alone.
    """

    grid: CellGrid
    cell: Ints
    views: tuple[Cells, ...]


def _overlap(located: SurfacePoints, label: Ints, gear: Gear, views: int, planar: bool) -> Overlap:
    grid = CellGrid.for_scan(gear, max(len(label) // 2, 1), planar=planar)
    binned = tuple(bin_points(located.take(label == view), grid, clip=0.1 * gear.transverse_module) for view in range(views))
    return Overlap(grid, grid.index(located), binned)


def _thin_overlap(overlap: Overlap, label: Ints, position: Floats) -> tuple[Bools, Floats, Floats]:
    """Which points, at (n, 3) mm, to keep so that no cell holds more than its best view saw; each view's offset and mismatch (mm)."""
    grid, cell, views = overlap.grid, overlap.cell, len(overlap.views)
    inside = cell >= 0
    count = np.array(
        [np.bincount(cell[(label == view) & inside], minlength=grid.count) for view in range(views)], dtype=np.float64
    )
    mean = np.array([cells_of_view.points.deviation for cells_of_view in overlap.views])
    total = count.sum(axis=0)
    share = np.where(total > 0, count.max(axis=0) / np.maximum(total, 1.0), 1.0)
    middle, m = 0.5 * grid.gear.face_width, grid.gear.transverse_module
    draw = evenly_drawn(np.hypot(position[:, 0], position[:, 1]) / m, np.abs(position[:, 2] - middle) / m, DRAWN_BY)
    keep = ~inside | (draw < share[np.where(inside, cell, 0)])
    weight = np.where(np.isfinite(mean), count, 0.0)
    overlapping = ((weight > 0).sum(axis=0) > 1) & (bin_surface(grid) < END_LOW)
    consensus = (np.nan_to_num(mean) * weight).sum(axis=0) / np.maximum(weight.sum(axis=0), 1.0)
    offset, mismatch = np.zeros(views), np.zeros(views)
    for view in range(views):
        at = overlapping & (weight[view] > 0)
        if at.any():
            difference = mean[view, at] - consensus[at]
            offset[view] = np.median(difference)
            mismatch[view] = np.sqrt(np.mean(np.clip(difference, *np.quantile(difference, [0.01, 0.99])) ** 2))
    return keep, offset, mismatch


def bin_surface(grid: CellGrid) -> Ints:
    """Surface code of every cell of a grid, (m,)."""
    surface = np.zeros(grid.count, np.int8)
    for code, (start, size) in grid.blocks.items():
        surface[start : start + size] = code
    return surface
