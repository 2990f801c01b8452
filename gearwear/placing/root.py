"""The root as it is: the rack that generated it, where the design's is another one or none is stated.

A drawing seldom says how a root was cut, and a fillet that is taken for known where it is not bends the pose, the thickness and the
wear. The teeth share their root, so its shape is known from all of them together: where the design's does not fit, the tip radius and
the dedendum of a rack that do are looked for, and where none fits the root is free and no datum.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from gearwear.arrays import Bools, Floats
from gearwear.design.gear import Gear
from gearwear.design.surface import FILLET, FLANK, OTHER, ROOT, Bands, SurfacePoints, locate
from gearwear.design.twist import from_end, section_angle
from gearwear.errors import InputError
from gearwear.robust import median, some_of

SAMPLE = 8_000
"""Points of the root that a candidate is tried on."""
LEAST_POINTS = 200
"""Fewer say nothing of the root."""
DOWN = 0.1
"""Modules below the form circle from where on points are a root's: nearer to it they may be the last of a flank, by chance."""
BINS = 12
"""Bins along the root, equally filled: what is common to all teeth is the median in each."""
LOST = 0.2
"""Modules that a point on no surface of the gear tried is taken to lie off it."""
MISFIT = 0.0015
"""Of the common shape, in modules, from which on another root than the design's is looked for: 4 µm at module 2.5."""
BETTER = 0.5
"""Share of the design's misfit that another root must come down to: scanner errors and shifted racks bend a fillet too."""
UNLIKE = 0.004
"""Misfit, in modules, from which on no round rack tip is said to have made the root: 10 µm at module 2.5."""
LEFT_BY_LEVELS = 0.1
"""Share of how far a root is from the design's that a level for each column of cells leaves: 5 to 10 µm of the 113 and 127 µm of roots ground or cut with protuberance
(family a of benchmarks/families)."""
SEEN = 0.05
"""Share of the points of a bin below which one side of the spaces was not seen there."""
STEPS = 12
"""Of the golden section for the tip radius, after the grid."""


@dataclass(frozen=True, slots=True)
class Root:
    """What the scan shows of the root.

    Parameters
    ----------
    gear : Gear
        The design, with the root that fits.
    seen : bool
        False where too little of the root was seen: the design's is kept.
    fits_design : bool
        Whether the design's root fits.
    rack_tip_radius, dedendum : float or None
        Of the rack that fits, in modules; None where none does.
    misfit : float
        RMS of the common shape of the root against `gear`, mm; nan where it was not seen.
    design_misfit : float
        The same against the design.
    """

    gear: Gear
    seen: bool
    fits_design: bool
    rack_tip_radius: float | None
    dedendum: float | None
    misfit: float
    design_misfit: float

    @property
    def free(self) -> bool:
        """Whether the root is one that no round rack tip generates: it is no datum then."""
        return self.seen and self.rack_tip_radius is None

    def told_by_levels(self, noise: float) -> bool:
        """Whether levels for the columns of a fillet leave less than the `noise` (mm) of how far it is off."""
        return not (self.free and LEFT_BY_LEVELS * self.design_misfit > noise)

    def words(self) -> str:
        """What is said of it, in one line; "" where the design's fits."""
        if not self.seen or self.fits_design:
            return ""
        if self.gear.spec.internal:
            return self._ring_words()
        if self.rack_tip_radius is None:
            return (
                f"the root is not the one of the design, and no round rack tip generates it (off by {1e3 * self.design_misfit:.0f} µm RMS): "
                "it is free, and no datum"
            )
        other = "" if self.dedendum == self.gear.spec.dedendum else f" and a dedendum of {self.dedendum:.3f}"
        return f"the root is not the one of the design; a rack tip radius of {self.rack_tip_radius:.2f}{other} modules fits"

    def _ring_words(self) -> str:
        """The same of a ring, whose cutter may not be stated."""
        if not self.gear.root_stated:
            return self.gear.notes[0]
        return f"the root is not the one of the design (off by {1e3 * self.design_misfit:.0f} µm RMS): it is free, and no datum"


def fit_root(located: SurfacePoints, gear: Gear) -> Root:
    """Find the root that all teeth share.

    Parameters
    ----------
    located : SurfacePoints
        Points on the design, in a pose that is about right.
    gear : Gear
        The design.

    Returns
    -------
    Root

    Notes
    -----
    A candidate's misfit is the standard deviation, over bins along the root, of the median distance of the points from it: an even
    offset (a coat) is no other root, and as both sides of all teeth are in each median, neither pitch errors nor a turn are. The rack tip radius is searched from 0.05 modules to the full radius, with the design's dedendum
    and with the one that the root circle shows.
    """
    zone = _zone(located, gear)
    m = gear.transverse_module
    below = gear.orientation * (gear.form_radius - np.hypot(zone[:, 0], zone[:, 1]))
    if (below > DOWN * m).sum() < LEAST_POINTS:
        return Root(gear, False, True, gear.spec.rack_tip_radius, gear.spec.dedendum, float("nan"), float("nan"))
    misfit_of_design = _misfit(zone, gear)
    kept = Root(gear, True, True, gear.spec.rack_tip_radius, gear.spec.dedendum, misfit_of_design, misfit_of_design)
    if gear.spec.internal:  # what else cut it is not searched for
        fits = gear.root_stated and misfit_of_design <= UNLIKE * m
        return kept if fits else replace(kept, fits_design=False, rack_tip_radius=None, dedendum=None)
    if misfit_of_design <= MISFIT * m:
        return kept
    tried = [(misfit_of_design, gear)]
    for dedendum in dict.fromkeys((gear.spec.dedendum, _dedendum(zone, gear))):
        racks = [_with(gear, radius, dedendum) for radius in _radii(zone, gear, dedendum)]
        tried += [(_misfit(zone, fitted_rack), fitted_rack) for fitted_rack in racks if fitted_rack is not None]
    misfit, fitted = min(tried, key=lambda fitted_rack: fitted_rack[0])
    if misfit > UNLIKE * m:
        return Root(fitted, True, False, None, None, misfit, misfit_of_design)
    if misfit > BETTER * misfit_of_design:
        return kept
    return Root(fitted, True, False, fitted.spec.rack_tip_radius, fitted.spec.dedendum, misfit, misfit_of_design)


def _zone(located: SurfacePoints, gear: Gear) -> Floats:
    """(n, 3) points about the roots, in the design frame; not those of end faces, of their edges and of the bore."""
    position = located.position + located.normal * np.nan_to_num(located.deviation)[:, None]
    radius = np.hypot(position[:, 0], position[:, 1])
    m = gear.transverse_module
    near = np.isin(located.surface, (FILLET, ROOT, FLANK, OTHER)) & (gear.orientation * (radius - gear.form_radius) < 0.05 * m)
    near &= gear.orientation * (radius - gear.root_radius) > -0.3 * m
    edge = gear.spec.end_edge
    if edge > 0.0:  # chamfered or rounded ends are no root: so far from them points are located on no surface
        edge += Bands.wide(gear).end_high[1]
    edge = max(0.02 * m, edge)
    near &= (position[:, 2] > edge) & (position[:, 2] < gear.face_width - edge)
    if gear.spec.gap > 0.0:
        near &= from_end(gear, position[:, 2]) > 0.02 * m
    position, radius = position[near], radius[near]
    from_middle = np.abs(position[:, 2] - 0.5 * gear.face_width)
    return np.asarray(position[some_of(radius / m, from_middle / m, SAMPLE)], dtype=np.float64)


def _misfit(points: Floats, gear: Gear) -> float:
    """RMS of the common shape of the root against a gear's, mm."""
    located = locate(points, gear)
    on = np.isin(located.surface, (FILLET, ROOT))
    if on.sum() < LEAST_POINTS:
        return float("inf")
    deviation = np.nan_to_num(located.deviation[on])
    # The side of the space by the polar angle: bottom lands have no side of their own.
    is_left = np.remainder(section_angle(gear, *points[on].T), gear.pitch_angle) < 0.5 * gear.pitch_angle
    along = np.argsort(_along(located.position[on], gear), kind="stable")
    middles = np.array([_middle(deviation[part], is_left[part]) for part in np.array_split(along, BINS)])
    # What lies on no surface of this gear lies further off than any that does.
    lost = 1.0 - float(on.sum() + (located.surface == FLANK).sum()) / len(points)
    return float(np.hypot(middles.std(), lost * LOST * gear.transverse_module))


def _along(foot: Floats, gear: Gear) -> Floats:
    """How far along the root foot points (n, 3) lie, from the middle of the space on: across and up, mm; grows all the way to the flank.

    Of the foot points: the radii of the points themselves would sort those of a bottom land, which has one radius, by their errors.
    """
    from_middle = np.remainder(section_angle(gear, *foot.T), gear.pitch_angle) - 0.5 * gear.pitch_angle
    up = gear.orientation * (np.hypot(foot[:, 0], foot[:, 1]) - gear.root_radius)
    return np.asarray(up + gear.root_radius * np.abs(from_middle))


def _middle(deviation: Floats, is_left: Bools) -> float:
    """Median of either side, averaged: a turn takes from one what it gives to the other. A few strays are no side that was seen."""
    sides = [deviation[is_left], deviation[~is_left]]
    medians = [median(side) for side in sides if len(side) and len(side) >= SEEN * len(deviation)]
    return sum(medians) / len(medians)


def _dedendum(points: Floats, gear: Gear) -> float:
    """Dedendum of a rack that reaches the root circle the scan shows, in modules: the lowest points, strays apart."""
    seen = float(np.quantile(np.hypot(points[:, 0], points[:, 1]), 0.02))
    return gear.spec.dedendum - (seen - gear.root_radius) / gear.spec.normal_module


def _radii(points: Floats, gear: Gear, dedendum: float) -> list[float]:
    """Tip radii of the rack worth trying in full, in modules: the best of a grid, refined."""

    def misfit(radius: float) -> float:
        tried = _with(gear, radius, dedendum)
        return float("inf") if tried is None else _misfit(points, tried)

    grid = np.arange(0.05, 0.60, 0.05)
    values = [misfit(float(radius)) for radius in grid]
    if not np.isfinite(values).any():
        return []
    at = int(np.argmin(values))
    low, high = float(grid[max(at - 1, 0)]), float(grid[min(at + 1, len(grid) - 1)])
    golden = 0.6180339887498949
    a, b = high - golden * (high - low), low + golden * (high - low)
    fa, fb = misfit(a), misfit(b)
    for _ in range(STEPS):
        if fa < fb:
            high, b, fb = b, a, fa
            a = high - golden * (high - low)
            fa = misfit(a)
        else:
            low, a, fa = a, b, fb
            b = low + golden * (high - low)
            fb = misfit(b)
    return [0.5 * (low + high), float(grid[at])]


def _with(gear: Gear, rack_tip_radius: float, dedendum: float) -> Gear | None:
    """The gear cut by another rack; None where there is none such."""
    try:
        return gear.recut(rack_tip_radius=rack_tip_radius, dedendum=dedendum)
    except InputError:
        return None
