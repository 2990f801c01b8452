"""Waviness over all teeth: orders of the revolution, so that a wave that the machine left on the gear is found whatever tooth it lies on.

Each point of a flank meets the mate at one angle of the gear. Written over that angle the flanks of all teeth make one curve with overlaps; a wave of order n runs
through it n times in a revolution. Multiples of the number of teeth are the profile form that all teeth share; other orders, ghost orders, come from the
machine: the teeth of its worm wheel, a spindle.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from gearwear.arrays import Floats, Ints
from gearwear.design.side import Side
from gearwear.inspection.areal import SURFACE_TERMS, surface_terms
from gearwear.inspection.estimate import COVERAGE_FACTOR
from gearwear.inspection.ranges import Range
from gearwear.inspection.traces import FlankSamples
from gearwear.robust import scale_about, some_of

MOST_VALUES, FEWEST_POINTS = 3_000_000, 5_000
"""Points times orders that are looked at on a side, of more evenly as many; but so many points at least."""

FALSE_ALARM = 0.01
"""Chance that any order stands out of a gear that has none."""

MOST_FOUND = 10
"""Orders that are named."""

LEAST_WAVES = 1.0
"""Waves in the profile evaluation range from which an order is looked for: a longer one is slope and crowning."""

CLIPPED = 4.0
"""Robust standard deviations of a side beyond which a point says nothing on waves."""

PASSES = 3
"""In which points off the form of their flank are left out."""


@dataclass(frozen=True, slots=True)
class Wave:
    """One order that stands out.

    Parameters
    ----------
    order : int
        Waves in a revolution.
    amplitude, standard : float
        mm along the transverse base tangent, and its standard uncertainty.
    phase : float
        rad: ``δ = amplitude · cos(order · φ + phase)``, φ the angle of the gear at which a point is on the line of action.
    """

    order: int
    amplitude: float
    standard: float
    phase: float

    @property
    def expanded(self) -> float:
        """U, mm."""
        return COVERAGE_FACTOR * self.standard


@dataclass(frozen=True, slots=True)
class Waviness:
    """Spectra of both sides.

    Parameters
    ----------
    teeth : int
        Of the gear.
    orders : (m,) int
        That were looked at.
    amplitude : (2, m) float
        Of each order alone, mm; left flanks first; nan of a side that was not seen.
    limit : (2,) float
        What an amplitude must exceed to stand out, mm.
    waves : (tuple of Wave, tuple of Wave)
        What stands out on left and on right flanks, largest first.
    """

    teeth: int
    orders: Ints
    amplitude: Floats
    limit: Floats
    waves: tuple[tuple[Wave, ...], tuple[Wave, ...]]

    def is_ghost(self, wave: Wave) -> bool:
        """Not a multiple of the number of teeth."""
        return wave.order % self.teeth != 0


def wave_spectrum(samples: FlankSamples, profile: Range, helix: Range, noise: float) -> Waviness:
    """Orders of the revolution in the flanks of either side.

    Parameters
    ----------
    samples : FlankSamples
        The flanks' points.
    profile, helix : Range
        L and z of the evaluated area; waves shorter than the profile's cut-off are not looked for.
    noise : float
        Standard deviation of one point with what hangs together, mm.

    Notes
    -----
    The point at L and z of tooth k is on the line of action at ``φ = ι L / r_b − s (2π k / z + κ (z − b/2))``, s = +1 left and −1 right, but for a
    constant and the sense of turning; ι = −1 on a ring. Level, slopes, crownings and twist of every flank are free beside each wave (its columns are
    made orthogonal to them), so that they neither pass for one nor hide one. Orders are found one by one, the largest first, and fitted
    together after each, as Gravel does on profile traces. An order stands out above ``s sqrt(2 ln(m / FALSE_ALARM))``: s is the standard error of a
    coefficient from the noise, or the spectrum's own floor (median amplitude / sqrt(2 ln 2)), the greater.
    """
    gear = samples.gear
    first = math.ceil(LEAST_WAVES * 2.0 * math.pi * gear.base_radius / profile.length)
    last = max(first, math.floor(2.0 * math.pi * gear.base_radius / profile.cutoff))
    orders = np.arange(first, last + 1)
    amplitude, limit = np.full((2, len(orders)), np.nan), np.full(2, np.nan)
    waves: list[tuple[Wave, ...]] = []
    for side in Side:
        part = samples.inside(profile.ends, helix.ends)
        part = part.take(part.flank % 2 == side.index)
        most = max(FEWEST_POINTS, MOST_VALUES // len(orders))
        roll, from_middle = part.roll / gear.transverse_module, np.abs(part.z - 0.5 * gear.face_width) / gear.transverse_module
        part = part.take(some_of(roll, from_middle, most))
        amplitude[side.index], limit[side.index], named = _side(part, profile, helix, side, orders, noise)
        waves.append(named)
    return Waviness(gear.teeth, orders, amplitude, limit, (waves[0], waves[1]))


def roll_angle(samples: FlankSamples, side: Side) -> Floats:
    """Angle φ of the gear (rad) at which each point of flanks of one side is on the line of action, but for a constant."""
    gear = samples.gear
    turned = gear.pitch_angle * (samples.flank // 2) + gear.twist * (samples.z - 0.5 * gear.face_width)
    return np.asarray(samples.roll / gear.base_radius - side * turned, dtype=np.float64)


@dataclass(frozen=True, slots=True)
class _Flanks:
    """Points of one side, flank after flank, and an orthonormal basis of what each flank's form can do."""

    points: FlankSamples
    pieces: tuple[slice, ...]
    bases: tuple[Floats, ...]

    @classmethod
    def of(cls, points: FlankSamples, profile: Range, helix: Range) -> _Flanks:
        flanks = [mine for mine in points.by_flank() if len(mine) > 2 * SURFACE_TERMS]
        points = points.take(np.concatenate([points.flank[:0], *flanks]))
        pieces = tuple(slice(a, b) for a, b in pairwise(np.cumsum([0, *map(len, flanks)])))
        form = surface_terms(profile.from_middle(points.roll), helix.from_middle(points.z))
        return cls(points, pieces, tuple(np.linalg.qr(form[mine])[0] for mine in pieces))

    def free(self, columns: Floats) -> Floats:
        """Columns (points, k) without what the form of each flank can do."""
        parts = (columns[mine] - base @ (base.T @ columns[mine]) for mine, base in zip(self.pieces, self.bases, strict=True))
        return np.concatenate([np.zeros((0, columns.shape[1])), *parts])


def _side(
    points: FlankSamples, profile: Range, helix: Range, side: Side, orders: Ints, noise: float
) -> tuple[Floats, float, tuple[Wave, ...]]:
    """Amplitudes of all orders, the limit, and what stands out."""
    flanks = _Flanks.of(points, profile, helix)
    delta = flanks.free(flanks.points.deviation[:, None])[:, 0]
    for _ in range(PASSES):
        spread = scale_about(delta) if len(delta) else 0.0
        near = np.abs(delta) <= CLIPPED * max(spread, 1e-9)
        if near.all():
            break
        flanks = _Flanks.of(flanks.points.take(near), profile, helix)
        delta = flanks.free(flanks.points.deviation[:, None])[:, 0]
    if len(flanks.pieces) < 2:
        return np.full(len(orders), np.nan), math.nan, ()
    turns = roll_angle(flanks.points, side)[:, None] * orders
    cosine, sine = flanks.free(np.cos(turns)), flanks.free(np.sin(turns))
    cc, ss, cs = (cosine**2).sum(axis=0), (sine**2).sum(axis=0), (cosine * sine).sum(axis=0)
    determinant = cc * ss - cs * cs
    error = np.sqrt(0.5 * (cc + ss) / determinant)

    def sizes(values: Floats) -> Floats:
        yc, ys = values @ cosine, values @ sine
        return np.asarray(np.hypot(ss * yc - cs * ys, cc * ys - cs * yc) / determinant)

    alone = remaining = sizes(delta)
    chosen: list[int] = []
    columns, residual = np.zeros((len(delta), 0)), delta
    solution: Floats = np.zeros(0)
    while True:
        floor = float(np.median(remaining / error)) / math.sqrt(2.0 * math.log(2.0))
        ratio = max(noise, floor) * math.sqrt(2.0 * math.log(len(orders) / FALSE_ALARM))
        at = int(np.argmax(np.where(np.isin(np.arange(len(orders)), chosen), 0.0, remaining / error)))
        if remaining[at] <= ratio * error[at] or len(chosen) == MOST_FOUND:
            break
        chosen.append(at)
        columns = np.column_stack([columns, cosine[:, at], sine[:, at]])
        solution = np.asarray(np.linalg.lstsq(columns, delta, rcond=None)[0], dtype=np.float64)
        residual = delta - columns @ solution
        remaining = sizes(residual)
    scatter = max(noise, float(np.sqrt((residual**2).mean())))
    covariance: Floats = np.asarray(scatter**2 * np.linalg.pinv(columns.T @ columns), dtype=np.float64)
    waves = [
        _wave(int(orders[at]), solution[2 * i : 2 * i + 2], covariance[2 * i : 2 * i + 2, 2 * i : 2 * i + 2])
        for i, at in enumerate(chosen)
    ]
    return alone, ratio * float(np.median(error)), tuple(sorted(waves, key=lambda wave: -wave.amplitude))


def _wave(order: int, amplitudes: Floats, covariance: Floats) -> Wave:
    """From the coefficients of cosine and sine."""
    size = float(np.hypot(*amplitudes))
    along = amplitudes / size
    return Wave(order, size, math.sqrt(float(along @ covariance @ along)), math.atan2(-amplitudes[1], amplitudes[0]))
