"""The edge between flanks and tips as it is, where it is not the design's: chamfered or rounded on all teeth, and not stated so.

Points of a chamfer that nobody drew lie tenths of a millimetre below the flank that is drawn up to the tip, as deep wear does. A straight bevel that
begins at one height on the flanks of either side of all teeth was cut; what lies past its beginning is no flank.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from gearwear.arrays import Bools, Floats, Ints
from gearwear.design.gear import Gear
from gearwear.design.surface import FLANK, OTHER, TIP, Bands, SurfacePoints, locate
from gearwear.design.twist import section_angle
from gearwear.errors import InputError

REACH = 0.6
"""Modules below the tip that are looked at, and no more than this share of the flank's height: longer bevels are none of an edge's."""
STEP = 0.02
"""Height of a bin, modules."""
OVER = 3
"""Bins over which a slope is taken."""
STEEPEST_FLANK = 0.1
"""By how much a flank falls per height, reliefs and wear by sliding with it: 60 µm over half a millimetre. A bevel of 45° on a flank that leans by 40° falls
by 0.12, one with equal legs by 0.5."""
LEAST_DEPTH, LEAST_SMOOTHED = 0.05, 0.015
"""Depth, mm, at the tip from which on a bevel is one: a scanner's spot rounds edges by less. Those of a scan that was smoothed are rounded for certain, on every
tooth, and three times what an edge has begun by (`DEPARTED`) shows how far."""
LEAST_IN_BIN = 20
"""Points in a bin, of one side of all teeth, that have a median."""
ABOVE = 0.02
"""Quantile of the points' heights that is taken for the tip: land, strays apart."""
OFF_LAND, OFF_LAND_STDS = 0.01, 4.0
"""Nearer to the tip, in modules and in standard deviations of a point, lies the land."""
BESIDE = 8
"""Bins past the steep ones that say where the flank goes."""
DEPARTED = 0.005
"""How far below the flank, mm, an edge has begun."""
BEFORE = 1
"""Bins by which the land, and flanks next to edges of the ends, are taken to end before."""
AS_DRAWN = 0.04
"""Height, in modules, by which an edge that is drawn may begin earlier than drawn and still be that: two bins."""
MOST_SHARE = 0.75
"""Share of the flanks that must fall by half of what they do in the median: an edge that some teeth have is worn or broken."""
LEAST_ON_FLANK = 5
"""Points past the beginning and as far before it that tell whether one flank does."""


@dataclass(frozen=True, slots=True)
class TipEdge:
    """What the scan shows of the edge between flanks and tips.

    Parameters
    ----------
    gear : Gear
        The design, its flanks ending where they are seen to.
    height : float
        How far below the tip drawn they end, mm; 0 where the edge is the design's, or too little of it was seen.
    depth : float
        How far the edge lies below the flank, drawn on, at the tip, mm.
    """

    gear: Gear
    height: float = 0.0
    depth: float = 0.0

    @property
    def fits_design(self) -> bool:
        """Whether nothing but the design's edge was seen."""
        return self.height == 0.0

    def words(self) -> str:
        """What is said of it, in one line; "" where the design's fits."""
        if self.fits_design:
            return ""
        return (
            f"the edges between flanks and tips are not those of the design: on all teeth they are chamfered or rounded from {self.height:.2f} mm below the tip on, "
            f"{1e3 * self.depth:.0f} µm deep there; flanks are taken to end where that begins"
        )


def fit_tip_edge(located: SurfacePoints, gear: Gear, noise: float, smoothed: bool = False) -> TipEdge:
    """Find where the flanks of all teeth end.

    Parameters
    ----------
    located : SurfacePoints
        Points on the design, in a pose that is about right.
    gear : Gear
        The design.
    noise : float
        Scatter of points, mm.
    smoothed : bool
        Whether the scan was smoothed: edges are rounded then, by however little.

    Notes
    -----
    The deviation from a flank that is drawn up to the tip has a median, bin by bin of height and side by side, over all teeth. From the tip down, as long as it
    falls towards the tip on both sides by more than flanks do (`STEEPEST_FLANK`), it is an edge: wear of one side is steep on that side alone, and levels of
    flanks, their slopes and reliefs are in no slope of that size.
    """
    m, way = gear.transverse_module, gear.orientation
    points = _near_tips(located, gear)
    flank = _on_sharp(points, gear)
    height = way * (gear.tip_radius - np.hypot(flank.measured[:, 0], flank.measured[:, 1]))
    if len(height) < LEAST_IN_BIN:
        return TipEdge(gear)
    top = float(np.quantile(height, ABOVE))
    first = top + max(OFF_LAND * m, OFF_LAND_STDS * noise)
    reach = min(REACH * m, REACH * way * (gear.tip_radius - gear.form_radius))
    edges = np.asarray(first + STEP * m * np.arange(int((top + reach - first) / (STEP * m)) + 1), dtype=np.float64)
    profiles = [medians(height[on], flank.deviation[on], edges) for on in (flank.side > 0, flank.side < 0)]
    fall = np.min([(one[OVER:] - one[:-OVER]) / (OVER * STEP * m) for one in profiles], axis=0)  # from the tip down
    steep = np.flatnonzero(~(fall > STEEPEST_FLANK))
    count = int(steep[0]) if len(steep) else 0
    if not count:
        return TipEdge(gear)
    last = count + OVER - 1
    depth = float(min(one[last] - one[0] for one in profiles))
    begins = float(edges[max(departs(one, last) for one in profiles) + 1])
    known = way * (gear.tip_radius - gear.flank_end_radius)
    if (
        depth < least_depth(smoothed)
        or begins <= known + AS_DRAWN * m
        or not (smoothed or _of_all(flank, height, first, begins, depth))
    ):
        return TipEdge(gear)
    if smoothed:
        begins = rounded_to(begins, depth)
    # Where the land is not seen to end, it ends 45° up from where the flank does.
    land = _land(points, gear, top)
    half = float(gear.half_angle(gear.tip_radius - way * begins))
    leg = None if land is None else max(half * gear.tip_radius - land + BEFORE * STEP * m, 0.0)
    try:
        ends = gear.recut(tip_chamfer=begins, tip_chamfer_land=leg, tip_rounding=0.0)
    except InputError:  # it leans so far that no chamfer of 45° ends there
        return TipEdge(gear)
    ends_at = ends.tip_half_angle if land is None else land / gear.tip_radius
    return TipEdge(ends, begins, gear.base_radius * (float(gear.half_angle(gear.tip_radius)) - ends_at))


def least_depth(smoothed: bool) -> float:
    """How deep an edge is at least that is one, mm."""
    return LEAST_SMOOTHED if smoothed else LEAST_DEPTH


def rounded_to(begins: float, depth: float) -> float:
    """How far from an edge the rounding by a mean over neighbours ends, mm, that is `depth` deep there and deeper than `DEPARTED` as far as it `begins`: it
    fades as a parabola (`edge_rounding`), which is below any threshold before it ends."""
    return begins / (1.0 - math.sqrt(DEPARTED / depth))


def _near_tips(located: SurfacePoints, gear: Gear) -> Floats:
    """(n, 3) points of tips and of what is next to them, mm; those next to the ends apart."""
    points, m = located.measured, gear.transverse_module
    margin = max(0.05 * m, gear.spec.end_edge)
    near = np.isin(located.surface, (FLANK, TIP, OTHER))
    near &= gear.orientation * (gear.tip_radius - np.hypot(points[:, 0], points[:, 1])) < (REACH + 0.2) * m
    near &= (points[:, 2] > margin) & (points[:, 2] < gear.face_width - margin)
    return np.asarray(points[near], dtype=np.float64)


def _land(points: Floats, gear: Gear, top: float) -> float | None:
    """Half the width of the lands of all teeth, mm along the tip circle: as far out as their points lie no lower than `top` mm below the tip, as those in
    the middle do; None where too few are seen."""
    m, half = gear.transverse_module, float(gear.half_angle(gear.tip_radius)) * gear.tip_radius
    height = gear.orientation * (gear.tip_radius - np.hypot(points[:, 0], points[:, 1]))
    angle = np.remainder(section_angle(gear, *points.T) + 0.5 * gear.pitch_angle, gear.pitch_angle) - 0.5 * gear.pitch_angle
    edges = np.asarray(STEP * m * np.arange(int(half / (STEP * m)) + 1), dtype=np.float64)
    on = height < top + REACH * m
    profile = medians(gear.tip_radius * np.abs(angle[on]), -height[on], edges)
    middle = float(np.nanmedian(profile[: max(len(profile) // 4, 1)])) if np.isfinite(profile).any() else math.nan
    low = np.flatnonzero(profile < middle - DEPARTED)
    return float(edges[low[0]]) if math.isfinite(middle) and len(low) and low[0] > BEFORE else None


def _on_sharp(points: Floats, gear: Gear) -> SurfacePoints:
    """Points near the tips on flanks that are drawn up to these, whatever edge the design has; of lands too, which lie deep below."""
    return on_flanks_alone(points, gear.recut(tip_chamfer=0.0, tip_chamfer_land=None, tip_rounding=0.0))


def on_flanks_alone(points: Floats, gear: Gear) -> SurfacePoints:
    """Those of points (n, 3) that lie on flanks where these end at no tip and no end of the face."""
    never = (math.inf, math.inf)
    found = locate(points, gear, replace(Bands.wide(gear), tip=never, end_low=never, end_high=never))
    return found.take(found.surface == FLANK)


def medians(height: Floats, deviation: Floats, edges: Floats) -> Floats:
    """Median of the deviations bin by bin of height, nan where there are too few."""
    order = np.argsort(height, kind="stable")
    cuts = np.searchsorted(height[order], edges)
    parts = [deviation[order[start:stop]] for start, stop in pairwise(cuts)]
    return np.array([np.median(part) if len(part) >= LEAST_IN_BIN else math.nan for part in parts])


def departs(profile: Floats, last: int) -> int:
    """The bin furthest from the tip that lies below the line through those next to the steep ones, of which `last` is the furthest."""
    bins = np.arange(len(profile))
    beside = (bins > last) & (bins <= last + BESIDE) & np.isfinite(profile)
    if beside.sum() < 3:
        return last
    line = np.polynomial.Polynomial.fit(bins[beside], profile[beside], 1)
    off = profile - line(bins)
    below = np.flatnonzero((bins <= last) & (off < -max(DEPARTED, 4.0 * float(off[beside].std()))))
    return int(below.max(initial=0))


def _of_all(flank: SurfacePoints, height: Floats, first: float, begins: float, depth: float) -> bool:
    """Whether flanks of nearly all teeth fall from where it `begins` to the tip: by half of what half the way there is deep in the median."""
    which = flank.tooth.astype(np.int64) * 2 + (flank.side > 0)
    middle = 0.5 * (first + begins)
    past, before = ((height > low) & (height < high) for low, high in ((first, middle), (begins, begins + middle - first)))
    number = int(which.max(initial=0)) + 1
    counts, means = zip(*(_means(which[on], flank.deviation[on], number) for on in (past, before)), strict=True)
    enough: Bools = (counts[0] >= LEAST_ON_FLANK) & (counts[1] >= LEAST_ON_FLANK)
    return bool(enough.any() and ((means[1] - means[0])[enough] > 0.375 * depth).mean() >= MOST_SHARE)


def _means(which: Ints, values: Floats, number: int) -> tuple[Ints, Floats]:
    """Points of each flank, and their mean."""
    count = np.bincount(which, minlength=number)
    return count, np.bincount(which, values, number) / np.maximum(count, 1)
