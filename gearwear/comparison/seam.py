"""The tooth that the seam of a drift goes through, where a drift of the scan is told as pitch errors: one flank is from the beginning of the turn and the
other from its end, so it looks thinner or thicker than it is, by the closure."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from gearwear.arrays import Floats
from gearwear.comparison.contributions import band_points
from gearwear.comparison.measured_gear import MeasuredGear
from gearwear.design.quantity import NORMAL_95
from gearwear.diagnose.effects.base import MADE
from gearwear.diagnose.effects.scan_drift import EFFECT as DRIFT
from gearwear.diagnose.found import FoundEffect
from gearwear.diagnose.rules import rules
from gearwear.wear.thickness import SectionThickness
from gearwear.wear.tooth_summary import DriftSeam, UnmeasuredTeeth

STEPS = 8
"""Places in a pitch at which the seam is tried; numerical."""


def with_seam(measured: MeasuredGear, thickness: SectionThickness) -> SectionThickness:
    """The same measurement with what it is were the pitch errors a drift of the scan, where the scan does not tell these apart and the seam goes through a
    tooth.

    Notes
    -----
    Index errors of single teeth say where they step, and by how much, and not whether they do in a tooth or in a gap: there the flanks of the tooth
    itself do, by which it is as thick as the others (least absolute deviations: worn ones count little).
    """
    loop = measured.loop
    found = next((one for one in (() if loop is None else loop.either) if _drifts(one)), None)
    if found is None or not np.isfinite(thickness.arc).any():
        return thickness
    closed = _closure(measured, found, thickness.z)
    if closed is None:
        return thickness
    start, closure, relative_std = closed
    ways = np.arange(-STEPS, STEPS + 1) / STEPS
    changes = [-_drift_arc(measured, thickness.z, start + way * measured.gear.pitch_angle, closure) for way in ways]
    change = min(changes, key=lambda one: _apart(thickness.arc + one))
    tooth, section = (int(at) for at in np.unravel_index(np.argmax(abs(change)), change.shape))
    by = float(change[tooth, section])
    if abs(by) < 0.5 * abs(closure) * thickness.radius:  # all of it, or next to nothing where it goes through a gap
        return thickness
    moved = _moved(thickness.unmeasured, change.mean(axis=1))
    surfaces = None if thickness.surfaces is None else thickness.surfaces.shifted(change)
    otherwise = replace(thickness, arc=thickness.arc + change, unmeasured=moved, surfaces=surfaces)
    told, other = thickness.thinnest(), otherwise.thinnest()
    assert told is not None and other is not None
    if tooth not in (told.tooth, other.tooth):  # the thinnest is another one, drift or not
        return replace(thickness, seam=DriftSeam(tooth, by))
    reach = NORMAL_95 * relative_std * abs(by) if other.tooth == tooth else 0.0
    return replace(thickness, seam=DriftSeam(tooth, by, other.low - reach, other.high + reach))


def _drifts(effect: FoundEffect) -> bool:
    """Whether an effect is amounts of the maker, tooth by tooth, that a drift may be as well."""
    return effect.kind in MADE and effect.candidate.effect.tooth_specific and DRIFT.name in effect.alternatives


def _closure(measured: MeasuredGear, effect: FoundEffect, z: Floats) -> tuple[float, float, float] | None:
    """Of the drift most like the effect: where it begins, rad, among the gaps, its closure, rad, and the standard deviation of that over its size; None where
    it is not like it."""
    gear, loop = measured.gear, measured.loop
    assert loop is not None
    flanks = band_points(gear, z)
    field = np.concatenate([loop.of_effect(effect, flank) for flank in flanks])
    best = (np.inf, 0.0, 0.0)
    for gap in range(gear.teeth):
        start = (gap + 0.5) * gear.pitch_angle
        unit = np.concatenate([DRIFT.basis(flank, loop.context, (start,))[:, 0] for flank in flanks])
        closure = float(unit @ field / (unit @ unit))
        best = min(best, (float(np.sum((field - closure * unit) ** 2)), start, closure))
    left, whole = best[0], float(field @ field)
    if not left < rules().stands_in * whole:
        return None
    return best[1], best[2], float(np.sqrt(left / (whole - left) / gear.teeth))


def _drift_arc(measured: MeasuredGear, z: Floats, start: float, closure: float) -> Floats:
    """What a drift adds to the arcs of teeth, (teeth, n_z) mm."""
    gear, loop = measured.gear, measured.loop
    assert loop is not None
    both = [DRIFT.basis(flank, loop.context, (start,))[:, 0] for flank in band_points(gear, z)]
    return np.asarray(gear.arc_per_depth * closure * np.sum(both, axis=0).reshape(gear.teeth, -1))


def _apart(arc: Floats) -> float:
    """How far the teeth are from being as thick as each other: the sum over all sections, mm."""
    seen = arc[:, np.isfinite(arc).any(axis=0)]
    return float(np.nansum(abs(seen - np.nanmedian(seen, axis=0))))


def _moved(unmeasured: UnmeasuredTeeth | None, by: Floats) -> UnmeasuredTeeth | None:
    """What surfaces say of teeth that few sections measured, with each as much thicker, (teeth,) mm."""
    if unmeasured is None:
        return None
    teeth = tuple(
        replace(one, value=one.value + by[one.tooth], low=one.low + by[one.tooth], high=one.high + by[one.tooth])
        for one in unmeasured.teeth
    )
    return UnmeasuredTeeth(teeth, min(teeth, key=lambda one: one.value))
