"""Slope, form and total deviation of profile and helix traces, with crowning and uncertainty.

Signs
-----
Deviations δ are along the outward normal, + is too much material. Profile slope f_Hα is + with more material at the tip (the
pressure angle is then too small). Helix slope f_Hβ = s · (rise of δ towards +z), s = +1 left, −1 right: + is a flank screwed
right-handed, counter-clockwise with rising z, on either side of the tooth. ISO 1328-1 itself calls f_Hβ positive where the
helix angle is too large in amount, and for a spur gear names the hand in place of a sign (unconfirmed: docs/limits.md):
+ here is its "right". A taper (thicker towards +z) has opposite signs on the two sides.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearwear.arrays import Bools, Floats
from gearwear.design.gear import Gear
from gearwear.design.side import Side
from gearwear.inspection.estimate import DRAWS, Estimate, of_statistic
from gearwear.inspection.filtering import INSIDE, SHOWN, filter_samples, stations
from gearwear.inspection.k_band import KBand, KFit, fit_band
from gearwear.inspection.ranges import Range
from gearwear.inspection.traces import Traces

LEAST_SHARE = 0.75
"""A trace with less than this share of its evaluation range seen is not evaluated."""


@dataclass(frozen=True, slots=True)
class Evaluation:
    """Deviations of every flank, mm; arrays are (teeth, 2), side 0 left, 1 right; nan where not seen.

    Parameters
    ----------
    along : str
        "roll" (profile) or "z" (helix).
    range : Range
        What was evaluated.
    band : (float, float)
        Points averaged, z of a profile and L of a helix, mm.
    slope, form, total, crowning : Estimate
        f_H, f_f, F as ISO 1328-1 defines them; crowning is the height of the least-squares parabola over the evaluation range, +
        is more material in the middle.
    cutoff : float
        Largest cut-off that was used, mm: `range.cutoff`, or more where the scan is too thin for it.
    share : (teeth, 2) float
        Share of the evaluation range that was seen.
    station : (n,) float
        Places of the filtered trace over all of the flank, mm; evenly spaced in the evaluation range.
    filtered, standard : (teeth, 2, n) float
        Filtered trace and its standard uncertainty.
    line : (teeth, 2, 2) float
        Least-squares line: δ in the middle of the range, and its rise over the range (towards tip or +z).
    k : KFit or None
        How the traces lie in their K bands; None where there are none.
    """

    along: str
    range: Range
    band: tuple[float, float]
    slope: Estimate
    form: Estimate
    total: Estimate
    crowning: Estimate
    cutoff: float
    share: Floats
    station: Floats
    filtered: Floats
    standard: Floats
    line: Floats
    k: KFit | None

    def line_at(self, station: Floats) -> Floats:
        """The least-squares lines at `station` (n,), mm; (teeth, 2, n)."""
        t = (station - self.range.middle) / self.range.length
        return np.asarray(self.line[..., :1] + self.line[..., 1:] * t, dtype=np.float64)


def evaluate(traces: Traces, where: Range, seed: int = 0, bands: tuple[KBand | None, KBand | None] = (None, None)) -> Evaluation:
    """Filter every trace and take the deviations from it.

    Parameters
    ----------
    traces : Traces
        Profile or helix traces.
    where : Range
        From `profile_range` or `helix_range`.
    seed : int
        Of the simulated noise behind the uncertainty of form and total deviation.
    bands : (KBand or None, KBand or None)
        K bands of the left and of the right flanks.

    Returns
    -------
    Evaluation

    Notes
    -----
    Slope: least-squares line over the evaluation range; its rise. Form: max − min about the line. Total: max − min about
    the design (deviations are already about it). Beyond `where.end` only what stands above counts. Slope and crowning are linear in the
    trace: their uncertainty is exact, from the bins' standard errors through filter and fit. For form and total see
    `estimate.of_statistic`.
    """
    reach = (min(where.start, traces.centre[0] - 0.5 * traces.step), max(where.outer, traces.centre[-1] + 0.5 * traces.step))
    station, zone = stations(where, reach)
    shape = traces.deviation.shape[:2]
    parts = {name: Estimate.empty(shape) for name in ("slope", "form", "total", "crowning")}
    share = np.zeros(shape)
    filtered, standard = np.full((2, *shape, len(station)), np.nan)
    line = np.full((*shape, 2), np.nan)
    widest = where.cutoff
    shift, excess = np.full(shape, np.nan), Estimate.empty(shape)
    normal = np.random.default_rng(seed).standard_normal((DRAWS, traces.deviation.shape[-1]))
    for tooth, side in np.ndindex(*shape):
        seen = traces.count[tooth, side] > 0
        if seen.sum() < 3:
            continue
        x, error = traces.station[tooth, side, seen], traces.standard_error[tooth, side, seen]
        weight = traces.count[tooth, side, seen].astype(float)
        known, matrix, cutoff, steady = filter_samples(station, x, weight, where, traces.step)
        share[tooth, side] = known[zone == INSIDE].mean()
        if not known.any():
            continue
        trace = matrix @ traces.deviation[tooth, side, seen]
        filtered[tooth, side, known] = trace
        standard[tooth, side, known] = np.sqrt((matrix**2) @ error**2)
        noise = (normal[:, seen] * error) @ matrix.T
        band = bands[side]
        limited = None if band is None else band.covers(station)
        if band is not None and limited is not None and limited.any() and known[limited].mean() >= LEAST_SHARE:
            inside = limited[known] & steady
            shift[tooth, side], one = fit_band(band, station[known][inside], trace[inside], noise[:, inside])
            _put(excess, one, tooth, side)
        if share[tooth, side] < LEAST_SHARE:
            continue
        widest = max(widest, float(cutoff.max()))
        counted = zone[known] != SHOWN
        inside = zone[known][counted] == INSIDE
        found = _deviations(
            station[known][counted], inside, steady[counted], where, trace[counted], noise[:, counted], matrix[counted], error
        )
        line[tooth, side] = found.pop("middle").value, found["slope"].value
        if traces.along == "z":
            found["slope"] = Estimate.plain(tuple(Side)[side] * found["slope"].value, found["slope"].standard)
        for name, one in found.items():
            _put(parts[name], one, tooth, side)
    return Evaluation(
        traces.along,
        where,
        traces.band,
        **parts,
        cutoff=widest,
        share=share,
        station=station,
        filtered=filtered,
        standard=standard,
        line=line,
        k=None if bands == (None, None) else KFit(bands, shift, excess),
    )


def pressure_angle_deviation(evaluation: Evaluation, gear: Gear) -> Estimate:
    """Pressure angle deviation that a profile slope amounts to, rad: −f_Hα / (L_α tan α), from f_Hα / L_α = Δr_b / r_b and
    r_b = r cos α."""
    factor = -1.0 / (evaluation.range.length * math.tan(gear.transverse_pressure_angle))
    return Estimate.plain(factor * evaluation.slope.value, abs(factor) * evaluation.slope.standard)


def _put(whole: Estimate, one: Estimate, tooth: int, side: int) -> None:
    for field in ("value", "standard", "noise"):
        getattr(whole, field)[tooth, side] = getattr(one, field)


def _deviations(
    station: Floats, within: Bools, steady: Bools, where: Range, trace: Floats, noise: Floats, matrix: Floats, error: Floats
) -> dict[str, Estimate]:
    """All deviations of one filtered trace; `noise` (draws, n) are simulated errors of it."""
    t = (station - where.middle) / where.length
    base = np.vander(t, 2, increasing=True)
    fit = np.linalg.pinv(base[within])
    parabola = np.linalg.pinv(np.vander(2.0 * t[within], 3, increasing=True))

    def linear(row: Floats) -> Estimate:
        through = (row @ matrix[within]) * error
        return Estimate.plain(row @ trace[within], np.sqrt(through @ through))

    def total(y: Floats) -> Floats:
        return np.asarray(y[:, steady].max(axis=-1) - y[:, within & steady].min(axis=-1))

    def form(y: Floats) -> Floats:
        return total(y - (y[:, within] @ fit.T) @ base.T)

    return {
        "middle": linear(fit[0]),
        "slope": linear(fit[1]),
        "crowning": linear(-parabola[2]),
        "form": of_statistic(form, trace, noise),
        "total": of_statistic(total, trace, noise),
    }
