"""Slope, form and total deviation of profile and helix traces, with crowning and uncertainty.

Signs
-----
Deviations δ are along the transverse base tangent, out of the metal, + is too much material. Profile slope f_Hα is + with more material at the tip (the
pressure angle is then too small). Helix slope f_Hβ = s · (rise of δ towards +z), s = +1 left, −1 right: + is a flank screwed
right-handed, counter-clockwise with rising z, on either side of the tooth. ISO 1328-1 calls f_Hβ positive where the
helix angle is too large in amount, and for a spur gear names the hand in place of a sign (unconfirmed: docs/limits.md):
+ here is its "right". On a helical gear it is as there: of a left hand the sign is turned over. A taper (thicker towards +z) has opposite signs on the two sides.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from gearwear.arrays import Bools, Floats, Ints
from gearwear.design.gear import Gear
from gearwear.design.side import Side
from gearwear.inspection.estimate import DRAWS, Estimate, first_end, of_causes, with_sign_of
from gearwear.inspection.filtering import INSIDE, SHOWN, filter_samples, stations
from gearwear.inspection.k_band import KBand, KFit, fit_band
from gearwear.inspection.ranges import Range
from gearwear.inspection.traces import Traces
from gearwear.robust import NORMAL_MAD

LEAST_FLANKS = 3
"""That make a form common."""

CLIPPED = 3.0
"""Robust standard deviations from the median of its side beyond which a flank says nothing on it."""

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
    line_shared : (teeth, 2, 2, m) float or None
        What one standard deviation of each cause that bins have in common does to both numbers of the line, mm.
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
    line_shared: Floats | None = None

    def line_at(self, station: Floats) -> Floats:
        """The least-squares lines at `station` (n,), mm; (teeth, 2, n)."""
        t = (station - self.range.middle) / self.range.length
        return np.asarray(self.line[..., :1] + self.line[..., 1:] * t, dtype=np.float64)


def evaluate(
    traces: Traces,
    where: Range,
    bands: tuple[KBand | None, KBand | None] = (None, None),
    shared: Floats | None = None,
    common: CommonForm | None = None,
    hand: float = 1.0,
) -> Evaluation:
    """Filter every trace and take the deviations from it.

    Parameters
    ----------
    traces : Traces
        Profile or helix traces.
    where : Range
        From `profile_range` or `helix_range`.
    bands : (KBand or None, KBand or None)
        K bands of the left and of the right flanks.
    shared : (teeth, 2, n, m) float or None
        Errors that the bins of all flanks have in common (`registered.shared_errors`), mm.
    common : CommonForm or None
        Form that the flanks of a side have in common. Where a thin trace has no points it goes on as that form; None: as a line.
    hand : float
        Sign of helix slopes: −1 on a gear of left hand, so that + is too large a helix angle; else +1.

    Returns
    -------
    Evaluation

    Notes
    -----
    Slope: least-squares line over the evaluation range; its rise. Form: max − min about the line. Total: max − min about
    the design (deviations are already about it). Beyond `where.end` only what stands above counts. Slope and crowning are linear in the
    trace: their uncertainty is exact, from the bins' standard errors through filter and fit. For form and total see
    `estimate.of_causes`.
    """
    over = _Over.of(traces, where, shared, common)
    station, shape = over.station, traces.deviation.shape[:2]
    parts = {name: Estimate.empty(shape) for name in ("slope", "form", "total", "crowning")}
    caused = {} if shared is None else {name: np.full((*shape, shared.shape[-1]), np.nan) for name in parts}
    share = np.zeros(shape)
    filtered, standard = np.full((2, *shape, len(station)), np.nan)
    line = np.full((*shape, 2), np.nan)
    line_shared = None if shared is None else np.full((*shape, 2, shared.shape[-1]), np.nan)
    widest = where.cutoff
    shift, excess = np.full(shape, np.nan), Estimate.empty(shape)
    lines: dict[bytes, _Lines] = {}
    through = [_line(station, over.zone == INSIDE, where, form) for form in over.usual]
    for tooth, side in np.ndindex(*shape):
        trace = over.filtered(tooth, side)
        if trace is None:
            continue
        share[tooth, side] = trace.known[over.zone == INSIDE].mean()
        filtered[tooth, side, trace.known] = trace.trace
        standard[tooth, side, trace.known] = np.sqrt((trace.matrix**2) @ trace.error**2)
        band = bands[side]
        limited = None if band is None else band.covers(station)
        if band is not None and limited is not None and limited.any() and trace.known[limited].mean() >= LEAST_SHARE:
            inside = limited[trace.known] & trace.steady
            shift[tooth, side], estimate = fit_band(band, trace.station[inside], trace.trace[inside], trace.noise[:, inside])
            _put(excess, estimate, tooth, side)
        if share[tooth, side] < LEAST_SHARE:
            continue
        widest = max(widest, trace.cutoff)
        if (seen_at := trace.known.tobytes()) not in lines:  # most flanks are known at the same stations
            lines[seen_at] = _Lines.of(trace.counted, where)
        deviations = _deviations(trace.counted, lines[seen_at], through[side])
        ends = deviations.pop("middle"), deviations["slope"]
        line[tooth, side] = [end.value for end in ends]
        if line_shared is not None:
            line_shared[tooth, side] = [end.shared for end in ends]
        factor = (hand * tuple(Side)[side] if traces.along == "z" else 1.0) * where.stated / where.length
        slope = deviations["slope"]
        turned = None if slope.shared is None else factor * slope.shared
        deviations["slope"] = replace(Estimate.plain(factor * slope.value, abs(factor) * slope.standard), shared=turned)
        for name, causes in caused.items():
            causes[tooth, side] = deviations[name].shared
        for name, estimate in deviations.items():
            _put(parts[name], estimate, tooth, side)
    parts |= {name: replace(parts[name], shared=causes) for name, causes in caused.items()}
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
        line_shared=line_shared,
    )


@dataclass(frozen=True, slots=True)
class _Trace:
    """One trace through the filter, at n of the stations.

    Parameters
    ----------
    known : (stations,) bool
        Those of all stations that it is known at.
    station, zone : (n,)
        Of these: place in mm, and which part of the flank it is.
    trace : (n,) float
        Deviation, mm.
    steady : (n,) bool
        Where the filter's window is not cut off.
    matrix : (n, bins) float
        The filter.
    error : (bins,) float
        Standard error of the bins, mm.
    noise : (draws, n) float
        Simulated errors of the trace, mm.
    moved : (n, m) float or None
        What one standard deviation of each cause that bins have in common does to it, mm.
    usual : (n,) float
        Form common to its side, mm.
    cutoff : float
        Largest that was used, mm.
    """

    known: Bools
    station: Floats
    zone: Ints
    trace: Floats
    steady: Bools
    matrix: Floats
    error: Floats
    noise: Floats
    moved: Floats | None
    usual: Floats
    cutoff: float

    @property
    def counted(self) -> _Trace:
        """Without what is only shown."""
        on = _run(self.zone != SHOWN)
        moved = None if self.moved is None else self.moved[on]
        of_stations = {name: getattr(self, name)[on] for name in ("station", "zone", "trace", "steady", "matrix", "usual")}
        return replace(self, **of_stations, noise=self.noise[:, on], moved=moved)


@dataclass(frozen=True, slots=True)
class _Over:
    """What the traces of all flanks are evaluated over: stations with their zones, the form common to each side there, (2, n) mm; what causes in
    common do to the bins; and normal numbers that errors of bins and causes are drawn with."""

    traces: Traces
    where: Range
    station: Floats
    zone: Ints
    usual: Floats
    shared: Floats | None
    normal: Floats
    motion: Floats | None

    @classmethod
    def of(cls, traces: Traces, where: Range, shared: Floats | None, common: CommonForm | None) -> _Over:
        reach = min(where.start, traces.centre[0] - 0.5 * traces.step), max(where.outer, traces.centre[-1] + 0.5 * traces.step)
        station, zone = stations(where, reach)
        rng = np.random.default_rng(0)
        normal = rng.standard_normal((DRAWS, traces.deviation.shape[-1]))
        motion = None if shared is None else rng.standard_normal((DRAWS, shared.shape[-1]))
        usual = np.zeros((2, len(station))) if common is None else np.stack([common.at(side, station)[0] for side in (0, 1)])
        return cls(traces, where, station, zone, usual, shared, normal, motion)

    def filtered(self, tooth: int, side: int) -> _Trace | None:
        """The trace of one flank; None where too little of it was seen."""
        traces, usual = self.traces, self.usual[side]
        seen = traces.count[tooth, side] > 0
        if seen.sum() < 3:
            return None
        x, error = traces.station[tooth, side, seen], traces.standard_error[tooth, side, seen]
        weight = traces.count[tooth, side, seen].astype(float)
        known, matrix, cutoff, steady = filter_samples(self.station, x, weight, self.where, traces.step)
        if not known.any():
            return None
        trace = matrix @ (traces.deviation[tooth, side, seen] - np.interp(x, self.station, usual)) + usual[known]
        moved = None if self.shared is None else matrix @ self.shared[tooth, side, seen]
        way = first_end(traces.deviation[tooth, side]) if traces.along == "z" else 1
        noise = (self.normal[:, ::way][:, seen] * error) @ matrix.T
        if moved is not None and self.motion is not None:
            noise += self.motion @ with_sign_of(trace, moved).T
        return _Trace(
            known=known, station=self.station[known], zone=self.zone[known], trace=trace, steady=steady, matrix=matrix, error=error, noise=noise,
            moved=moved, usual=usual[known], cutoff=float(cutoff.max()),
        )  # fmt: skip


def pressure_angle_deviation(evaluation: Evaluation, gear: Gear) -> Estimate:
    """Pressure angle deviation that a profile slope amounts to, rad: −f_Hα / (L_α tan α), from f_Hα / L_α = Δr_b / r_b and
    r_b = r cos α."""
    factor = -1.0 / (evaluation.range.stated * math.tan(gear.transverse_pressure_angle))
    return Estimate.plain(factor * evaluation.slope.value, abs(factor) * evaluation.slope.standard)


@dataclass(frozen=True, slots=True)
class CommonForm:
    """Form that the flanks of a side have in common beside their lines.

    Parameters
    ----------
    station : (n,) float
        mm.
    form, standard : (2, n) float
        mm; 0 where too few flanks tell of it.
    """

    station: Floats
    form: Floats
    standard: Floats

    def at(self, side: int, station: Floats) -> tuple[Floats, Floats]:
        """Form and standard uncertainty at these places, mm."""
        return np.interp(station, self.station, self.form[side]), np.interp(station, self.station, self.standard[side])


def common_form(traces: Traces, evaluation: Evaluation) -> CommonForm:
    """Filtered once more, from the points of all flanks of a side together, each about its own line; nothing with fewer than `LEAST_FLANKS` flanks.

    A trace too thin for the standard's filter is smoothed too much, and its line with it; all flanks together are not.
    """
    where, station = evaluation.range, evaluation.station
    form, standard = np.zeros((2, 2, len(station)))
    for side in (0, 1):
        used = np.isfinite(evaluation.slope.value[:, side])
        if used.sum() < LEAST_FLANKS:
            continue
        line = evaluation.line[used, side]
        t = (traces.station[used, side] - where.middle) / where.length
        off = traces.deviation[used, side] - line[:, :1] - line[:, 1:] * t
        seen = traces.count[used, side] > 0
        enough = seen.sum(axis=0) >= max(LEAST_FLANKS, 0.25 * used.sum())
        if enough.sum() < LEAST_FLANKS:
            continue
        off, seen = off[:, enough], seen[:, enough]
        middle = np.nanmedian(off, axis=0)
        spread = NORMAL_MAD * np.nanmedian(np.abs(off - middle), axis=0)
        near = seen & (np.abs(off - middle) <= CLIPPED * np.maximum(spread, np.median(spread)))
        weight = np.where(near, traces.count[used, side][:, enough], 0).astype(float)
        total = weight.sum(axis=0)
        x = np.nansum(weight * traces.station[used, side][:, enough], axis=0) / total
        y = np.nansum(weight * off, axis=0) / total
        error = (
            np.sqrt(np.nansum(weight**2 * np.maximum(traces.standard_error[used, side][:, enough], spread) ** 2, axis=0)) / total
        )
        known, matrix, _, _ = filter_samples(station, x, total, where, traces.step)
        if known.any():  # beyond as at its edge
            form[side] = np.interp(station, station[known], matrix @ y)
            standard[side] = np.interp(station, station[known], np.sqrt((matrix**2) @ error**2))
    return CommonForm(station, form, standard)


def _line(station: Floats, within: Bools, where: Range, values: Floats) -> Floats:
    """Least-squares line through `values` over the evaluation range: in its middle, and its rise."""
    t = (station[within] - where.middle) / where.length
    share = _root_of_steps(t)
    return np.asarray((np.linalg.pinv(np.vander(t, 2, increasing=True) * share[:, None]) * share) @ values[within])


def _root_of_steps(t: Floats) -> Floats:
    """Root of the length that each station stands for (trapezoidal rule), so that a line is fitted to the trace and not to its stations; wide
    gaps do not count."""
    step = np.diff(t)
    step = np.where(step > 1.5 * np.median(step), np.median(step), step)
    return np.asarray(np.sqrt(0.5 * (np.append(step, step[-1] * 0.0) + np.append(step[0] * 0.0, step))))


def _put(whole: Estimate, estimate: Estimate, tooth: int, side: int) -> None:
    for field in ("value", "standard", "noise"):
        getattr(whole, field)[tooth, side] = getattr(estimate, field)


@dataclass(frozen=True, slots=True)
class _Lines:
    """What fits lines to traces that are known at the same stations: `base` (n, 2) is 1 and the way along, `fit` (2, inside) and `parabola` (3,
    inside) give the coefficients of both from the values inside the evaluation range."""

    inside: slice | Ints
    base: Floats
    fit: Floats
    parabola: Floats

    @classmethod
    def of(cls, one: _Trace, where: Range) -> _Lines:
        within = one.zone == INSIDE
        t = (one.station - where.middle) / where.length
        base = np.vander(t, 2, increasing=True)
        share = _root_of_steps(t[within])
        fit = np.linalg.pinv(base[within] * share[:, None]) * share
        parabola = np.linalg.pinv(np.vander(2.0 * t[within], 3, increasing=True) * share[:, None]) * share
        return cls(_run(within), base, fit, parabola)


def _run(mask: Bools) -> slice | Ints:
    """Index of what is True, a slice where it lies side by side: that is a view, where a mask copies."""
    index = np.flatnonzero(mask)
    return slice(int(index[0]), int(index[-1]) + 1) if len(index) and index[-1] - index[0] + 1 == len(index) else index


def _deviations(one: _Trace, lines: _Lines, whole: Floats) -> dict[str, Estimate]:
    """All deviations of one filtered trace; `whole` (2,) is the line through the form common to its side, over all of the range."""
    trace, matrix, usual = one.trace, one.matrix, one.usual
    base, fit, parabola, inside = lines.base, lines.fit, lines.parabola, lines.inside
    high, low = _run(one.steady), _run((one.zone == INSIDE) & one.steady)
    own = (trace - usual)[inside]

    def linear(row: Floats, instead: float) -> Estimate:
        """Of what the flank has for itself, and `instead` of the form common to all."""
        through = (row @ matrix[inside]) * one.error
        shared = None if one.moved is None else row @ one.moved[inside]
        return Estimate.plain(row @ own + instead, np.sqrt(through @ through), shared)

    line = whole + np.array([row @ own for row in fit])

    def total(y: Floats) -> Floats:
        return np.asarray(y[:, high].max(axis=-1) - y[:, low].min(axis=-1))

    def form(y: Floats) -> Floats:
        return total(y - (y[:, inside] @ fit.T) @ base.T)

    # The line through what was seen of the common form is not the one through all of it.
    bent = trace - base @ (line - np.array([row @ trace[inside] for row in fit]))
    return {
        "middle": linear(fit[0], float(whole[0])),
        "slope": linear(fit[1], float(whole[1])),
        "crowning": linear(-parabola[2], float(-parabola[2] @ usual[inside])),
        "form": of_causes(form, bent, one.noise, one.moved),
        "total": of_causes(total, trace, one.noise, one.moved),
    }
