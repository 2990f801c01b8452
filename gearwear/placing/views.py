"""Several views of one gear, each in a frame of its own, brought together on the design.

Each is registered to the design by itself. Where they overlap they are compared (`accord`); what is wrong with one beyond doubt is taken out of it
(`together`), and they are compared again, until nothing is. Then overlaps are thinned, and the whole is placed on the design.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from gearwear.arrays import Bools, Floats, Ints
from gearwear.design.gear import Gear
from gearwear.design.surface import END_LOW, FILLET, FLANK, OTHER, Bands, SurfacePoints, locate
from gearwear.placing.accord import ViewAccord, view_accords
from gearwear.placing.cells import CellGrid, Cells, bin_points
from gearwear.placing.pose import Pose
from gearwear.placing.registration import Registration, refine, register, rough_pose
from gearwear.placing.together import Taken, remedy, spread_columns, summed
from gearwear.robust import evenly_drawn

DRAWN_BY = 2e-4
"""Modules over which it changes by where a point lies whether it is kept: far below what points scatter, far above what a pose repeats to."""

ROUNDS = 6
"""Times that something is taken out, at most: scales, offsets and places in turn, and what is left of a large scale once more."""


@dataclass(frozen=True, slots=True)
class View:
    """One view on the design.

    Parameters
    ----------
    registration : Registration
        Its pose: design = rotation · points / (1 + `taken.scale`) + translation.
    points : int
        Points read.
    kept : int
        Points left after thinning the overlaps.
    offset : float
        How far it lies above the mean of all views where they overlap, mm (0 where nothing overlaps).
    mismatch : float
        Root mean square of that difference over the overlapping cells, mm.
    accord : ViewAccord
        Its place, offset and scale against the other views. Like offset and mismatch as it was found, before anything was taken out.
    taken : Taken
        What was taken out of it.
    left : float
        The mismatch that is left then, mm.
    """

    registration: Registration
    points: int
    kept: int
    offset: float
    mismatch: float
    accord: ViewAccord
    taken: Taken = field(default_factory=Taken)
    left: float = 0.0

    def apply(self, points: Floats) -> Floats:
        """Points (n, 3) of the view in the design frame, mm."""
        return self.registration.pose.apply(points / (1.0 + self.taken.scale))


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
    told : bool
        Whether the views tell which of them are wrong, where some are.
    shares : (views, teeth, 2) float or None
        Share of each view in the points of each tooth and side; None where nothing was taken out.
    """

    registration: Registration
    views: tuple[View, ...]
    located: SurfacePoints
    thinned: int
    told: bool = True
    shares: Floats | None = None

    def spread(self, points: SurfacePoints) -> Floats:
        """(n, k) what is uncertain at points of the design, as what was taken out of the views is known no better, one standard deviation a column, mm."""
        columns = [np.zeros((len(points), 0))]
        if self.shares is not None:
            for view, share in zip(self.views, self.shares, strict=True):
                at = share[points.tooth, np.where(points.side > 0, 0, 1)]
                columns.append(at[:, None] * spread_columns(view.taken, points))
        return np.hstack(columns)

    @property
    def measured(self) -> Floats:
        """(n, 3) the points themselves in the design frame, mm."""
        return self.located.measured

    @property
    def accords(self) -> list[ViewAccord]:
        """How each view agrees with the others."""
        return [view.accord for view in self.views]

    @property
    def scatters(self) -> list[float]:
        """Scatter of the points of each view, mm."""
        return [view.registration.noise for view in self.views]


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
            registrations.append(refine(points, gear, _unscaled(start.views[i]), planar, ignore)[0])
        else:
            registrations.append(
                register(points, gear, normals_of_view, planar, start=registrations[0].pose if registrations else None)
            )
    noise = float(np.median([registration.noise for registration in registrations]))
    label = np.repeat(np.arange(len(views)), [len(points) for points in views])
    joined = _joined(views, registrations, label, noise, gear, planar, ignore)
    placed, kept, found, registrations = joined.placed, joined.kept, joined.found, joined.registrations
    whole, located = refine(placed[kept], gear, Pose.identity(), planar, ignore)
    total = [
        replace(registration, pose=registration.pose.then(out.back).then(whole.pose))
        for registration, out in zip(registrations, joined.taken, strict=True)
    ]
    merged = tuple(
        View(
            registration=total[i], points=len(views[i]), kept=int((kept & (label == i)).sum()), offset=float(found.offset[i]),
            mismatch=float(found.mismatch[i]), accord=found.accords[i], taken=joined.taken[i], left=float(joined.left[i]),
        )
        for i in range(len(views))
    )  # fmt: skip
    shares = _shares(located, label[kept], len(views), gear) if any(out.any for out in joined.taken) else None
    return PlacedScan(replace(whole, pose=total[0].pose), merged, located, int(len(placed) - kept.sum()), joined.told, shares)


@dataclass(frozen=True, slots=True)
class Found:
    """How views were found, before anything was taken out of them.

    Parameters
    ----------
    offset, mismatch : (views,) float
        As `View`, mm.
    accords : tuple of ViewAccord
    """

    offset: Floats
    mismatch: Floats
    accords: tuple[ViewAccord, ...]

    def with_places(self, later: tuple[ViewAccord, ...]) -> Found:
        """With the places of views that scales and offsets no longer bend."""
        pairs = zip(self.accords, later, strict=True)
        return replace(self, accords=tuple(replace(one, place=two.place, place_std=two.place_std) for one, two in pairs))


@dataclass(frozen=True, slots=True)
class Joined:
    """Views in the design frame, without what was taken out of them.

    Parameters
    ----------
    placed : (n, 3) float
        Points of all views in turn, mm.
    kept : (n,) bool
        Those left after thinning.
    left : (views,) float
        Mismatch of each view, mm.
    found : Found
    taken : list of Taken
    told : bool
        Whether the views tell which of them are wrong.
    registrations : list of Registration
        Own pose of each, without its scale.
    """

    placed: Floats
    kept: Bools
    left: Floats
    found: Found
    taken: list[Taken]
    told: bool
    registrations: list[Registration]


def _joined(
    views: Sequence[Floats],
    alone: list[Registration],
    label: Ints,
    noise: float,
    gear: Gear,
    planar: bool,
    ignore: frozenset[int],
) -> Joined:
    """Compare registered views, take out what is wrong beyond doubt, and again, until nothing is."""
    registrations, bands, narrow = list(alone), alone[0].bands, True
    taken, told = [Taken()] * len(views), True
    found: Found | None = None
    for rounds_left in range(ROUNDS, -1, -1):
        placed = np.vstack([_placed(points, registrations[i], taken[i], gear) for i, points in enumerate(views)])
        overlapping = locate(placed, gear, bands)
        overlap = _overlap(overlapping, label, gear, len(views), planar)
        kept, offset, mismatch = _thin_overlap(overlap, label, overlapping.position)
        accords = view_accords(overlap.views, noise, ignore)
        found = found or Found(offset, mismatch, accords.views)
        next_ = remedy(accords, noise, [registration.covariance for registration in registrations], taken)
        if not next_.any or not rounds_left:
            break
        if narrow:  # the lands of a view that is off lie where the first view's bands hold only some of their points
            bands, narrow, found = _common_bands(alone), False, None
            continue
        told = told and next_.told
        if any(more.motion.any() for more in next_.taken):
            found = found.with_places(accords.views)
        for i, more in enumerate(next_.taken):
            taken[i] = summed(taken[i], more)
            if more.scale != 0.0:  # what it bent of the view's own place goes with it
                pose = registrations[i].pose
                pose = Pose(pose.rotation, pose.translation / (1.0 + more.scale))
                registrations[i] = refine(views[i] / (1.0 + taken[i].scale), gear, pose, planar, ignore)[0]
    assert found is not None  # the last round finds
    if not any(out.motion.any() for out in taken):
        found = found.with_places(accords.views)
    return Joined(placed, kept, mismatch, found, taken, told, registrations)


def _common_bands(registrations: Sequence[Registration]) -> Bands:
    """Bands that hold the lands of every view."""
    both = {
        name: (min(low for low, _ in pairs), max(high for _, high in pairs))
        for name in ("tip", "root", "bore")
        for pairs in [[getattr(registration.bands, name) for registration in registrations]]
    }
    return replace(registrations[0].bands, **both)


def _unscaled(view: View) -> Pose:
    """The pose of a view that nothing was taken out of, about where it was found the first time."""
    pose = view.registration.pose
    return pose if view.taken.scale == 0.0 else Pose(pose.rotation, pose.translation * (1.0 + view.taken.scale))


def _placed(points: Floats, registration: Registration, taken: Taken, gear: Gear) -> Floats:
    """Points (n, 3) of a view in the design frame, without what was taken out of it."""
    placed = registration.pose.apply(points if taken.scale == 0.0 else points / (1.0 + taken.scale))
    if taken.offset != 0.0:
        located = locate(placed, gear, registration.bands)
        placed = np.where((located.surface != OTHER)[:, None], taken.off(located), placed)
    return taken.back.apply(placed) if taken.motion.any() else placed


def _shares(located: SurfacePoints, label: Ints, views: int, gear: Gear) -> Floats:
    """(views, teeth, 2) share of each view in the points of each tooth and side."""
    flank = (located.tooth.astype(np.int64) % gear.teeth) * 2 + np.where(located.side > 0, 0, 1)
    known = (located.surface == FLANK) | (located.surface == FILLET)
    counts = np.array(
        [np.bincount(flank[known & (label == view)], minlength=2 * gear.teeth) for view in range(views)], dtype=np.float64
    )
    return np.asarray((counts / np.maximum(counts.sum(axis=0), 1.0)).reshape(views, gear.teeth, 2))


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
    overlapping = ((weight > 0).sum(axis=0) > 1) & (overlap.views[0].points.surface < END_LOW)
    consensus = (np.nan_to_num(mean) * weight).sum(axis=0) / np.maximum(weight.sum(axis=0), 1.0)
    offset, mismatch = np.zeros(views), np.zeros(views)
    for view in range(views):
        at = overlapping & (weight[view] > 0)
        if at.any():
            difference = mean[view, at] - consensus[at]
            offset[view] = np.median(difference)
            mismatch[view] = np.sqrt(np.mean(np.clip(difference, *np.quantile(difference, [0.01, 0.99])) ** 2))
    return keep, offset, mismatch
