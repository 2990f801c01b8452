"""Slope, form and total deviation of profile and helix traces, with crowning and uncertainty.

Signs
-----
Deviations δ are along the outward normal, + is too much material. Profile slope f_Hα is + with more material at the tip (the
pressure angle is then too small). Helix slope f_Hβ = s · (rise of δ towards +z), s = +1 left, −1 right: + is a flank screwed
right-handed, counter-clockwise with rising z, on either side of the tooth. ISO 1328-1 itself calls f_Hβ positive where the
helix angle is too large in amount, and for a spur gear names the hand in place of a sign [from memory of the standard]:
+ here is its "right". A taper (thicker towards +z) has opposite signs on the two sides.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearwear.arrays import Bools, Floats, Ints
from gearwear.design.gear import Gear
from gearwear.design.profiles import SIGN
from gearwear.measure.inspection.estimate import DRAWS, Estimate, of_statistic
from gearwear.measure.inspection.tolerances import Edition
from gearwear.measure.inspection.traces import Traces

GAUSS = math.sqrt(math.log(2.0) / math.pi)
"""α of ISO 16610-21: half of the amplitude passes at the cut-off wavelength."""

LEAST_CUTOFF = 0.25
"""Least cut-off wavelength, mm [from memory of ISO 1328-1:2013]."""

STATIONS_PER_CUTOFF = 4
THIN = 4.0
"""A station with this many times fewer points than the trace's median is a gap: near a base circle a scan is thin."""

LEAST_SHARE = 0.8
"""A trace with less than this share of its evaluation range seen is not evaluated."""


@dataclass(frozen=True, slots=True)
class Range:
    """Where a trace is evaluated and how it is filtered, mm.

    Parameters
    ----------
    start, end : float
        Evaluation range: L of a profile, z of a helix.
    outer : float
        Between `end` and here only too much material counts (profile: the end of the flank at the tip); `end` where there is
        no such zone.
    cutoff : float
        Cut-off wavelength λ of the Gauss filter.
    """

    start: float
    end: float
    outer: float
    cutoff: float

    def __post_init__(self) -> None:
        if not self.end > self.start:
            raise ValueError(f"the evaluation range from {self.start:g} to {self.end:g} mm is empty")

    @property
    def length(self) -> float:
        return self.end - self.start

    @property
    def middle(self) -> float:
        return 0.5 * (self.start + self.end)

    @property
    def gap(self) -> float:
        """A hole wider than this, mm, is never bridged: the cut-off or 5 % of the range, whichever is more (see also `THIN`)."""
        return max(self.cutoff, 0.05 * self.length)


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
    share : (teeth, 2) float
        Share of the evaluation range that was seen.
    station : (n,) float
        Places of the filtered trace over all of the flank, mm; evenly spaced in the evaluation range.
    filtered, standard : (teeth, 2, n) float
        Filtered trace and its standard uncertainty.
    line : (teeth, 2, 2) float
        Least-squares line: δ in the middle of the range, and its rise over the range (towards tip or +z).
    """

    along: str
    range: Range
    band: tuple[float, float]
    slope: Estimate
    form: Estimate
    total: Estimate
    crowning: Estimate
    share: Floats
    station: Floats
    filtered: Floats
    standard: Floats
    line: Floats

    def line_at(self, station: Floats) -> Floats:
        """The least-squares lines at `station` (n,), mm; (teeth, 2, n)."""
        t = (station - self.range.middle) / self.range.length
        return np.asarray(self.line[..., :1] + self.line[..., 1:] * t, dtype=np.float64)


def profile_range(gear: Gear, edition: Edition = Edition.ISO_2013, start: float | None = None) -> Range:
    """Evaluation range of the profile.

    Parameters
    ----------
    gear : Gear
        The nominal gear.
    edition : Edition
        2013: L_α is 95 % of the roll length from the profile control circle to the end of the flank, cut-off L_α / 30, at least
        0.25 mm. 1995: 92 %; it names no filter, the same rule is used. [From memory of the standards.]
    start : float or None
        L of the profile control circle, mm; None: the form circle. In a pair, the start of active profile.

    Examples
    --------
    >>> from gearwear.design import GearSpec
    >>> pinion = Gear.from_spec(GearSpec("pinion", 12, 6.35, 15.0, rack_tip_radius=0.25))
    >>> r = profile_range(pinion)
    >>> round(r.length, 2), round(r.cutoff, 3)
    (22.12, 0.737)
    """
    first = gear.form_roll if start is None else start
    length = (0.95 if edition is Edition.ISO_2013 else 0.92) * (gear.tip_roll - first)
    return Range(first, first + length, gear.tip_roll, max(LEAST_CUTOFF, length / 30.0))


def helix_range(gear: Gear) -> Range:
    """Evaluation range of the helix: the face between its chamfers less 5 % of its width or one module, whichever is less, at
    each end; cut-off L_β / 30, at least 0.25 mm [from memory of ISO 1328-1:2013; both editions].

    >>> from gearwear.design import GearSpec
    >>> r = helix_range(Gear.from_spec(GearSpec("pinion", 12, 6.35, 15.0)))
    >>> round(r.length, 6), round(r.cutoff, 3)
    (13.5, 0.45)
    """
    width = gear.face_width - 2.0 * gear.spec.end_chamfer
    less = gear.spec.end_chamfer + min(0.05 * width, gear.transverse_module)
    length = gear.face_width - 2.0 * less
    return Range(less, gear.face_width - less, gear.face_width - less, max(LEAST_CUTOFF, length / 30.0))


def gauss_filter(out: Floats, x: Floats, weight: Floats, cutoff: float) -> Floats:
    """Matrix of the Gauss filter from samples at `x` to places `out`.

    Parameters
    ----------
    out : (k,) float
        Where the filtered trace is wanted, mm.
    x, weight : (n,) float
        Places of the samples in mm, and their weights.
    cutoff : float
        λ_c in mm: a wave of this length passes with half its amplitude.

    Returns
    -------
    (k, n) float
        ``filtered = matrix @ samples``.

    Notes
    -----
    Weight function ``exp(−π (x / (α λ_c))²)``, α = sqrt(ln 2 / π) (ISO 16610-21). At ends and gaps its first moment is kept too
    (local line; one of the ways of ISO 16610-28 [from memory of the standard]): a straight line passes unchanged everywhere, and in the
    inside of an even trace nothing changes.
    """
    distance = x[None] - out[:, None]
    power = -math.pi * (distance / (GAUSS * cutoff)) ** 2
    power -= power.max(axis=1, keepdims=True)
    kernel = weight * np.where(power > -80.0, np.exp(power), 0.0)  # denormal numbers would slow every product
    kernel /= kernel.sum(axis=1, keepdims=True)
    mean = kernel @ x
    off = x[None] - mean[:, None]
    spread = (kernel * off**2).sum(axis=1) + (1e-6 * cutoff) ** 2
    return np.asarray(kernel * (1.0 + off * ((out - mean) / spread)[:, None]), dtype=np.float64)


def evaluate(traces: Traces, where: Range, seed: int = 0) -> Evaluation:
    """Filter every trace and take the deviations from it.

    Parameters
    ----------
    traces : Traces
        Profile or helix traces.
    where : Range
        From `profile_range` or `helix_range`.
    seed : int
        Of the simulated noise behind the uncertainty of form and total deviation.

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
    station, zone = _stations(where, reach)
    shape = traces.deviation.shape[:2]
    parts = {name: Estimate.empty(shape) for name in ("slope", "form", "total", "crowning")}
    share = np.zeros(shape)
    filtered, standard = np.full((2, *shape, len(station)), np.nan)
    line = np.full((*shape, 2), np.nan)
    normal = np.random.default_rng(seed).standard_normal((DRAWS, traces.deviation.shape[-1]))
    for tooth, side in np.ndindex(*shape):
        seen = traces.count[tooth, side] > 0
        if seen.sum() < 3:
            continue
        x, error = traces.station[tooth, side, seen], traces.standard_error[tooth, side, seen]
        known = _known(station, x, where.gap, traces.step)
        weight = traces.count[tooth, side, seen].astype(float)
        matrix = gauss_filter(station[known], x, weight, where.cutoff)
        thinness = (matrix**2) @ (1.0 / weight)
        enough = thinness <= THIN * np.median(thinness)
        usable = known.copy()
        usable[known] = enough
        usable = _long_runs(usable, STATIONS_PER_CUTOFF)
        matrix, known = matrix[usable[known]], usable
        share[tooth, side] = known[zone == INSIDE].mean()
        if not known.any():
            continue
        trace = matrix @ traces.deviation[tooth, side, seen]
        filtered[tooth, side, known] = trace
        standard[tooth, side, known] = np.sqrt((matrix**2) @ error**2)
        if share[tooth, side] < LEAST_SHARE:
            continue
        noise = (normal[:, seen] * error) @ matrix.T
        counted = zone[known] != SHOWN
        inside = zone[known][counted] == INSIDE
        found = _deviations(station[known][counted], inside, where, trace[counted], noise[:, counted], matrix[counted], error)
        line[tooth, side] = found.pop("middle").value, found["slope"].value
        if traces.along == "z":
            found["slope"] = Estimate.plain(SIGN[side] * found["slope"].value, found["slope"].standard)
        for name, one in found.items():
            for field in ("value", "standard", "noise"):
                getattr(parts[name], field)[tooth, side] = getattr(one, field)
    return Evaluation(
        traces.along, where, traces.band, **parts, share=share, station=station, filtered=filtered, standard=standard, line=line
    )


def pressure_angle_deviation(evaluation: Evaluation, gear: Gear) -> Estimate:
    """Pressure angle deviation that a profile slope amounts to, rad: −f_Hα / (L_α tan α) (Buckingham's relation; VDI/VDE 2612
    [from memory of the guideline])."""
    factor = -1.0 / (evaluation.range.length * math.tan(gear.transverse_pressure_angle))
    return Estimate.plain(factor * evaluation.slope.value, abs(factor) * evaluation.slope.standard)


@dataclass(frozen=True, slots=True)
class KBand:
    """Limits a trace must run between, wherever it lies as a whole (K chart).

    Parameters
    ----------
    station : (n,) float
        L or z of the corners, mm, rising.
    lower, upper : (n,) float
        Limits there, mm.
    """

    station: tuple[float, ...]
    lower: tuple[float, ...]
    upper: tuple[float, ...]

    @classmethod
    def straight(cls, where: Range, tolerance: float) -> KBand:
        """A band as wide as the total tolerance (mm) over the evaluation range."""
        return cls((where.start, where.end), (-0.5 * tolerance,) * 2, (0.5 * tolerance,) * 2)

    def place(self, station: Floats, trace: Floats) -> tuple[float, float]:
        """Shift of the band (mm) that suits the trace best, and how far the trace still leaves it (0: inside)."""
        within = np.isfinite(trace) & (station >= self.station[0] - 1e-9) & (station <= self.station[-1] + 1e-9)
        if not within.any():
            return math.nan, math.nan
        x, y = station[within], trace[within]
        above = float((y - np.interp(x, self.station, self.upper)).max())
        below = float((y - np.interp(x, self.station, self.lower)).min())
        return 0.5 * (above + below), max(0.0, 0.5 * (above - below))


SHOWN, INSIDE, ABOVE = range(3)
"""What a station counts for: the chart only; the evaluation; too much material only."""


def _stations(where: Range, reach: tuple[float, float]) -> tuple[Floats, Ints]:
    """Stations over the whole `reach` of the trace, evenly spaced piece by piece, and what each counts for."""
    corners = (reach[0], where.start, where.end, where.outer, reach[1])
    least = where.cutoff / STATIONS_PER_CUTOFF
    station, zone = [np.array([where.start])], [np.array([INSIDE])]
    for low, high, code in zip(corners[:-1], corners[1:], (SHOWN, INSIDE, ABOVE, SHOWN), strict=True):
        if high - low < 1e-9:
            continue
        piece = np.linspace(low, high, max(8 if code == INSIDE else 1, math.ceil((high - low) / least)) + 1)
        station.append(piece[:-1] if high == where.start else piece[1:])
        zone.append(np.full(len(station[-1]), code))
    order = np.argsort(np.concatenate(station))
    return np.concatenate(station)[order], np.concatenate(zone)[order]


def _known(station: Floats, x: Floats, gap: float, step: float) -> Bools:
    """Stations with samples round them: between two no farther apart than `gap`, or within a bin of one."""
    right = np.clip(np.searchsorted(x, station), 1, len(x) - 1)
    low, high = x[right - 1], x[right]
    bridged = (station >= low) & (station <= high) & (high - low <= gap)
    return np.asarray(bridged | (np.minimum(np.abs(station - low), np.abs(station - high)) <= step))


def _long_runs(known: Bools, least: int) -> Bools:
    """`known` without runs of fewer than `least` stations: shorter than the cut-off they are no trace."""
    edge = np.flatnonzero(np.diff(np.concatenate([[False], known, [False]])))
    out = np.zeros_like(known)
    for start, end in zip(edge[::2], edge[1::2], strict=True):
        out[start:end] = end - start >= least
    return out


def _deviations(
    station: Floats, within: Bools, where: Range, trace: Floats, noise: Floats, matrix: Floats, error: Floats
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
        return np.asarray(y.max(axis=-1) - y[:, within].min(axis=-1))

    def form(y: Floats) -> Floats:
        return total(y - (y[:, within] @ fit.T) @ base.T)

    return {
        "middle": linear(fit[0]),
        "slope": linear(fit[1]),
        "crowning": linear(-parabola[2]),
        "form": of_statistic(form, trace, noise),
        "total": of_statistic(total, trace, noise),
    }
