"""How thick the teeth are: with what the scanner did taken out, against what was made, with what pooled sections hide."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from gearwear.arrays import Bools, Floats
from gearwear.comparison.consequences import Change, thickness_changes
from gearwear.comparison.contributions import PutBack, band_points
from gearwear.comparison.measured_gear import MeasuredGear
from gearwear.comparison.seam import with_seam
from gearwear.design.surface import SurfacePoints
from gearwear.diagnose.effects.base import MADE, MEASURED
from gearwear.diagnose.found import Loop
from gearwear.placing.cells import Cells
from gearwear.wear.by_surfaces import surface_teeth
from gearwear.wear.flank_arcs import worn_arcs
from gearwear.wear.hollows import find_hollows, pitted
from gearwear.wear.regions import Wear
from gearwear.wear.section_sums import SectionBand, SectionSums
from gearwear.wear.thickness import SectionThickness, thickness_of
from gearwear.wear.unmeasured import unmeasured_teeth


def thickness_and_changes(
    measured: MeasuredGear, unworn: MeasuredGear | None, effects: Sequence[PutBack] | None, wear: Wear
) -> tuple[SectionThickness, tuple[Change, ...]]:
    """Section thickness, and what the effects change of it; nothing was taken out where they are None."""
    sections = measured.sections
    thickness = _with_hollows(corrected_thickness(measured, sections), measured, wear, sections)
    if unworn is not None:
        made_arc = corrected_thickness(unworn, unworn.sections).arc
        thickness = thickness.against(np.where(np.isfinite(made_arc), made_arc, thickness.as_made))
    else:
        thickness = _with_other_sides(measured, thickness)
    thickness = with_seam(measured, thickness)
    if effects is None:
        return thickness, ()
    raw = corrected_thickness(measured, measured.raw_sections)
    surfaces = None if thickness.surfaces is None else thickness.surfaces.shifted(raw.arc - thickness.arc)
    raw = replace(raw, hollows=thickness.hollows, surfaces=surfaces)
    return thickness, thickness_changes(measured, effects, thickness, raw)


def corrected_thickness(measured: MeasuredGear, sections: SectionSums) -> SectionThickness:
    """Section thickness with measurement effects taken out; the loss against the as-made gear."""
    gear, loop = measured.gear, measured.loop
    result = thickness_of(sections, measured.noise).without(_sections_gone(measured, sections))
    if loop is None:
        return result
    turn = gear.arc_per_depth
    step = result.z[1] - result.z[0] if len(result.z) > 1 else 1.0
    grid = measured.cells.grid
    along = loop.covariance.row_step ** (step * (grid.rows - grid.groove_rows) / (gear.face_width - gear.spec.gap))
    common = np.hypot(turn * sum(measured.level_std), turn * _unexplained(measured))
    result = result.known_to(2.0 * turn**2 * loop.covariance.texture, float(along), float(common))
    flanks = band_points(gear, result.z)

    def arc(of: Callable[[SurfacePoints], Floats]) -> Floats:
        return np.asarray(turn * np.sum([of(flank) for flank in flanks], axis=0).reshape(gear.teeth, -1))

    other = [float(arc(partial(loop.as_other, effect)).mean()) for effect in loop.either]
    untold = 0.0 if loop.untold is None else turn * loop.untold.level.sum(axis=1, keepdims=True)
    # Between the places that were measured a tooth is as thin as it was made, and no thinner for what the scanner may have done.
    return replace(
        result.against(result.as_made + arc(partial(loop.deviation, kinds=MADE)) + untold).made_with(arc(loop.surely_made) + untold),
        otherwise=(sum(min(change, 0.0) for change in other), sum(max(change, 0.0) for change in other)),
    )  # fmt: skip


def _with_other_sides(measured: MeasuredGear, thickness: SectionThickness) -> SectionThickness:
    """The same measurement with what teeth are on average were other sides worn throughout that the scan does not exclude: as much thinner as the scanner then
    added more. One of the readings is true."""
    loop = measured.loop
    if loop is None or not loop.others:
        return thickness
    flanks = band_points(measured.gear, thickness.z)

    def added(reading: Loop) -> float:
        both = np.sum([reading.deviation(flank, MEASURED) for flank in flanks], axis=0)
        return float(measured.gear.arc_per_depth * both.mean())

    changes = [added(loop) - added(other) for other in loop.others]
    less, more = thickness.otherwise
    return replace(thickness, otherwise=(less + min(0.0, *changes), more + max(0.0, *changes)))


def _with_hollows(thickness: SectionThickness, measured: MeasuredGear, wear: Wear, sections: SectionSums) -> SectionThickness:
    """The same measurement with what pooled sections of worn teeth hide, and how well is known how thick each was made."""
    variance = np.tile(np.square(wear.apart), (len(thickness.arc), 1))
    if measured.loop is not None and measured.loop.untold is not None:
        variance += measured.loop.untold.level_std**2
    thickness = replace(thickness, made_std=thickness.turn * np.sqrt(variance.sum(axis=1)))
    if measured.planar:
        return thickness
    corrected = measured.corrected
    cells = corrected.with_deviation(corrected.points.deviation - measured.manufacture - measured.raised)
    arcs = worn_arcs(cells, wear.mask, measured.worn_sides, sections.band, measured.noise, measured.loop)
    if arcs is None:
        return thickness
    pits = pitted(cells)
    hollows = find_hollows(arcs, pits, measured.worn_sides, thickness.widths, sections, thickness.as_made)
    return replace(
        thickness,
        hollows=hollows,
        surfaces=surface_teeth(thickness.arc, thickness.as_made, arcs, measured.worn_sides, pits),
        unmeasured=unmeasured_teeth(thickness, wear, arcs),
        pit_bottom=_pit_bottom(thickness, wear, pits, _at_radius(cells, wear, sections.band)),
    )


def _at_radius(cells: Cells, wear: Wear, band: SectionBand) -> tuple[Bools, Floats]:
    """Whether pits of each flank reach to where thickness is measured, and how deep cells of its wear are there, (teeth, 2), mm."""
    grid = cells.grid
    low, high = sorted(int(grid.flank_column(band.reach + half)) for half in (-band.half, band.half))
    there = slice(grid.fillet + low, grid.fillet + high + 1)
    hung: Bools = np.zeros(wear.mask.shape, dtype=np.bool_) if cells.far is None else grid.sides(cells.far.hung)
    deep = np.where(wear.mask, wear.depth, 0.0)[..., there]
    return np.asarray(hung[..., there].any(axis=(2, 3))), np.asarray(deep.max(axis=(2, 3)))


def _pit_bottom(thickness: SectionThickness, wear: Wear, pits: Bools, there: tuple[Bools, Floats]) -> float:
    """`SectionThickness.pit_bottom` of teeth with `pits` (teeth,); inf where none has any. Pits of a flank that do not reach to where thickness is measured,
    as `_at_radius` says, take nothing off it: what else is worn there does."""
    deepest = there[1].copy()
    for region in wear.regions:
        flank = region.tooth, region.side.index
        if there[0][flank] and math.isfinite(region.max_depth):
            deepest[flank] = region.max_depth
    left = thickness.as_made.min(axis=1) - thickness.turn * deepest.sum(axis=1)
    return float(left[pits].min(initial=math.inf))


def _sections_gone(measured: MeasuredGear, sections: SectionSums) -> Bools:
    """(teeth, n_z) sections in which a tooth is broken off at the radius that is measured: what is left of its flank there is the edge of the fracture."""
    grid, heights = measured.cells.grid, sections.band.heights
    column = grid.fillet + int(grid.flank_column(sections.band.reach))
    row = np.clip(grid.place_of(heights).astype(np.int64), 0, grid.rows - 1)
    gone = np.asarray(measured.gone[:, :, :, column].any(axis=1), dtype=np.bool_)
    return gone[:, row]


def _unexplained(measured: MeasuredGear) -> float:
    """What the patterns that no effect explains add up to on both sides of a tooth where its thickness is measured, RMS over the gear, mm: whether they are
    the part's is not known."""
    grid, loop = measured.cells.grid, measured.loop
    if loop is None or not loop.patterns:
        return 0.0
    column = int(grid.flank_column(grid.gear.thickness_roll))
    field = np.sum([grid.flank_shape(pattern.field) for pattern in loop.patterns], axis=0)
    return float(np.sqrt(np.mean(field[..., column].sum(axis=1) ** 2)))
