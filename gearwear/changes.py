"""What the effects change: the results as the raw scan gives them, and with the effects taken out.

*Before* is what the scan says by itself, in the pose that registration gave it. *After* is the result. Wear volume and depth are found
anew on the raw scan. Thickness is measured on its points. Backlash and transmission error are those of the worn gear with the effects put
back on its flanks, so that both hold the same wear and the scatter of the points is in neither. A mounting effect is one against a datum:
where there is one, the flanks are put back as they lie about the datum.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.gear import Gear
from gearwear.design.profiles import SIGN, ToothProfiles
from gearwear.design.surface import FILLET, SurfacePoints, flank_points, locate
from gearwear.diagnose.effects.base import Kind
from gearwear.diagnose.loop import FoundEffect, Loop
from gearwear.measure.cells import CellGrid, Cells
from gearwear.measure.pose import motion_columns
from gearwear.measure.thickness import SectionThickness
from gearwear.measuring import MADE, MEASURED, MeasuredGear
from gearwear.meshing.backlash import backlash_from_normal
from gearwear.meshing.contact_result import ContactResult, ContactVariant
from gearwear.meshing.linear import LinearResult
from gearwear.report.results import UNEXPLAINED, Change
from gearwear.wear.regions import Wear

SHARE = 0.1
"""Part of the largest cause from which on a lesser one is named beside it."""
FIRST_ORDER = 0.01
"""Part of what the effects do to the flanks to which contact is known that is worked out to first order."""
SHAPES = frozenset({"order", "phase_deg", "direction_deg", "start_deg", "start_mm", "wavelength_mm", "width_mm"})
"""Parameters that say where an effect is, not how large."""


@dataclass(frozen=True, slots=True)
class SideFields:
    """What was found does to the tooth sides, cell by cell, seen or not; arrays are (teeth, 2, rows, fillet + flank), mm.

    Parameters
    ----------
    made : array
        Manufacture effects together.
    taken : dict of str to array
        By name: every effect of measurement and mounting, and what is unexplained.
    raw : array
        All of `taken`, and the small motion between the pose of registration and the final one; about the datum, without that motion,
        where there is a mounting effect.
    """

    made: Floats
    taken: dict[str, Floats]
    raw: Floats


def side_fields(loop: Loop | None, grid: CellGrid) -> SideFields:
    """The effects of a loop on the tooth sides of the design; nothing where there was no loop."""
    points = side_points(grid)
    shape = (grid.gear.teeth, 2, grid.rows, grid.fillet + grid.flank)
    made, raw, taken = np.zeros(shape), np.zeros(shape), dict[str, Floats]()
    if loop is None or not (loop.effects or loop.patterns):
        return SideFields(made, taken, raw)
    for effect in loop.effects:
        field = effect_field(effect, points, loop).reshape(shape)
        if effect.kind in MADE:
            made = made + field
        elif effect.kind in MEASURED:
            taken[effect.name] = taken.get(effect.name, 0.0) + field
    if loop.patterns:
        cells = np.sum([pattern.field for pattern in loop.patterns], axis=0)
        taken[UNEXPLAINED] = np.nan_to_num(np.concatenate([grid.fillet_shape(cells), grid.flank_shape(cells)], axis=-1))
    raw = sum(taken.values(), raw)
    if not any(effect.kind is Kind.MOUNTING for effect in loop.effects):
        raw = raw + (motion_columns(points.position, points.normal) @ loop.motion).reshape(shape)
    return SideFields(made, taken, raw)


def effect_field(effect: FoundEffect, points: SurfacePoints, loop: Loop) -> Floats:
    """What one effect does to the deviation of points, mm, (n,)."""
    found = effect.candidate
    return np.asarray(found.effect.basis(points, loop.context, found.shape) @ effect.amplitudes, dtype=np.float64)


def side_points(grid: CellGrid) -> SurfacePoints:
    """Centres of all fillet and flank cells on the nominal gear, in the order of the wear sheets."""
    gear = grid.gear
    low = 0.5 * (grid.fillet_radius[1:] + grid.fillet_radius[:-1])
    roll = np.sqrt(np.linspace(gear.form_roll**2, gear.tip_roll**2, 2 * grid.flank + 1)[1::2])
    middle = 0.5 * (grid.z_edges[1:] + grid.z_edges[:-1])
    columns = grid.fillet + grid.flank
    tooth, half, row, column = (a.ravel() for a in np.indices((gear.teeth, 2, grid.rows, columns)))
    side, z = np.array(SIGN)[half], middle[row]
    found = flank_points(gear, tooth, side, np.append(np.full(grid.fillet, gear.form_roll), roll)[column], z)
    on_fillet = np.flatnonzero(column < grid.fillet)
    radius = low[column[on_fillet]]
    angle = tooth[on_fillet] * gear.pitch_angle + side[on_fillet] * gear.half_angle(radius)
    fillet = locate(np.column_stack([radius * np.cos(angle), radius * np.sin(angle), z[on_fillet]]), gear)
    found.surface[on_fillet], found.roll[on_fillet] = FILLET, np.nan
    found.position[on_fillet], found.normal[on_fillet] = fillet.position, fillet.normal
    return found


def wear_changes(
    measured: MeasuredGear,
    as_made: Cells,
    scatter: float,
    find: Callable[[Cells], Wear],
    wear: Wear,
    before: Wear,
    unworn: MeasuredGear | None,
) -> tuple[Change, ...]:
    """Worn volume (area of a planar section) and deepest wear.

    Parameters
    ----------
    measured : MeasuredGear
        With its loop.
    as_made : Cells
        What wear is found on.
    scatter : float
        Scatter of the points it is found with, mm.
    find : callable
        Finds it: `gearwear.wear.regions.find_wear` with all but the cells given.
    wear, before : Wear
        With the effects taken out; as the raw scan gives it.
    unworn : MeasuredGear or None
        Of the gear before wear, where its scan was given: an effect that both share cancels.
    """
    loop = measured.loop
    if loop is None:
        return ()
    fields = _cell_fields(loop, as_made)
    for name, field in _cell_fields(unworn.loop, as_made).items() if unworn is not None and unworn.loop is not None else ():
        fields[name] = fields.get(name, 0.0) - field
    deviation = as_made.points.deviation
    alone = {name: find(as_made.with_deviation(deviation + field)) for name, field in fields.items()}
    points = float(np.median(as_made.count[as_made.seen])) * max(1, round(0.5 / as_made.grid.size)) ** 2
    level = math.hypot(scatter / math.sqrt(max(points, 1.0)), *measured.level_std)
    volume = "worn_area_mm2" if measured.planar else "worn_volume_mm3"
    return (
        _change(
            volume, before.volume, wear.volume, 0.0, math.hypot(before.volume_std, wear.volume_std),
            {name: wear.volume - one.volume for name, one in alone.items()},
        ),
        _change(
            "deepest_wear_um", 1e3 * _deepest(before), 1e3 * _deepest(wear), 0.0, 1e3 * math.sqrt(2.0) * level,
            {name: 1e3 * (_deepest(wear) - _deepest(one)) for name, one in alone.items()},
        ),
    )  # fmt: skip


def _cell_fields(loop: Loop, cells: Cells) -> dict[str, Floats]:
    """By name, what each effect and the unexplained do to every cell, mm."""
    seen = cells.seen
    points, fields = cells.points.take(seen), dict[str, Floats]()
    for effect in loop.effects:
        if effect.kind is not Kind.WEAR:
            field = np.zeros(len(seen))
            field[seen] = effect_field(effect, points, loop)
            fields[effect.name] = fields.get(effect.name, 0.0) + field
    if loop.patterns:
        fields[UNEXPLAINED] = np.nan_to_num(np.sum([pattern.field for pattern in loop.patterns], axis=0))
    return fields


def _deepest(wear: Wear) -> float:
    return max((region.max_depth for region in wear.regions), default=0.0)


def thickness_changes(measured: MeasuredGear, after: SectionThickness, before: SectionThickness) -> tuple[Change, ...]:
    """Mean and least tooth thickness at the reference circle."""
    gear, loop = measured.gear, measured.loop
    if loop is None or not np.isfinite(after.arc).any():
        return ()
    made = replace(after, arc=np.where(np.isfinite(after.arc), after.as_made, np.nan))
    alone = {
        effect.name: replace(after, arc=after.arc + arc_field(effect, loop, gear, after.z))
        for effect in loop.effects
        if effect.kind in MEASURED
    }
    level = sum(measured.level_std) * gear.reference_radius / gear.base_radius
    summaries: tuple[tuple[str, Callable[[SectionThickness], float]], ...] = (
        ("tooth_thickness_mean_mm", lambda one: float(np.nanmean(one.arc))),
        ("tooth_thickness_least_mm", lambda one: min(tooth.least for tooth in one.teeth() if tooth.seen)),
    )
    changes = []
    for name, of in summaries:
        own = {effect: of(after) - of(one) for effect, one in alone.items()}
        changes.append(_change(name, of(before), of(after), of(made), math.hypot(level, *_known_to(loop, own)), own))
    return tuple(changes)


def arc_field(effect: FoundEffect, loop: Loop, gear: Gear, z: Floats) -> Floats:
    """What an effect adds to the arc at the reference circle, (teeth, n_z) mm."""
    tooth, height = np.repeat(np.arange(gear.teeth), len(z)), np.tile(z, gear.teeth)
    roll = np.full(len(tooth), gear.reference_roll)
    both = sum(effect_field(effect, flank_points(gear, tooth, np.full(len(tooth), s), roll, height), loop) for s in SIGN)
    return np.asarray(gear.reference_radius / gear.base_radius * both, dtype=np.float64).reshape(gear.teeth, -1)


def variants_of(present: ToothProfiles, build: Callable[[Floats], ToothProfiles], fields: SideFields) -> list[ToothProfiles]:
    """The gear as the raw scan shows it, and with each of the effects put back alone; in the order of `fields.taken`.

    `build` makes profiles from a field of added material, mm; `present` is returned for none.
    """
    if not fields.raw.any():
        return []
    return [build(fields.raw), *(build(field) if field.any() else present for field in fields.taken.values())]


def meshing_changes(
    measured: MeasuredGear, fields: SideFields, contact: ContactResult, made: LinearResult | None, centre_distance: float
) -> tuple[Change, ...]:
    """Backlash, circumferential on the operating circles, and transmission error.

    Parameters
    ----------
    measured : MeasuredGear
        With its loop.
    fields : SideFields
        The effects.
    contact : ContactResult
        Of the worn gear, with the variants that `variants_of` gave.
    made : ContactResult or None
        Of the gear as it was made.
    centre_distance : float
        mm.

    Notes
    -----
    The variants are sampled; their difference from the sampled result is added to the searched one. The standard deviation holds what a
    search between the positions could still find, what first order may miss, the effects' own, and that of the pose.
    """
    loop = measured.loop
    if loop is None or not contact.variants:
        return ()
    ratio = backlash_from_normal(contact.driver, contact.driven, centre_distance, 1.0).circumferential
    base = ContactVariant(contact.transmission_error, contact.backlash)
    raw, *others = contact.variants
    alone = dict(zip(fields.taken, others, strict=True))
    order = FIRST_ORDER * float(np.sqrt(np.mean(fields.raw**2)))
    level = ratio * math.hypot(sum(measured.level_std), order)
    sway = 2e3 * math.hypot(
        *measured.level_std, order
    )  # what is left of the pose is known about as well as the level of the flanks
    found: tuple[tuple[str, float, float, float, Callable[[ContactVariant], float]], ...] = (
        ("backlash_mean_mm", ratio * float(base.backlash.mean()), level, 0.0, lambda one: ratio * float(one.backlash.mean())),
        ("backlash_greatest_mm", ratio * contact.backlash_max.value, level, ratio, lambda one: ratio * float(one.backlash.max())),
        ("transmission_error_um", contact.peak_to_peak_um, sway, 1e3, lambda one: one.peak_to_peak_um),
    )
    changes = []
    for name, after, std, missed, of in found:
        own = {effect: of(base) - of(one) for effect, one in alone.items()}
        step = missed * math.hypot(_missed(raw, name), _missed(base, name))
        as_made = math.nan if made is None else of(ContactVariant(made.transmission_error, made.backlash))
        before = after + of(raw) - of(base)
        changes.append(_change(name, before, after, as_made, math.hypot(std, step, *_known_to(loop, own)), own))
    return tuple(changes)


def _missed(one: ContactVariant, name: str) -> float:
    """How far beyond the extremes of a sampled curve, mm, the cusps between its positions may reach: where lines from both sides meet."""
    curve, signs = (one.backlash, (1,)) if name.startswith("backlash") else (one.transmission_error, (-1, 1))
    beyond = 0.0
    for sign in signs:
        own = sign * curve
        at = int(own.argmax())
        for way in (1, -1):  # the gap after the extreme, and the one before it
            behind, here, there, further = (float(own[(at + way * k) % len(own)]) for k in (-1, 0, 1, 2))
            up, down = here - behind, max(there - further, 0.0)
            if up + down > 0.0:
                beyond = max(beyond, up * float(np.clip((there + down - here) / (up + down), 0.0, 1.0)))
    return beyond


def _known_to(loop: Loop, own: dict[str, float]) -> list[float]:
    """Standard deviation of each effect's own part of a change."""
    return [relative_std(effect) * own[effect.name] for effect in loop.effects if effect.name in own]


def relative_std(effect: FoundEffect) -> float:
    """Standard deviation of an effect's size over its size; 0 where it is not known."""
    sizes = [one for name, one in effect.parameters.items() if name not in SHAPES]
    value, std = (float(np.nansum(np.square(np.hstack([getattr(one, part) for one in sizes])))) for part in ("value", "std"))
    return math.sqrt(std / value) if value > 0.0 else 0.0


def _change(name: str, before: float, after: float, as_made: float, std: float, own: dict[str, float]) -> Change:
    """A change with its causes: the effects that alone change as much as can be seen, the largest first."""
    least = max(std, SHARE * max((abs(size) for size in own.values()), default=0.0))
    named = sorted((effect for effect in own if abs(own[effect]) > least), key=lambda effect: -abs(own[effect]))
    causes = tuple((effect, own[effect]) for effect in named) if abs(after - before) > std else ()
    return Change(name, before, after, as_made, std, causes)
