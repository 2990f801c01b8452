"""What the effects change: the results as the raw scan gives them, and with the effects taken out.

*Before* is what the scan says by itself, in the pose that registration gave it. *After* is the result. Wear volume and depth are found
anew on the raw scan. Thickness is measured on its points. Backlash and transmission error are those of the worn gear with the effects put
back on its flanks, so that both hold the same wear and the scatter of the points is in neither. A mounting effect is one against a datum:
where there is one, the flanks are put back as they lie about the datum.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from gearwear.arrays import Floats
from gearwear.comparison.contributions import PutBack, SideFields, arc_fields, cell_fields, put_back
from gearwear.comparison.measured_gear import MeasuredGear
from gearwear.diagnose.effects.base import MEASURED
from gearwear.meshing.backlash import backlash_from_normal
from gearwear.meshing.contact_result import ContactResult, ContactVariant
from gearwear.meshing.linear import LinearResult
from gearwear.placing.cells import Cells
from gearwear.processors import each
from gearwear.wear.regions import Wear
from gearwear.wear.thickness import SectionThickness
from gearwear.wear.tooth_summary import ThinnestTooth

SHARE = 0.1
"""Part of the largest cause from which on a lesser one is named beside it."""
FIRST_ORDER = 0.01
"""Part of what the effects do to the flanks to which contact is known that is worked out to first order."""


@dataclass(frozen=True, slots=True)
class Change:
    """One number of the result, with the effects left in and taken out.

    Parameters
    ----------
    name : str
        What it is, with its unit at the end, as in the report.
    before, after : float
        As the raw scan gives it; with the effects taken out.
    as_made : float
        Of the gear as it was made; nan where that is not known.
    std : float
        Standard deviation of the difference.
    causes : tuple of (str, float)
        Effects behind the difference, and what each would change by itself; the largest first.
    """

    name: str
    before: float
    after: float
    as_made: float
    std: float
    causes: tuple[tuple[str, float], ...]

    @property
    def difference(self) -> float:
        """after − before."""
        return self.after - self.before

    @property
    def matters(self) -> bool:
        """Whether the difference is more than its standard deviation."""
        return abs(self.difference) > self.std


def wear_changes(
    measured: MeasuredGear,
    effects: Sequence[PutBack],
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
    effects : sequence of PutBack
        Its effects.
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
    fields = cell_fields(measured, effects, as_made)
    if unworn is not None:
        for name, field in cell_fields(unworn, put_back(unworn), as_made).items():
            fields[name] = fields.get(name, 0.0) - field

    def put_in(field: Floats) -> tuple[float, float]:
        """Volume and depth with an effect left in."""
        worn = find(as_made.with_deviation(as_made.points.deviation + field))
        return worn.volume, _deepest(worn)

    alone = dict(zip(fields, each([partial(put_in, field) for field in fields.values()]), strict=True))
    points = float(np.median(as_made.count[as_made.seen])) * max(1, round(0.5 / as_made.grid.size)) ** 2
    level = math.hypot(scatter / math.sqrt(max(points, 1.0)), *measured.level_std)
    volume = "worn_area_mm2" if measured.planar else "worn_volume_mm3"
    return (
        _change(
            volume, before.volume, wear.volume, 0.0, math.hypot(before.volume_std, wear.volume_std),
            {name: wear.volume - lost for name, (lost, _) in alone.items()},
        ),
        _change(
            "deepest_wear_um", 1e3 * _deepest(before), 1e3 * _deepest(wear), 0.0, 1e3 * math.sqrt(2.0) * level,
            {name: 1e3 * (_deepest(wear) - deepest) for name, (_, deepest) in alone.items()},
        ),
    )  # fmt: skip


def _deepest(wear: Wear) -> float:
    return max((region.max_depth for region in wear.regions), default=0.0)


def thickness_changes(
    measured: MeasuredGear, effects: Sequence[PutBack], after: SectionThickness, before: SectionThickness
) -> tuple[Change, ...]:
    """Mean and least tooth thickness, as arcs where it is measured."""
    if not (np.isfinite(after.arc) & np.isfinite(before.arc)).any():
        return ()
    made = np.where(np.isfinite(after.arc), after.as_made, np.nan)  # without noise: its least is no less than it is
    added = arc_fields(measured, [effect for effect in effects if effect.kind in MEASURED], after.z)
    alone = {name: replace(after, arc=after.arc + arc) for name, arc in added.items()}
    level = sum(measured.level_std) * measured.gear.thickness_radius / measured.gear.normal_lever
    # In another pose other points fall into a section: a mean is not moved by that, a single section is.
    other = float(np.nanstd(before.arc - after.arc - sum(added.values(), np.zeros(after.arc.shape))))
    near = 2.0 * after.pooled * float(np.median(np.diff(after.z))) if len(after.z) > 1 else math.inf
    moved = unshared_std(before.thinnest(), after.thinnest(), near)
    summaries: tuple[tuple[str, float, float, Callable[[SectionThickness], float]], ...] = (
        ("tooth_thickness_mean_mm", 0.0, float(np.nanmean(made)), lambda thickness: float(np.nanmean(thickness.arc))),
        ("tooth_thickness_least_mm", math.hypot(other, moved), float(np.nanmin(made)), _thinnest),
    )
    changes = []
    for name, scatter, as_made, of in summaries:
        shares = {effect: of(after) - of(thickness) for effect, thickness in alone.items()}
        std = math.hypot(level, scatter, *_known_to(effects, shares))
        changes.append(_change(name, of(before), of(after), as_made, std, shares))
    return tuple(changes)


def unshared_std(before: ThinnestTooth | None, after: ThinnestTooth | None, near: float) -> float:
    """Standard deviation that two least thicknesses of a scan do not share, mm: none where both are of one place, that of both where the least has
    gone to another tooth or farther than `near`, mm, along the face: what an effect does to a place does not tell how two places differ."""
    if before is None or after is None or (before.tooth == after.tooth and abs(before.at_z - after.at_z) <= near):
        return 0.0
    return math.hypot(before.std, after.std)


def _thinnest(thickness: SectionThickness) -> float:
    least = thickness.thinnest()
    return math.nan if least is None else least.value


def meshing_changes(
    measured: MeasuredGear,
    effects: Sequence[PutBack],
    fields: SideFields,
    contact: ContactResult,
    made: LinearResult | None,
    centre_distance: float,
) -> tuple[Change, ...]:
    """Backlash, circumferential on the operating circles, and transmission error.

    Parameters
    ----------
    measured : MeasuredGear
    effects : sequence of PutBack
        Its effects.
    fields : SideFields
        The same on the tooth sides.
    contact : ContactResult
        Of the worn gear, with the variants that `RunningGear.put_back` gives.
    made : LinearResult or None
        Of the gear as it was made.
    centre_distance : float
        mm.

    Notes
    -----
    The variants are sampled; their difference from the sampled result is added to the searched one. The standard deviation holds what a
    search between the positions could still find, what first order may miss, the effects' own, and that of the pose.
    """
    if not contact.variants:
        return ()
    ratio = backlash_from_normal(contact.driver, contact.driven, centre_distance, 1.0).circumferential
    base, positions = contact.itself, len(contact.rotation)
    raw, *others = contact.variants
    alone = dict(zip(fields.taken, others, strict=True))
    order = FIRST_ORDER * float(np.sqrt(np.mean(fields.raw**2)))
    level = ratio * math.hypot(sum(measured.level_std), order)
    sway = 2e3 * math.hypot(
        *measured.level_std, order
    )  # what is left of the pose is known about as well as the level of the flanks
    quantities: tuple[tuple[str, float, float, float, Callable[[ContactVariant], float]], ...] = (
        ("backlash_mean_mm", ratio * float(base.backlash.mean()), level, 0.0, lambda v: ratio * float(v.backlash.mean())),
        ("backlash_greatest_mm", ratio * contact.backlash_max.value, level, ratio, lambda v: ratio * float(v.backlash.max())),
        ("transmission_error_um", contact.peak_to_peak_um, sway, 1e3, lambda v: v.peak_to_peak_um),
    )
    changes = []
    for name, after, std, missed, of in quantities:
        shares = {effect: of(base) - of(variant) for effect, variant in alone.items()}
        step = missed * math.hypot(*(_missed(variant, name, positions) for variant in (raw, base)))
        as_made = math.nan if made is None else of(ContactVariant(made.transmission_error, made.backlash))
        before = after + of(raw) - of(base)
        changes.append(_change(name, before, after, as_made, math.hypot(std, step, *_known_to(effects, shares)), shares))
    return tuple(changes)


def _missed(variant: ContactVariant, name: str, positions: int) -> float:
    """How far beyond the extremes of a sampled curve, mm, the cusps between its positions may reach: where lines from both sides meet."""
    curve, signs = (variant.backlash, (1,)) if name.startswith("backlash") else (variant.transmission_error, (-1, 1))
    beyond = 0.0
    for sign in signs:
        values = sign * curve[:positions]
        at = int(values.argmax())
        for way in (1, -1):  # the gap after the extreme, and the one before it
            behind, here, there, further = (float(values[(at + way * k) % len(values)]) for k in (-1, 0, 1, 2))
            up, down = here - behind, max(there - further, 0.0)
            if up + down > 0.0:
                beyond = max(beyond, up * float(np.clip((there + down - here) / (up + down), 0.0, 1.0)))
    return beyond


def _known_to(effects: Sequence[PutBack], shares: dict[str, float]) -> list[float]:
    """Standard deviation of each effect's own part of a change."""
    relative = {effect.name: effect.relative_std for effect in effects}
    return [relative.get(name, 0.0) * size for name, size in shares.items()]


def _change(name: str, before: float, after: float, as_made: float, std: float, shares: dict[str, float]) -> Change:
    """A change with its causes: the effects that alone change as much as can be seen, the largest first."""
    least = max(std, SHARE * max((abs(size) for size in shares.values()), default=0.0))
    named = sorted((effect for effect in shares if abs(shares[effect]) > least), key=lambda effect: -abs(shares[effect]))
    causes = tuple((effect, shares[effect]) for effect in named) if abs(after - before) > std else ()
    return Change(name, before, after, as_made, std, causes)
