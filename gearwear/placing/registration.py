"""Registration of a scan to the design, robust against wear on most of the drive flanks.

Three stages: coarse candidates (`coarse`), a robust fit of points on a thinned scan, and a robust fit of cell means
of the whole scan on the surfaces chosen as datum. What the scan adds on every surface alike (a coat) is a free
offset throughout, so that it does not push a scan seen from one side.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from gearwear.arrays import Bools, Floats
from gearwear.design.card import Card, CardRow
from gearwear.design.gear import Gear
from gearwear.design.side import Side
from gearwear.design.surface import BORE, END_HIGH, END_LOW, FILLET, FLANK, OTHER, ROOT, TIP, Bands, SurfacePoints, locate
from gearwear.design.twist import drawn_height, has_screw, helix_words, untwisted
from gearwear.errors import InputError, NotThisGear
from gearwear.placing.cells import CellGrid, Cells, bin_points, noise
from gearwear.placing.coarse import (
    Sample,
    axis_candidates,
    axis_of_inertia,
    coarse_planar_poses,
    coarse_poses,
    snap_height,
    take_sample,
)
from gearwear.placing.datum import Datum, choose_datum
from gearwear.placing.least_squares import clustered, solved
from gearwear.placing.pose import Pose, along_screw, flip, least_turn, motion_columns, size_of_motion, small_motion
from gearwear.placing.screw import helical_axes
from gearwear.processors import each
from gearwear.robust import median_scale, tukey_slope, tukey_weight

QUICK_FIT_POINTS, SETTLING_POINTS = 5000, 40000
"""Points of the thinned scans that choose a candidate and settle it."""
MAX_QUICK_COST = 0.25
"""Cost of a quick fit above which other starts are tried."""
LAST_STEP = 2e-4, 0.1
"""Last step, in modules or in how well the pose is known, below which the registration is done (1.3 µm at module 6.35; in practice 0.01 µm)."""
REPEATED_TO_MODULES = 1e-6
"""Last step, in modules, from which on no other pass or quick step follows (6 nm at module 6.35; each is a thirtieth of the one before or less): the pose is then the
part's own, wherever the search began, and what hangs on it goes no other way for where the gear lay."""
MOST_PASSES = 8
LEAST_ON_FACE = 10
"""Points well inside the outline from which an end face counts as seen."""
LEAST_SHARE_ON_DESIGN = 0.45
"""Least share of points that must lie on the design for a scan to be of it."""
HEIGHT = np.array([False, False, True, False, False, False])
"""The motion along the axis."""
_Fit = tuple[float, Pose]


@dataclass(frozen=True, slots=True, repr=False)
class Registration(Card):
    """How the scan lies on the design.

    Parameters
    ----------
    pose : Pose
        design = rotation · scan + translation.
    converged : bool
        False where the last step was not small; said in the report.
    covariance : (6, 6) float
        Of the motion (tx, ty, tz in mm; wx, wy, wz in rad), in the design frame, clustered by tooth side so that texture and
        correlation are in it, and what it hangs on flanks that may be worn.
    observed : (6,) bool
        False where the scan says nothing on that motion (z without end faces).
    datum : Datum
        Surfaces the pose rests on, and what is assumed.
    offset : float
        How far all datum surfaces lie above the design, mm (a coat, a scanner's zero).
    bands : Bands
        Which surface a point may belong to, from the scan's own scatter.
    noise : float
        Scatter of points inside cells, mm.
    fitting : float
        Share of points that lie on the design.
    unsettled : tuple of str
        What puts it in doubt, each a sentence.
    unseen : tuple of str
        What it had to assume besides its datum.
    without : tuple of (Side, (6,) float)
        For each side that may be worn, how the pose moves if its flanks are no datum, mm and rad.
    """

    pose: Pose
    converged: bool
    covariance: Floats
    observed: Bools
    datum: Datum
    offset: float
    bands: Bands
    noise: float
    fitting: float
    unsettled: tuple[str, ...]
    unseen: tuple[str, ...]
    without: tuple[tuple[Side, Floats], ...] = ()

    @property
    def notes(self) -> tuple[str, ...]:
        """Doubts and assumptions, each a sentence."""
        return (*self.unsettled, *self.datum.notes, *self.unseen)

    def headline(self) -> str:
        settled = "settled" if self.converged else "did not settle"
        return f"{settled}, {100 * self.fitting:.1f} % of the points on the design, noise {1e3 * self.noise:.2f} µm"

    def rows(self) -> list[CardRow]:
        std = 1e3 * np.sqrt(np.diag(self.covariance))
        place = [
            f"{axis} {value:z.3f} mm " + (f"± {error:.2g} µm" if seen else "(not seen)")
            for axis, value, error, seen in zip("xyz", self.pose.translation, std[:3], self.observed[:3], strict=True)
        ]
        return [
            ("translation", ", ".join(place)),
            ("rotation about the axis", f"± {np.degrees(self.rotation_std):.2g}°"),
            ("rests on", ", ".join(self.datum.surfaces)),
            ("surfaces too high by", f"{1e3 * self.offset:z.1f} µm"),
            *(("note", note) for note in self.notes),
        ]

    @property
    def rotation_std(self) -> float:
        """Standard deviation of the rotation about the axis, rad."""
        return float(np.sqrt(self.covariance[5, 5]))


def register(
    points: Floats, gear: Gear, normals: Floats | None = None, planar: bool = False, start: Pose | None = None
) -> Registration:
    """Find the pose of a scan without a starting guess.

    Parameters
    ----------
    points : (n, 3) float
        The scan in its own frame, mm.
    gear : Gear
        The nominal gear.
    normals : (n, 3) float or None
        Normals of the file, if any.
    planar : bool
        True for a planar section: only x, y and the rotation are sought.
    start : Pose or None
        Tried first, and kept where it fits (a further view of a gear already placed).

    Returns
    -------
    Registration
        The pose that, of all that fit alike, turns the scan least from its own axes.

    Raises
    ------
    InputError
        If no pose puts the scan on this design.
    """
    return refine(points, gear, rough_pose(points, gear, normals, planar, start), planar)[0]


def rough_pose(
    points: Floats, gear: Gear, normals: Floats | None, planar: bool, start: Pose | None = None, sample: Sample | None = None
) -> Pose:
    """The pose from a thinned scan, from which `refine` goes on; parameters and errors as `register`. `sample` is `take_sample` of the points, if known."""
    free = _free(planar)
    thin = _thinned(points, QUICK_FIT_POINTS, seed=1)
    if sample is None and not planar:
        sample = take_sample(points, normals)
    best = None
    if start is not None:
        best = _quick_fit(thin, gear, start if sample is None else snap_height(sample, start, gear), free)
    if best is None or best[0] > MAX_QUICK_COST:
        candidates = coarse_planar_poses(points, gear) if sample is None else coarse_poses(sample, gear, _axes(sample, gear))
        best = _best_fit(thin, gear, candidates, free, best)
        # A file's normals may be zeros, or of something else than the surface.
        if best[0] > MAX_QUICK_COST and normals is not None and not planar:
            sample = take_sample(points, None)
            best = _best_fit(thin, gear, coarse_poses(sample, gear, _axes(sample, gear)), free, best)
        if best[0] > MAX_QUICK_COST and sample is not None:
            best = _best_fit(thin, gear, coarse_poses(sample, gear, [axis_of_inertia(sample)]), free, best)
    thin = _thinned(points, SETTLING_POINTS, seed=2)
    pose = _settle(thin, gear, best[1], free)
    if planar or start is not None or gear.spec.left == gear.spec.right:
        return least_turn(pose, gear, start or Pose.identity())
    return least_turn(_drawn_way_up(thin, gear, pose, free), gear, Pose.identity(), way_up_told=True)


def _axes(sample: Sample, gear: Gear) -> list[Floats]:
    """Directions the axis may have: by normals square to it, or by the screw of helical teeth."""
    return axis_candidates(sample) if gear.twist == 0.0 else helical_axes(sample, gear)


def _free(planar: bool) -> Bools:
    """Which of (tx, ty, tz, wx, wy, wz) a scan can say something on."""
    return np.array([True, True, False, False, False, True]) if planar else np.ones(6, dtype=bool)


def _thinned(points: Floats, count: int, seed: int) -> Floats:
    return points if len(points) <= count else points[np.random.default_rng(seed).choice(len(points), count, replace=False)]


def _quick_fit(points: Floats, gear: Gear, pose: Pose, free: Bools) -> _Fit:
    """Cost (0 … 1, mean clipped deviation) and pose after a few robust steps from far away."""
    near = 0.06 * gear.transverse_module
    for _ in range(8):
        pose, step = _robust_step(points, gear, pose, free, floor=0.25 * near)
        if step < REPEATED_TO_MODULES * gear.transverse_module:
            break
    located = locate(pose.apply(points), gear, workers=1)
    miss = np.where(located.surface == OTHER, near, np.abs(np.nan_to_num(located.deviation)))
    return float(np.minimum(miss, near).mean() / near), pose


def _best_fit(points: Floats, gear: Gear, poses: list[Pose], free: Bools, known: _Fit | None) -> _Fit:
    """The cheapest of the first poses' fits and the one already known, if any."""
    fits = each([partial(_quick_fit, points, gear, pose, free) for pose in poses[:6]])
    return min(fits + ([known] if known else []), key=lambda fit: fit[0])


def _settle(points: Floats, gear: Gear, pose: Pose, free: Bools) -> Pose:
    """Robust fit on a thinned scan until the step is small against what the next stage corrects."""
    for _ in range(15):
        pose, step = _robust_step(points, gear, pose, free, floor=0.0)
        if step < 2e-5 * gear.transverse_module:
            break
    return pose


def _drawn_way_up(points: Floats, gear: Gear, pose: Pose, free: Bools) -> Pose:
    """`pose`, or the same upside down, which makes each flank one of the other side: whichever the drawing fits, where it tells the sides apart."""

    def misfit(lay: Pose) -> float:
        """Mean distance of flanks from their own middle, mm, of the side that fits better: the other may be worn."""
        located, far = locate(lay.apply(points), gear), 0.06 * gear.transverse_module
        sides = [located.deviation[(located.surface == FLANK) & (located.side == side)] for side in Side]
        return min((float(np.minimum(np.abs(off - np.median(off)), far).mean()) for off in sides if len(off)), default=np.inf)

    return min((pose, _settle(points, gear, pose.then(flip(gear.face_width)), free)), key=misfit)


def _robust_step(points: Floats, gear: Gear, pose: Pose, free: Bools, floor: float) -> tuple[Pose, float]:
    """One Gauss-Newton step with Tukey weights; returns the step's size in mm at the tip circle."""
    located = locate(pose.apply(points), gear)
    known = np.flatnonzero((located.surface != OTHER) if free[2] else (located.surface < END_LOW))
    if len(known) < 30:
        return pose, 0.0
    position, normal, deviation = (of.take(known, axis=0) for of in (located.position, located.normal, located.deviation))
    columns = np.hstack([motion_columns(position, normal)[:, free], np.ones((len(known), 1))])
    centre, scale = median_scale(deviation)
    weight = tukey_weight(deviation - centre, max(scale, floor, 1e-9))
    motion = solved(columns, -deviation, weight)
    full = np.zeros(6)
    full[free] = motion[:-1]
    limit = 0.2 * gear.transverse_module  # a step this far is a guess, not a correction
    size = size_of_motion(full, gear.tip_radius)
    if size > limit:
        full *= limit / size
    return pose.then(small_motion(full)), size


def refine(
    points: Floats, gear: Gear, pose: Pose, planar: bool = False, ignore: frozenset[int] = frozenset()
) -> tuple[Registration, SurfacePoints]:
    """Fit the whole scan's cell means on the datum surfaces from a pose that is nearly right, and say how well it is known.

    Parameters and errors as `register`; `ignore` are codes of surfaces that are no datum. The second result is the scan located in the
    pose found.
    """
    free = _free(planar)
    located = locate(pose.apply(points), gear)
    bands = narrowed_bands(located, gear)
    if not planar and gear.spec.gap == 0.0 and np.isinf([bands.end_low[0], bands.end_high[0]]).all():
        pose = _centred(located, gear, pose)
        located = locate(pose.apply(points), gear)  # ends that lay farther off than such points count are seen now
        bands = narrowed_bands(located, gear)
    fitting = _check_fit(located, points, gear, planar)
    grid = CellGrid.for_scan(gear, int((located.surface != OTHER).sum()), planar=planar)
    located = locate(pose.apply(points), gear, bands)
    cells = bin_points(located, grid, clip=stray_limit(located))
    datum = choose_datum(cells, noise(cells), ignore)
    for pass_ in range(MOST_PASSES):  # each pass relocates every point: what the one before linearised is then exact
        fit = fit_cells(cells, datum, free)
        pose = pose.then(small_motion(fit.motion))
        located = locate(pose.apply(points), gear, bands)
        cells = bin_points(located, grid, clip=stray_limit(located))
        datum = choose_datum(cells, noise(cells), ignore)
        if pass_ > 0 and fit.step < REPEATED_TO_MODULES * gear.transverse_module:
            break
    registration = _known(pose, cells, datum, free, fit, bands, fitting)
    return registration, located


def refit(registration: Registration, cells: Cells, ignore: frozenset[int] = frozenset()) -> tuple[Registration, Cells, Pose]:
    """A registration of a sample, refined by the cells of the whole scan, which were binned in its pose; these moved along, and the motion.

    Parameters
    ----------
    registration : Registration
    cells : Cells
    ignore
        As `refine`.

    Notes
    -----
    The cells are moved to first order: of a step of 1 µm that is 1e-8 mm off.
    """
    free = _free(False)
    datum = choose_datum(cells, noise(cells), ignore)
    fit = fit_cells(cells, datum, free)
    back = small_motion(fit.motion)
    pose = registration.pose.then(back)
    cells = cells.with_deviation(cells.points.deviation + cells.motion @ fit.motion)
    refitted = _known(pose, cells, datum, free, fit, registration.bands, registration.fitting)
    return refitted, cells, back


def _known(pose: Pose, cells: Cells, datum: Datum, free: Bools, fit: CellFit, bands: Bands, fitting: float) -> Registration:
    """A pose with how well it is known, and what a reader must know of it."""
    planar, gear = not free[2], cells.grid.gear
    if not fit.step < gear.transverse_module:
        raise InputError(
            f"the surfaces that were seen do not hold the gear in its place: the last step of the registration was {fit.step:.2g} mm; a scan with the flanks of "
            "some teeth would be right"
        )
    observed = np.diag(fit.covariance) > 0.0
    # Whether a doubtful side is worn the scan does not tell, so how far the pose hangs on it is not known either. Asked only of bends that noise
    # could not make, a scan too coarse to show the wear of a side would know its pose better than a fine one.
    without = tuple((side, _motion_without(cells, datum, side, free)) for side in datum.doubtful)
    farthest = max((motion for _, motion in without), key=lambda motion: abs(motion[5]), default=np.zeros(6))
    covariance = fit.covariance + np.outer(farthest, farthest)
    unsettled, unseen = list[str](), list[str]()
    if fitting < 0.8:
        unsettled.append(f"only {100 * fitting:.0f} % of the points lie on the design: the rest was left out")
    if not observed[2] and not planar:
        height = "no end face was seen: the height is centred on what was seen and its uncertainty is not known"
        if has_screw(gear):
            height += "; along helical teeth height and turn go together, and the turn is stated for this height"
        unseen.append(height)
    known = size_of_motion(np.sqrt(np.diag(covariance)), gear.tip_radius)
    converged = bool(fit.step < max(LAST_STEP[0] * gear.transverse_module, LAST_STEP[1] * known))
    if not converged:
        unsettled.insert(0, f"the registration did not settle: the last step was {1e3 * fit.step:.2f} µm")
    return Registration(
        pose=pose,
        converged=converged,
        covariance=covariance,
        observed=observed,
        datum=datum,
        offset=fit.offset,
        bands=bands,
        noise=noise(cells),
        fitting=fitting,
        unsettled=tuple(unsettled),
        unseen=tuple(unseen),
        without=without,
    )


def _motion_without(cells: Cells, datum: Datum, side: Side, free: Bools) -> Floats:
    """(6,) how the pose moves if the flanks of a side are no datum, mm and rad; zero where no others are in use."""
    flank = (cells.points.surface == FLANK) & cells.seen & datum.mask
    its = flank & (cells.points.side == side)
    if not its.any() or its.sum() == flank.sum():
        return np.zeros(6)
    return fit_cells(cells, replace(datum, mask=datum.mask & ~its), free).motion


def _centred(located: SurfacePoints, gear: Gear, pose: Pose) -> Pose:
    """`pose` with the middle of what was seen at mid-face, or where it is between the edges of the ends."""
    seen, (low_edge, high_edge) = located.position[located.surface != OTHER, 2], map(min, gear.spec.end_edges)
    low, high = np.quantile(seen, [0.002, 0.998]) if len(seen) else (low_edge, gear.face_width - high_edge)
    return along_screw(pose, gear, 0.5 * float(gear.face_width - (low - low_edge) - (high + high_edge)))


def stray_limit(located: SurfacePoints) -> float:
    """How far from its cell's centre a point may lie: far outside the scatter of the whole scan's better half."""
    scale = median_scale(located.deviation[located.surface == FILLET])[1]
    if not np.isfinite(scale):
        scale = median_scale(located.deviation)[1]
    return 6.0 * max(scale, 1e-6)


def _check_fit(located: SurfacePoints, points: Floats, gear: Gear, planar: bool) -> float:
    """Share of points near their surface's own median; refuses a scan that is of something else."""
    on = located.surface != OTHER
    m = gear.transverse_module
    good = 0
    for surface in (FLANK, FILLET, ROOT, TIP, END_LOW, END_HIGH, BORE):
        d = located.deviation[located.surface == surface]
        if len(d):
            centre, scale = median_scale(d)
            near = min(max(0.05 * m, 3.0 * scale), 0.15 * m)  # a distorted scan is still of this gear
            good += int((np.abs(d - centre) < near).sum())
    share = good / max(int(on.sum()), 1)
    placed = float(on.mean())
    if share < LEAST_SHARE_ON_DESIGN or placed < 0.25:
        raise NotThisGear(
            points,
            planar,
            f"the scan does not fit the design: {100 * share * placed:.0f} % of its points lie on it; the design has {gear.teeth} teeth{helix_words(gear)} and tip "
            f"diameter {2 * gear.tip_radius:.2f} mm; check the design, part and units",
        )
    return share * placed


def narrowed_bands(located: SurfacePoints, gear: Gear) -> Bands:
    """Bands of the round and plane surfaces from the scan's own scatter on them: centre ± 6 robust standard deviations.

    An end face that was not seen takes no points: the edges of tooth sides that reach to about its height would pass for it.
    """
    wide = Bands.wide(gear)

    def band(surface: int, start: tuple[float, float]) -> tuple[float, float]:
        centre, scale = median_scale(located.deviation[located.surface == surface])
        if not np.isfinite(centre):
            return start
        half = max(6.0 * scale, 1e-4 * gear.transverse_module)
        return max(start[0], centre - half), max(min(start[1], centre + half), centre + half)

    def face(surface: int, start: tuple[float, float]) -> tuple[float, float]:
        return band(surface, start) if _inside_outline(located, surface, gear) else (np.inf, start[1])

    return replace(
        wide, tip=band(TIP, wide.tip), root=band(ROOT, wide.root), bore=band(BORE, wide.bore),
        end_low=face(END_LOW, wide.end_low), end_high=face(END_HIGH, wide.end_high),
    )  # fmt: skip


def _inside_outline(located: SurfacePoints, end: int, gear: Gear) -> bool:
    """Whether an end face was seen: a good part of its points lie far inside the outline, where edges of a distorted scan do not."""
    foot = untwisted(gear, located.position[located.surface == end])
    side = locate(np.column_stack([foot[:, :2], np.full(len(foot), drawn_height(gear))]), gear)
    inside = int((~(side.deviation > -0.2 * gear.transverse_module)).sum())  # nan: deeper than any side
    return inside >= max(LEAST_ON_FACE, len(foot) // 5)


@dataclass(frozen=True, slots=True)
class CellFit:
    """A small motion that lays cells on the datum surfaces.

    Parameters
    ----------
    motion : (6,) float
        To be applied to the points: mm and rad.
    covariance : (6, 6) float
        Sandwich, clustered by tooth, surface and side; zero rows for motions that are not seen.
    offset : float
        Common offset of the datum, mm.
    step : float
        Size of the motion at the tip circle, mm.
    """

    motion: Floats
    covariance: Floats
    offset: float
    step: float


def fit_cells(cells: Cells, datum: Datum, free: Bools) -> CellFit:
    """Robust fit of a small motion to cell means on the datum surfaces.

    Raises
    ------
    InputError
        If too few cells hold enough points.
    """
    usual = float(np.median(cells.count[cells.seen])) if cells.seen.any() else 0.0
    part = np.flatnonzero(cells.seen & datum.mask & (cells.count >= max(2.0, 0.2 * usual)))
    surface = cells.points.surface[part]
    low, high = surface == END_LOW, surface == END_HIGH
    if has_screw(cells.grid.gear) and not (low | high).any():
        free = free & ~HEIGHT  # without an end face the screw is not seen: the height is held, and the turn known for it
    moving = int(free.sum())
    if len(part) <= moving + 1:
        raise InputError(
            f"{len(part)} cells of the surfaces that fix the gear's place hold enough points: at least {moving + 2} are needed, from a denser scan or "
            "one of more of the gear"
        )
    parts = [cells.motion[part][:, free], np.ones((len(part), 1))]
    d = cells.points.deviation[part]
    start = [*np.zeros(moving), np.median(d)]
    if low.any() and high.any():  # how far apart they are is no affair of the pose's: thin teeth would pull z to one of them
        parts.append((low | high)[:, None].astype(np.float64))
        start.append(np.median(d[low | high]) - start[-1])
    columns, solution = np.hstack(parts), np.array(start)
    base = np.sqrt(np.minimum(cells.count[part], np.median(cells.count[part])))
    for _ in range(30):
        residual = d - columns @ solution
        scale = max(median_scale(residual)[1], 1e-9)
        weight = tukey_weight(residual, scale) * base
        new = solved(columns, d, weight)
        moved = float(np.abs(new - solution).max())
        solution = new
        if moved < 1e-10:
            break
    residual = d - columns @ solution
    sandwich = clustered(columns, weight * residual, tukey_slope(residual, scale) * base, cells.part[part])
    motion, covariance = np.zeros(6), np.zeros((6, 6))
    motion[free] = -solution[:moving]
    covariance[np.ix_(free, free)] = sandwich[:moving, :moving]
    return CellFit(motion, covariance, float(solution[moving]), size_of_motion(motion, cells.grid.gear.tip_radius))
