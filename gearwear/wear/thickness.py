"""Section thickness: the arc of every tooth at a radius, in every section across the face."""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from gearwear.arrays import Bools, Floats, Ints
from gearwear.design.card import Card, CardRow, few, measured
from gearwear.design.gear import Gear
from gearwear.design.involute import involute_function
from gearwear.design.quantity import NORMAL_95
from gearwear.design.surface import FLANK, SurfacePoints
from gearwear.design.twist import Segment, from_end, segments
from gearwear.placing.edges import at_either_end, fall_from_middle, least_drop
from gearwear.wear.least import Least, below, least_of_curves
from gearwear.wear.sections import ENOUGH_POINTS, surface_in_sections

STEP = 0.2
"""Default distance of the sections, mm (the paper's)."""
WINDOW = 0.1
"""Half width, in modules, of the band of arc round the radius whose points are averaged, where a section has enough of them."""
OVERLAP = 2
"""Pooled values to a width among which the least is looked for: two that are half a width apart have nothing in common (−0.02 of a parabola's
variance), though they share points."""
SLOPED = 2.0
"""Standard deviations, of their difference, that two values may differ by for having looked for the less of them."""
MEAN_OF = 5
"""Sections over which a mean may be taken."""
LEAST_SHARE_AT_ENDS = 0.5
"""Share of the points usual in a section that one at an end of the face must have on most teeth: flanks that end askew or are rounded off stop
short of it, and what is seen there is the edge."""


@dataclass(frozen=True, slots=True)
class ToothSummary:
    """Thickness of one tooth.

    Parameters
    ----------
    tooth : int
        0-based.
    nominal, mean, least : float
        Arc in mm; nan where the tooth was not seen on both sides.
    greatest_loss : float
        As-made − measured where it is greatest, mm.
    at_z : float
        Height of the least, mm.
    std : float
        Standard deviation of one section's arc, mm.
    least_std, loss_std : float
        Standard deviations of the least and of the greatest loss, mm.
    """

    tooth: int
    nominal: float
    mean: float
    least: float
    greatest_loss: float
    at_z: float
    std: float
    least_std: float = math.nan
    loss_std: float = math.nan

    @property
    def seen(self) -> bool:
        return math.isfinite(self.mean)


@dataclass(frozen=True, slots=True)
class ThinnestTooth:
    """The least thickness of the gear.

    Parameters
    ----------
    tooth : int
        0-based; the likeliest where several are about as thin.
    value, std : float
        Least true arc of all teeth, mm. Looking for the least of many noisy values finds one that is too small: that bias is taken off.
    low, high : float
        95 % interval, mm.
    at_z : float
        Height on that tooth, mm.
    """

    tooth: int
    value: float
    std: float
    low: float
    high: float
    at_z: float


@dataclass(frozen=True, repr=False)  # no slots: what is asked for again and again is kept
class SectionThickness(Card):
    """Transverse thickness of all teeth in all sections, at one radius.

    Parameters
    ----------
    radius : float
        mm.
    z : (n_z,) float
        Heights of the sections, mm.
    nominal : float
        Nominal arc, mm.
    arc : (teeth, n_z) float
        Measured arc, mm; nan where a side was not seen.
    flank : (teeth, 2, n_z) float
        Deviation of each side there, along its normal, mm.
    count : (teeth, 2, n_z) float
        Points averaged.
    std : (teeth, n_z) float
        Standard deviation of `arc` by the noise, mm.
    noise : float
        Scatter of points, mm.
    as_made : (teeth, n_z) float
        Arc of the gear as it was made, mm: what a loss is measured from. The nominal one unless `against` says otherwise.
    pooled : int
        Neighbouring sections whose points each value is from; 1 unless the scan is thin.
    pooled_on : (teeth,) int
        The same on each tooth: more where it was seen less well than most.
    bend : (teeth, n_z) float or None
        Where pooled sections are seen as parabolas along the face, not as their mean: what that changes, mm.
    texture, texture_step : float
        Variance of the texture's part of an arc, mm², and its correlation from one section to the next.
    common_std : float
        Standard deviation that all arcs share: of pose and effects, mm.
    unresolved : (teeth, n_z) float
        What the points of a section scatter beyond their noise, mm: the bottom of a pit narrower than a section may lie deeper by as much.
    """

    radius: float
    z: Floats
    nominal: float
    arc: Floats
    flank: Floats
    count: Floats
    std: Floats
    noise: float
    as_made: Floats
    pooled: int = 1
    texture: float = 0.0
    texture_step: float = 0.0
    common_std: float = 0.0
    unresolved: Floats | None = None
    pooled_on: Ints | None = None
    bend: Floats | None = None

    def headline(self) -> str:
        teeth = [tooth for tooth in self.teeth() if tooth.seen]
        if not teeth:
            return f"no tooth was seen on both sides at radius {self.radius:.3f} mm"
        worst = max(teeth, key=lambda tooth: tooth.greatest_loss)
        lost = measured(worst.greatest_loss, worst.loss_std, "mm")
        return f"arc at radius {self.radius:.3f} mm, nominal {self.nominal:.4f} mm; most lost: {lost}, tooth {worst.tooth + 1}"

    def rows(self) -> list[CardRow]:
        return few(
            [
                (
                    f"tooth {one.tooth + 1}",
                    f"mean {one.mean:.4f}, least {one.least:.4f} at z {one.at_z:.1f}, lost {one.greatest_loss:.4f} mm",
                )
                for one in self.teeth()
                if one.seen
            ],
            12,
        )

    def against(self, as_made: Floats) -> SectionThickness:
        """The same measurement with the loss counted from another arc, (teeth, n_z) mm."""
        return replace(self, as_made=as_made)

    @property
    def chord(self) -> Floats:
        """(teeth, n_z) chord 2 r sin(s / 2r), mm."""
        return np.asarray(2.0 * self.radius * np.sin(self.arc / (2.0 * self.radius)), dtype=np.float64)

    @property
    def lost(self) -> Floats:
        """(teeth, n_z) as-made − measured arc, mm."""
        return np.asarray(self.as_made - self.arc, dtype=np.float64)

    @property
    def bent(self) -> bool:
        """Whether pooled sections are parabolas along the face."""
        return self.bend is not None

    def known_to(self, texture: float, step: float, common_std: float) -> SectionThickness:
        """The same measurement with errors beside the noise of the points: see `texture`, `texture_step` and `common_std`."""
        return replace(self, texture=texture, texture_step=step, common_std=common_std)

    def _least(self, arc: Floats) -> tuple[Least, Floats, float]:
        """The least of curves over the sections, of each tooth and of all, with what is unresolved in its standard deviation; its height, (teeth,)
        mm; and the lowest value itself, less its standard deviation."""
        # Sections that have no errors in common, side by side; the rest of a row is empty.
        teeth, n = arc.shape
        widths = np.full(teeth, self.pooled) if self.pooled_on is None else self.pooled_on
        place = np.full((teeth, n), -1)
        for tooth, width in enumerate(widths):
            chosen = _side_by_side(n, int(width), self.bent)
            place[tooth, : len(chosen)] = chosen
        place = place[:, : int((place >= 0).sum(axis=1).max())]
        index = np.arange(teeth)[:, None], np.maximum(place, 0)
        curves = np.where(place >= 0, arc[index], np.nan)
        step = self.pooled / OVERLAP if self.bent else self.pooled
        found = least_of_curves(curves, self.std[index], self.texture, self.texture_step**step, MEAN_OF // self.pooled)
        rows = np.arange(len(arc))
        hidden = np.zeros(len(arc)) if self.unresolved is None else np.nan_to_num(self.unresolved[index])[rows, found.at]
        wide, at = np.pad(curves, ((0, 0), (1, 1)), constant_values=np.nan), found.at + 1
        deeper = below(wide[rows, at - 1], wide[rows, at], wide[rows, at + 1], self.std[index][rows, found.at])
        deeper = (0.0 if self.bent else deeper) + self._beyond(curves, place, found.at, widths)
        bend = np.zeros(len(arc)) if self.bend is None else self.bend[index][rows, found.at]
        std = np.sqrt(found.std**2 + hidden**2 + (0.5 * deeper) ** 2 + (0.5 * bend) ** 2 + self.common_std**2)
        deeper = deeper + hidden  # a hollow's bottom is one to two of its standard deviations below its mean
        own = found.curve
        overall = math.hypot(found.overall_std, hidden[own], 0.5 * (deeper[own] - hidden[own]), 0.5 * bend[own], self.common_std)
        value = found.overall - float(deeper[own])
        return (
            replace(found, value=found.value - deeper, std=std, overall=value, overall_std=overall),
            self.z[place[rows, found.at]],
            float(np.fmin.reduce(curves - self.std[index], axis=None)),  # nan, without a warning, where nothing was seen
        )

    def _beyond(self, curves: Floats, place: Ints, at: Ints, widths: Ints) -> Floats:
        """How far the end of the face lies below a least that is next to it, (teeth,) mm: on along the straight line from the value a width further
        in, by as much as the two differ beyond `SLOPED` standard deviations; the middle of pooled sections lies half their height off the end."""
        result = np.zeros(len(curves))
        for tooth, (own, width) in enumerate(zip(at, widths, strict=True)):
            seen = np.flatnonzero(np.isfinite(curves[tooth]))
            if width == 1 or not len(seen) or own not in (seen[0], seen[-1]):
                continue
            apart = OVERLAP if self.bent else 1
            inner = own + apart if own == seen[0] else own - apart
            if inner not in seen:
                continue
            section = place[tooth, own]
            to_end = section if own == seen[0] else len(self.z) - 1 - section
            known = math.hypot(self.std[tooth, section], self.std[tooth, place[tooth, inner]])
            rise = max(float(curves[tooth, inner] - curves[tooth, own]) - SLOPED * known, 0.0)
            result[tooth] = rise * min(to_end / width, 0.5)
        return result

    def teeth(self) -> tuple[ToothSummary, ...]:
        """A summary per tooth; least and loss without the bias of having looked for an extreme."""
        return self._teeth

    def thinnest(self) -> ThinnestTooth | None:
        """The least thickness of the gear; None where no tooth was seen on both sides."""
        return self._thinnest

    @cached_property
    def _least_arc(self) -> tuple[Least, Floats, float]:
        return self._least(self.arc)

    @cached_property
    def _teeth(self) -> tuple[ToothSummary, ...]:
        least, at_z, _ = self._least_arc
        lost, _, _ = self._least(self.arc - self.as_made)
        result = []
        for tooth, arc in enumerate(self.arc):
            if not np.isfinite(least.value[tooth]):
                nothing = [math.nan] * 7
                result.append(ToothSummary(tooth, self.nominal, *nothing))
                continue
            std = float(np.median(self.std[tooth][np.isfinite(arc)]))
            result.append(
                ToothSummary(
                    tooth, self.nominal, float(np.nanmean(arc)), float(least.value[tooth]), -float(lost.value[tooth]),
                    float(at_z[tooth]), std, float(least.std[tooth]), float(lost.std[tooth]),
                )
            )  # fmt: skip
        return tuple(result)

    @cached_property
    def _thinnest(self) -> ThinnestTooth | None:
        if not np.isfinite(self.arc).any():
            return None
        least, at_z, lowest = self._least_arc
        value, std = least.overall, least.overall_std
        low, high = value - NORMAL_95 * std, value + NORMAL_95 * std
        if self.pooled > 1:
            # Of few sections the bottom of one hollow can hardly be told from the least of many alike: it may be as deep as it was measured.
            low = min(low, lowest)
        return ThinnestTooth(least.curve, value, std, low, high, float(at_z[least.curve]))


def stations(face_width: float, step: float = STEP) -> Floats:
    """Heights 0, step, 2 step … across the face, mm."""
    return np.asarray(np.arange(math.floor(face_width / step + 1e-9) + 1) * step, dtype=np.float64)


def section_thickness(
    points: SurfacePoints, gear: Gear, noise: float, radius: float | None = None, z: Floats | None = None
) -> SectionThickness:
    """Measure the tooth thickness at a radius in every section.

    Parameters
    ----------
    points : SurfacePoints
        The located scan (corrected for measurement effects where they are known).
    gear : Gear
        The nominal gear.
    noise : float
        Scatter of points, mm.
    radius : float or None
        mm, on the involute; None: the reference circle.
    z : (n_z,) float or None
        Heights, mm, evenly spaced; None: 0, 0.2, 0.4 … A single height takes all points (a planar section).

    Returns
    -------
    SectionThickness

    Raises
    ------
    ValueError
        If the radius is not on the involute.

    Notes
    -----
    A side's deviation δ along the normal in space is a turn δ / (r_b cos β_b) at every radius, so the transverse arc is
    ``s = s_nominal + r / (r_b cos β_b) (δ_left + δ_right)`` exactly. δ is the mean of the points in the section's slab and
    within 0.1 modules of arc of the radius, taken to the radius itself by the straight line through them. In a scan too thin for that the
    slabs of neighbouring sections are pooled (`pooled`): their mean, or where they would reach farther along the face than along the profile, a
    surface through them that is a parabola along the face and straight along the profile, in a wider band.
    """
    r = gear.reference_radius if radius is None else radius
    if not 0.0 <= gear.orientation * (r - gear.form_radius) <= abs(gear.flank_end_radius - gear.form_radius):
        raise ValueError(
            f"radius {r} mm is not on the involute: {min(gear.form_radius, gear.flank_end_radius):.4f} … {max(gear.form_radius, gear.flank_end_radius):.4f} mm"
        )
    heights = stations(gear.face_width) if z is None else np.asarray(z, dtype=np.float64)
    reach, own = _roll_at(gear, r), points.own_roll(gear)
    half, bent = _half_width(points, gear, r, heights)
    used = np.flatnonzero((points.surface == FLANK) & (np.abs(own - reach) <= half))
    if len(heights) > 1:
        step = heights[1] - heights[0]
        row = np.rint((points.own_height[used] - heights[0]) / step).astype(np.int64)
    else:
        row = np.zeros(len(used), dtype=np.int64)
    inside = (row >= 0) & (row < len(heights))
    used, row = used[inside], row[inside]
    cell = (points.tooth[used].astype(np.int64) * 2 + (points.side[used] < 0)) * len(heights) + row
    shape = (gear.teeth, 2, len(heights))
    parts = _parts(gear, heights)
    if len(heights) > 1:
        number = np.bincount(cell, minlength=math.prod(shape)).reshape(shape)
        ended = np.zeros(len(heights), dtype=bool)
        for rows, stretch in parts:
            ended[rows] = _beyond_flanks(number[:, :, rows], heights[rows], stretch)
        kept = ~ended[row]
        used, cell = used[kept], cell[kept]
    stretches = [rows for rows, _ in parts]
    surface = surface_in_sections(own[used] - reach, points.deviation[used], cell, shape, half, stretches, bent)
    flank = surface.value
    for rows in stretches:
        flank[:, :, rows][:, :, _rounded_off(flank[:, :, rows], gear.transverse_module, noise)] = np.nan
    flank[:, :, (from_end(gear, heights) < 0.0) & (gear.spec.gap > 0.0)] = np.nan  # a groove has no teeth
    nominal = float(gear.thickness(r))
    turn = r / (gear.base_radius * gear.base_helix_cosine)
    made = np.full((gear.teeth, len(heights)), nominal)
    if gear.modified:
        made = made + r * (gear.half_angles(np.array([r]), heights).sum(axis=0)[:, 0] - 2.0 * float(gear.half_angle(r)))
    arc, std = made + turn * flank.sum(axis=1), turn * noise * np.sqrt(surface.variance.sum(axis=1))
    # Scatter above what 1 in 1,000 sections shows by noise alone (Wilson and Hilferty 1931).
    free, scatter = 2.0 / (9.0 * np.maximum(surface.free, 1.0)), surface.scatter
    usual = noise**2 * (1.0 - free + 3.09 * np.sqrt(free)) ** 3
    hidden = turn * np.sqrt(np.where(scatter > usual, scatter - noise**2, 0.0).sum(axis=1))
    return SectionThickness(
        r,
        heights,
        nominal,
        arc,
        flank,
        surface.count,
        std,
        noise,
        made,
        surface.pooled,
        unresolved=hidden,
        pooled_on=surface.pooled_on,
        bend=np.nan_to_num(turn * surface.bend.sum(axis=1)) if bent else None,
    )


def near_radius(points: SurfacePoints, gear: Gear, radius: float) -> SurfacePoints:
    """Those points of flanks that thickness at a radius may be measured from."""
    return points.take(np.abs(points.own_roll(gear) - _roll_at(gear, radius)) <= _widest(gear, radius))


def _roll_at(gear: Gear, radius: float) -> float:
    """Length of roll at a radius, mm."""
    return math.sqrt((radius - gear.base_radius) * (radius + gear.base_radius))


def _widest(gear: Gear, radius: float) -> float:
    """Length of roll, mm, from a radius to the nearer end of the involute."""
    roll = _roll_at(gear, radius)
    return min(abs(roll - gear.form_roll), abs(gear.tip_roll - roll))


def _half_width(points: SurfacePoints, gear: Gear, radius: float, heights: Floats) -> tuple[float, bool]:
    """Half the length of roll, mm, from which the points of a section are taken: `WINDOW`, or where `ENOUGH_POINTS` need a greater height than that,
    as far along the profile as along the face, so that of a hollow as little is lost as can be; within the involute, and symmetric. Then the
    surface is bent along the face, too, as far as the points can tell."""
    roll, own = _roll_at(gear, radius), points.own_roll(gear)
    per_roll = max(roll, 0.05 * gear.base_radius) / gear.base_radius  # arc along the profile
    least, most = WINDOW * gear.transverse_module / per_roll, _widest(gear, radius)
    near = (points.surface == FLANK) & (np.abs(own - roll) <= most)
    if len(heights) < 2 or most <= least or not near.any():
        return least, False
    flanks = len(np.unique(points.tooth[near].astype(np.int64) * 2 + (points.side[near] < 0)))
    density = float(near.sum()) / (flanks * 2.0 * most * per_roll * (heights[-1] - heights[0]))  # points per mm²
    wanted = 0.5 * math.sqrt(ENOUGH_POINTS / density) / per_roll
    return float(np.clip(wanted, least, most)), wanted > least


def _side_by_side(sections: int, width: int, bent: bool) -> Ints:
    """Middles of windows of some sections; of parabolas those within the face, `OVERLAP` to a width."""
    first = min(width // 2, sections - 1)
    if not bent:
        return np.arange(first, sections, width)
    last = max(sections - 1 - first, first)
    return np.unique(np.rint(np.linspace(first, last, math.ceil((last - first) * OVERLAP / width) + 1)).astype(np.int64))


def _parts(gear: Gear, heights: Floats) -> list[tuple[slice, Segment]]:
    """Sections that belong together, and the stretch of the face they lie on: all of them, or those of each half of a double helical gear."""
    found = []
    for half in segments(gear) if gear.spec.gap > 0.0 else ():
        own = np.flatnonzero((heights >= half.low) & (heights <= half.high))
        if len(own):
            found.append((slice(int(own[0]), int(own[-1]) + 1), half))
    return found or [(slice(0, len(heights)), Segment(0.0, gear.face_width, gear.twist))]


def _beyond_flanks(count: Ints, heights: Floats, stretch: Segment) -> Bools:
    """Sections at either end of a stretch of the face where most flanks have ended, (n_z,)."""
    if len(heights) < 2:
        return np.zeros(len(heights), dtype=bool)
    step = heights[1] - heights[0]
    inside = np.minimum(heights + 0.5 * step, stretch.high) - np.maximum(heights - 0.5 * step, stretch.low)
    seen = count.sum(axis=2) > 0
    if not seen.any():
        return np.zeros(len(heights), dtype=bool)
    density = np.median(count[seen], axis=0) / np.maximum(inside, 0.1 * step)
    few = density < LEAST_SHARE_AT_ENDS * np.median(density)
    return np.asarray(np.logical_and.accumulate(few) | np.logical_and.accumulate(few[::-1])[::-1])


def _rounded_off(flank: Floats, module: float, noise: float) -> Bools:
    """Sections next to the ends of the face where typical flanks of both sides fall off alike, (n_z,): the end is rounded there."""
    if flank.shape[2] < 3:
        return np.zeros(flank.shape[2], dtype=bool)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # sections nobody saw
        fall = fall_from_middle(np.nanmedian(flank, axis=0))
    from_low, from_high = at_either_end(np.all(fall < -least_drop(module, noise), axis=0))
    return from_low | from_high


@dataclass(frozen=True, slots=True)
class TwoPointMeasure:
    """The paper's own measure of wear, between a point of the unworn and one of the worn flank.

    Parameters
    ----------
    chord : float
        Distance of the two points, mm: what the paper prints.
    radial, tangential : float
        Its parts, mm.
    arc_left, arc_right : float
        Loss of arc thickness at the reference circle if the worn flank is a left or a right one, mm: the difference of
        polar angle corrected for the involute's own turn between the two radii, which goes the other way on the other side.
    """

    chord: float
    radial: float
    tangential: float
    arc_left: float
    arc_right: float


def two_point_measure(unworn: tuple[float, float], worn: tuple[float, float], gear: Gear) -> TwoPointMeasure:
    """What the distance between two picked points says of the thickness.

    Parameters
    ----------
    unworn, worn : (float, float)
        x and y in mm, about the gear's axis; both outside the base circle.
    gear : Gear
        The nominal gear.

    >>> from gearwear.design import GearSpec
    >>> paper = Gear.from_spec(GearSpec("pinion", 12, 6.35, 15.0))
    >>> found = two_point_measure((-36.2, -18.2), (-35.6, -20.1), paper)
    >>> round(found.chord, 4), round(found.arc_left, 4), round(found.arc_right, 4)
    (1.9925, 2.0185, 1.6493)
    """
    r1, r2 = math.hypot(*unworn), math.hypot(*worn)
    turn = math.remainder(math.atan2(worn[1], worn[0]) - math.atan2(unworn[1], unworn[0]), 2 * math.pi)
    own = involute_function(math.acos(gear.base_radius / r2)) - involute_function(math.acos(gear.base_radius / r1))
    chord = math.hypot(worn[0] - unworn[0], worn[1] - unworn[1])
    radial = r2 - r1
    r = gear.reference_radius
    return TwoPointMeasure(chord, radial, math.sqrt(max(chord**2 - radial**2, 0.0)), r * abs(turn + own), r * abs(turn - own))
