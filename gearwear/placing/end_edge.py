"""The edges between flanks and the ends of the face as they are, where they are not the design's: chamfered or rounded on all teeth, and not stated so.

As those of the tips (`tip_edge`): what falls off towards an end, on flanks of both sides of all teeth and steeper than flanks do, was cut; nearer to that end
there is no flank. A tool breaks the edges of both sides, at one end or at both; of helical teeth it takes more off the acute ones, or these alone, which lie at
either end of the face on either side. Wear is on the side that carries.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from gearwear.arrays import Bools, Floats, Ints
from gearwear.design.gear import Gear
from gearwear.design.side import Side
from gearwear.design.surface import END_HIGH, END_LOW, FLANK, OTHER, SurfacePoints
from gearwear.placing.tip_edge import (
    ABOVE,
    AS_DRAWN,
    BEFORE,
    BESIDE,
    LEAST_IN_BIN,
    MOST_SHARE,
    OFF_LAND,
    OFF_LAND_STDS,
    OVER,
    STEEPEST_FLANK,
    STEP,
    departs,
    least_depth,
    on_flanks_alone,
    rounded_to,
)

REACH, REACH_SHARE = 1.0, 0.2
"""Modules from an end that are looked at, and no more than this share of the face: what is longer is none of an edge's."""
HEIGHTS = (0.1, 0.8)
"""Shares of a flank's height between which it is looked at: not where edges of the tips meet those of the ends."""
STEEPEST_EDGE = 3.0
"""By how much an edge falls per distance from its end, 72°: steeper is the end itself, where it is not plane."""
LEAST_ON_FLANK = 3
"""Points on the edge, and as many further in, that tell whether one flank has it."""

Places = tuple[tuple[float, float], tuple[float, float]]


@dataclass(frozen=True, slots=True)
class EndEdge:
    """What the scan shows of the edges at the ends.

    Parameters
    ----------
    gear : Gear
        The design, its flanks ending where they are seen to.
    reach, depth : ((float, float), (float, float))
        How far edges that the design does not have reach from the low and from the high end, and how far they lie below the flank there, mm, on left and on
        right flanks; 0 where the edge is the design's, or too little of it was seen.
    """

    gear: Gear
    reach: Places = ((0.0, 0.0), (0.0, 0.0))
    depth: Places = ((0.0, 0.0), (0.0, 0.0))

    @property
    def fits_design(self) -> bool:
        """Whether nothing but the design's edges was seen."""
        return not np.any(self.reach)

    def words(self) -> str:
        """What is said of it, in one line; "" where the design's fit."""
        if self.fits_design:
            return ""
        ends = [end for end, found in zip(("low", "high"), self.reach, strict=True) if any(found)]
        reach = sorted({f"{value:.2f}" for end in self.reach for value in end if value > 0.0})
        where = "both ends" if len(ends) == 2 else f"the {ends[0]} end"
        depth = 1e3 * max(map(max, self.depth))
        return (
            f"the edges of the flanks at {where} of the face are not those of the design: on all teeth they are chamfered or rounded "
            f"over {' to '.join(dict.fromkeys((reach[0], reach[-1])))} mm, up to {depth:.0f} µm deep; flanks are taken to end where that begins"
        )


def fit_end_edge(located: SurfacePoints, gear: Gear, noise: float, smoothed: bool = False) -> EndEdge:
    """Find where the flanks of all teeth end along the face.

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
    As `fit_tip_edge`, with each flank's deviation about its own further in, bin by bin of the distance from an end.
    """
    reach = min(REACH * gear.transverse_module, REACH_SHARE * gear.face_width)
    flank = _to_the_ends(located, gear, 2.0 * reach)
    z = flank.measured[:, 2]
    found = np.zeros((2, 2, 2))
    for end, height in enumerate((z, gear.face_width - z)):
        near = height < 2.0 * reach
        if near.sum() < LEAST_IN_BIN:
            continue
        first = float(np.quantile(height[near], ABOVE)) + max(OFF_LAND * gear.transverse_module, OFF_LAND_STDS * noise)
        for side in Side:
            on = near & (flank.side == int(side))
            found[:, end, side.index] = _edge(
                flank.tooth[on], flank.deviation[on], height[on], first, first + reach, gear, smoothed
            )
    drawn = np.array(gear.spec.end_edges)
    found[:, (found[1] < least_depth(smoothed)) | (found[0] <= drawn + AS_DRAWN * gear.transverse_module)] = 0.0
    there = found[0] > 0.0
    # Of the other side there is one at the same end, or at the other.
    found[:, ~(there & (there[:, ::-1] | there[::-1, ::-1]))] = 0.0
    if not found.any():
        return EndEdge(gear)
    past = np.where((found[0] > 0.0) | (drawn > 0.0), np.maximum(drawn, found[0]) + BEFORE * STEP * gear.transverse_module, 0.0)
    return EndEdge(gear.recut(ends_seen=_places(past)), _places(found[0]), _places(found[1]))


def _places(values: Floats) -> Places:
    (a, b), (c, d) = values.tolist()
    return (a, b), (c, d)


def _to_the_ends(located: SurfacePoints, gear: Gear, reach: float) -> SurfacePoints:
    """Points within `reach` mm of the ends on flanks that go on to these, whatever edges the design has; of the ends too, which lie deep below."""
    points = located.measured
    share = (np.hypot(points[:, 0], points[:, 1]) - gear.form_radius) / (gear.flank_end_radius - gear.form_radius)
    near = np.isin(located.surface, (FLANK, END_LOW, END_HIGH, OTHER)) & (share > HEIGHTS[0]) & (share < HEIGHTS[1])
    near &= (points[:, 2] < reach) | (points[:, 2] > gear.face_width - reach)
    return on_flanks_alone(points[near], gear.recut(end_chamfer=0.0, end_rounding=0.0, ends_seen=None))


def _edge(
    tooth: Ints, deviation: Floats, height: Floats, first: float, last: float, gear: Gear, smoothed: bool
) -> tuple[float, float]:
    """How far from an end the edge of a side begins, and how deep it is next to the end, mm; zeros where there is none."""
    level, there = _levels(tooth, deviation, height > last, gear.teeth)
    on = there[tooth] & (height < last)
    tooth, height = tooth[on], height[on]
    deviation = deviation[on] - level[tooth]
    cuts, middles, profile = _profile(height, deviation, first, STEP * gear.transverse_module)
    face = np.flatnonzero(np.diff(profile) > STEEPEST_EDGE * np.diff(middles)).max(initial=-1) + 1
    cuts, middles, profile = cuts[face:], middles[face:], profile[face:]
    if len(profile) < OVER + BESIDE:
        return 0.0, 0.0
    fall = (profile[OVER:] - profile[:-OVER]) / (middles[OVER:] - middles[:-OVER])  # from the end inwards
    flat = np.flatnonzero(~(fall > STEEPEST_FLANK))
    if not len(flat) or not flat[0]:
        return 0.0, 0.0
    steep = int(flat[0]) + OVER - 1
    begins, depth = float(cuts[departs(profile, steep) + 1]), float(profile[steep] - profile[0])
    past = (height > cuts[0]) & (height < begins)
    mean, seen = _levels(tooth, deviation, past, gear.teeth)
    typical = float(np.median(mean[seen])) if seen.any() else 0.0
    if not typical < 0.0 or not (smoothed or (mean[seen] < 0.5 * typical).mean() >= MOST_SHARE):
        return 0.0, 0.0
    return rounded_to(begins, depth) if smoothed else begins, depth


def _profile(height: Floats, deviation: Floats, first: float, step: float) -> tuple[Floats, Floats, Floats]:
    """Bins from `first` on, of `LEAST_IN_BIN` points and a `step` at least: where they end, (n + 1,), their mean heights and median deviations, (n,), mm."""
    order = np.argsort(height, kind="stable")
    height, deviation = height[order], deviation[order]
    cuts = [int(np.searchsorted(height, first))]
    while cuts[-1] < len(height) and (
        stop := max(cuts[-1] + LEAST_IN_BIN, int(np.searchsorted(height, height[cuts[-1]] + step)))
    ) < len(height):
        cuts.append(stop)
    bins = [slice(*pair) for pair in pairwise(cuts)]
    cuts = cuts if cuts[-1] < len(height) else []
    return height[cuts], np.array([height[one].mean() for one in bins]), np.array([np.median(deviation[one]) for one in bins])


def _levels(tooth: Ints, deviation: Floats, where: Bools, teeth: int) -> tuple[Floats, Bools]:
    """Median deviation of each tooth's points, and which teeth have enough of them."""
    result, enough = np.zeros(teeth), np.zeros(teeth, dtype=np.bool_)
    for one in range(teeth):
        own = deviation[where & (tooth == one)]
        enough[one] = len(own) >= LEAST_ON_FLANK
        if enough[one]:
            result[one] = float(np.median(own))
    return result, enough
