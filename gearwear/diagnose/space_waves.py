"""Waves that stand in space: fringes of a projector, a ripple of the measuring volume.

A scanner knows nothing of teeth. Its wave carries points by d(P) = a cos 2π k·P + b sin 2π k·P, a deviation n · d. On the flanks such a wave is another
one on every tooth, so that neither what teeth share nor waves round the gear show it; over all the gear it is one line of the spectrum in space. What is
the gear's own differs from tooth to tooth by chance, or is alike in the teeth's own axes, and is spread over all directions there.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy import fft
from scipy.optimize import minimize
from scipy.special import stdtr

from gearwear.arrays import Floats, Ints
from gearwear.design.surface import END_HIGH, END_LOW, FILLET, FLANK, ROOT, SurfacePoints
from gearwear.diagnose.rules import rules
from gearwear.placing.cells import CellGrid, Cells

CELLS_PER_WAVE = 4.0
"""Cells in the shortest wave that is looked for: the mean of a cell holds 0.9 of it."""
WAVES_PER_RADIUS = 20.0
"""Shortest wave that is looked for, in the radius of the gear, whatever the cells: bounds the spectrum."""
CLOSER = {"xatol": 1e-5, "fatol": 1e-2, "maxfev": 80}
"""Of the search for the vector of a wave; numerical."""
VOXELS_PER_WAVE = 3.0
"""Voxels in the shortest wave; numerical."""
SWEEPS = 3
"""Of means of flanks and of places on a flank, taken off in turn; numerical."""
SEEN = 1e-3
"""Share of the normals along a direction below which displacements along it are not seen; numerical."""
SHELL = 4
"""Lines of the spectrum that a shell is thick; numerical."""


@dataclass(frozen=True, slots=True)
class SpaceWave:
    """One wave, in the design's axes.

    Parameters
    ----------
    vector : (3,) float
        Waves per mm along x, y and z.
    cosine, sine : (3,) float
        Displacement of points at phase 0 and at a quarter, mm.
    p_value : float
        Of what one half of the teeth tells the other of it, the less sure of both ways.
    """

    vector: Floats
    cosine: Floats
    sine: Floats
    p_value: float

    @property
    def wavelength(self) -> float:
        """mm."""
        return 1.0 / float(np.linalg.norm(self.vector))

    @property
    def direction(self) -> Floats:
        """Unit vector (3,) along which it goes."""
        return self.vector * self.wavelength

    @property
    def amplitude(self) -> float:
        """Greatest displacement, mm."""
        return float(np.linalg.norm(np.column_stack([self.cosine, self.sine]), ord=2))

    def describe(self) -> str:
        """Words an engineer can use."""
        along = ", ".join(f"{one:.2f}" for one in self.direction)
        return f"a wave that stands in space, {self.wavelength:.1f} mm long along ({along}), {1e3 * self.amplitude:.1f} µm high"

    def deviation(self, points: SurfacePoints) -> Floats:
        """Of points (n,), mm, + outward."""
        phase = 2.0 * math.pi * (points.position @ self.vector)
        carried = np.cos(phase)[:, None] * self.cosine + np.sin(phase)[:, None] * self.sine
        return np.asarray(np.einsum("ij,ij->i", points.normal, carried), dtype=np.float64)


def find_space_waves(cells: Cells, noise: float) -> tuple[SpaceWave, ...]:
    """Waves in space, the strongest first.

    Parameters
    ----------
    cells : Cells
        A registered scan, binned; neither pose nor effects need be known.
    noise : float
        Scatter of points, mm.

    Returns
    -------
    tuple of SpaceWave
        Each was found in either half of the teeth and lowers the error of the other; at most as many as patterns are reported.
    """
    if cells.grid.rows < rules().pattern_rows or not cells.seen.any():
        return ()
    sheet = _Sheet.of(cells, noise)
    if len(np.unique(sheet.points.tooth[sheet.weight > 0.0])) < rules().pattern_teeth:
        return ()
    found = list[SpaceWave]()
    for _ in range(rules().most_patterns):
        one = _strongest(sheet, noise)
        if one is None:
            break
        found.append(one)
        sheet = sheet.without(one)
    return tuple(found)


@dataclass(frozen=True)
class _Sheet:
    """The cells that are seen, their weights, and which of them share a flank or a place on it."""

    grid: CellGrid
    points: SurfacePoints
    value: Floats
    weight: Floats
    flank: Ints
    place: Ints

    @classmethod
    def of(cls, cells: Cells, noise: float) -> _Sheet:
        seen = np.flatnonzero(cells.seen & np.isin(cells.points.surface, (FLANK, FILLET, ROOT, END_LOW, END_HIGH)))
        flank, place = _labels(cells.grid)
        texture = (rules().first_correlation * noise) ** 2
        weight = 1.0 / (noise**2 / np.maximum(cells.count[seen], 1.0) + texture)
        points = cells.points.take(seen)
        whole = cls(cells.grid, points, points.deviation, weight, flank[seen], place[seen])
        for _ in range(2):  # wear, chips and strays are no wave: what stands far off is left out
            left = whole.filtered(whole.value[:, None])[:, 0]
            scale = 1.4826 * float(np.median(np.abs(left[whole.weight > 0.0])))
            whole = replace(whole, weight=np.where(np.abs(left) <= rules().errors * scale, weight, 0.0))
        return whole

    def without(self, wave: SpaceWave) -> _Sheet:
        """The rest, once a wave is known."""
        return replace(self, value=self.value - wave.deviation(self.points))

    def filtered(self, values: Floats) -> Floats:
        """Values (n, k) without the mean of every flank and that of every place on a flank."""
        for _ in range(SWEEPS):
            for label in (self.place, self.flank):
                values = values - _means(values, self.weight, label)
        return values

    @cached_property
    def left(self) -> Floats:
        """(n,) mm."""
        return self.filtered(self.value[:, None])[:, 0]

    @cached_property
    def squares(self) -> Floats:
        """(3, 3) weighted sum of n nᵀ, of which either phase of a wave has half."""
        return np.asarray((self.points.normal * self.weight[:, None]).T @ self.points.normal, dtype=np.float64)

    def every_other(self, start: int) -> _Sheet:
        """Every other of the teeth that are seen, alone."""
        seen = np.unique(self.points.tooth[self.weight > 0.0])
        return replace(self, weight=np.where(np.isin(self.points.tooth, seen[start::2]), self.weight, 0.0))

    def gain(self, vector: Floats) -> float:
        """Fall of the weighted square by the wave of a vector, beside all that is taken off."""
        through = self.filtered(_columns(self.points, vector))
        return float(_solved(through, self.left, self.weight) @ (through.T @ (self.weight * self.left)))

    def gain_about(self, vector: Floats) -> float:
        """The same, as though all that is taken off had nothing in common with the wave."""
        turned = np.exp(-2j * math.pi * (self.points.position @ vector)) * (self.weight * self.left)
        moment = turned @ self.points.normal
        return 2.0 * float(np.real(np.conj(moment) @ np.linalg.pinv(self.squares, rcond=SEEN) @ moment))


def _labels(grid: CellGrid) -> tuple[Ints, Ints]:
    """Which flank (or part of another surface) each cell is of, and which place on it, (m,): those of one place lie alike on all teeth."""
    flank, place = np.zeros(grid.count, np.int64), np.zeros(grid.count, np.int64)
    last = 0
    for surface, (start, size) in grid.blocks.items():
        at, per_tooth = np.arange(size), size // grid.gear.teeth
        parts = 2 if surface in (FLANK, FILLET) else 1
        flank[start : start + size] = last + at // (per_tooth // parts)
        place[start : start + size] = start + at % per_tooth
        last += parts * grid.gear.teeth
    return flank, place


def _means(values: Floats, weight: Floats, label: Ints) -> Floats:
    """Weighted means of values (n, k) that share a label (n,), at each."""
    total = np.maximum(np.bincount(label, weight), 1e-300)
    means = np.column_stack([np.bincount(label, weight * column, minlength=len(total)) for column in values.T]) / total[:, None]
    return np.asarray(means[label], dtype=np.float64)


def _strongest(sheet: _Sheet, noise: float) -> SpaceWave | None:
    """The strongest wave; None where one half of the teeth does not tell the other of it, each of a wave it found by itself."""
    halves = [sheet.every_other(start) for start in range(2)]
    known = _Lines.of(sheet)  # the halves have their cells at the same places
    lines = [_climbed(half.gain_about, known.strongest(half)) for half in halves]
    told = [_told(half, other, line) for half, other, line in zip(halves, reversed(halves), lines, strict=True)]
    if not all(one.gain > rules().errors * one.error for one in told):
        return None
    vector = _climbed(sheet.gain, max(lines, key=sheet.gain))
    through = sheet.filtered(_columns(sheet.points, vector))
    cosine, sine = np.split(_solved(through, sheet.left, sheet.weight), 2)
    wave = SpaceWave(vector, cosine, sine, max(one.p_value for one in told))
    flank = sheet.points.surface == FLANK
    size = float(np.sqrt(np.mean(wave.deviation(sheet.points)[flank] ** 2)))
    return wave if size > rules().least_share * noise else None


def _climbed(gain: Callable[[Floats], float], vector: Floats) -> Floats:
    """The vector of most gain, from one close by."""
    return np.asarray(minimize(lambda k: -gain(k), vector, method="Nelder-Mead", options=CLOSER).x)


def _columns(points: SurfacePoints, vector: Floats) -> Floats:
    """Deviation (n, 6) of points by unit displacements along x, y and z, at phase 0 and at a quarter."""
    phase = 2.0 * math.pi * (points.position @ vector)
    return np.hstack([np.cos(phase)[:, None] * points.normal, np.sin(phase)[:, None] * points.normal])


def _solved(columns: Floats, value: Floats, weight: Floats) -> Floats:
    own = columns * weight[:, None]
    return np.asarray(np.linalg.lstsq(own.T @ columns, own.T @ value, rcond=SEEN)[0], dtype=np.float64)


@dataclass(frozen=True, slots=True)
class _Told:
    """What a wave of some teeth explains on others: the fall of their weighted square, a cell, the mean of the teeth and its standard error."""

    gain: float
    error: float
    p_value: float


def _told(half: _Sheet, other: _Sheet, vector: Floats) -> _Told:
    columns = _columns(half.points, vector)
    through = other.filtered(columns) @ _solved(half.filtered(columns), half.left, half.weight)
    fall = other.weight * (other.left**2 - (other.left - through) ** 2)
    tooth = other.points.tooth
    cells = np.bincount(tooth, other.weight)
    gains = np.bincount(tooth, fall)[cells > 0.0] / cells[cells > 0.0]
    error = max(float(np.std(gains, ddof=1)) / math.sqrt(len(gains)), 1e-300)
    return _Told(float(gains.mean()), error, float(stdtr(len(gains) - 1.0, -gains.mean() / error)))


@dataclass(frozen=True, slots=True)
class _Lines:
    """The lines of the spectrum in space that are looked for, of cells at the same places.

    Parameters
    ----------
    voxel : (n,) int
        In which of all voxels each cell lies.
    extent, shape : tuple of int, list of int
        Voxels along x, y and z: those that hold cells, and with the room that the transform needs.
    along : list of (k,) int
        Lines along each axis up to the shortest wave.
    waves : list of (k,) float
        Of these, waves per mm.
    which, mirror : (l,) int
        Those of all directions that are looked for, and their mirror images, among all of these laid flat: millions of a large gear.
    order : (l,) int
        The lines shell by shell: those of about one length across and along the axis.
    ends : (s,) int
        Where each shell but the last ends among these.
    """

    voxel: Ints
    extent: tuple[int, ...]
    shape: list[int]
    along: list[Ints]
    waves: list[Floats]
    which: NDArray[np.int32]
    mirror: NDArray[np.int32]
    order: NDArray[np.int32]
    ends: Ints

    @classmethod
    def of(cls, sheet: _Sheet) -> _Lines:
        """Of all cells of a sheet, whatever they weigh."""
        position, radius = sheet.points.position, sheet.grid.gear.tip_radius
        shortest = max(CELLS_PER_WAVE * sheet.grid.size, radius / WAVES_PER_RADIUS)
        voxel = shortest / VOXELS_PER_WAVE
        at = np.rint((position - position.min(axis=0)) / voxel).astype(np.int64)
        extent = tuple((at.max(axis=0) + 1).tolist())
        shape = [fft.next_fast_len(2 * one) for one in extent]
        # As many lines to either side of 0 along each axis as the shortest wave has, less than half of all.
        along = [np.r_[: int(n / VOXELS_PER_WAVE) + 1, n - int(n / VOXELS_PER_WAVE) : n] for n in shape]
        waves = [np.fft.fftfreq(n, voxel)[own] for n, own in zip(shape, along, strict=True)]
        ahead = waves[0][waves[0] >= 0.0]  # a wave and its mirror image are one
        across = np.hypot(ahead[:, None], waves[1][None, :])
        length = np.sqrt(across[:, :, None] ** 2 + waves[2] ** 2)
        places = np.nonzero((length >= 1.0 / radius) & (length <= 1.0 / shortest))
        del length
        kept = tuple(len(own) for own in along)
        which, mirror = (
            np.ravel_multi_index(one, kept, mode="wrap").astype(np.int32) for one in (places, tuple(-one for one in places))
        )
        step = [1.0 / (n * voxel) for n in shape]
        x, y, z = (own[at_line] for own, at_line in zip(waves, places, strict=True))
        del places
        rings, floors = np.rint(np.hypot(x, y) / (SHELL * step[0])), np.rint(np.abs(z) / (SHELL * step[2]))
        shell = (rings * (floors.max() + 1.0) + floors).astype(np.int32)
        del x, y, z, rings, floors
        order = np.argsort(shell, kind="stable").astype(np.int32)
        ends = np.flatnonzero(np.diff(shell[order])) + 1
        voxels = np.ravel_multi_index(at.T, extent)
        return cls(voxels, extent, shape, along, waves, which, mirror, order, ends)

    def strongest(self, sheet: _Sheet) -> Floats:
        """The line that stands out most of its shell, waves per mm (3,)."""
        power = self.power(sheet)[self.order]
        shells = np.split(power, self.ends)
        most = [float(shell.max()) / max(float(np.median(shell)), 1e-300) for shell in shells]
        best = int(np.argmax(most))
        first = self.ends[best - 1] if best else 0
        line = int(self.which[self.order[first + int(np.argmax(shells[best]))]])
        places = np.unravel_index(line, tuple(len(own) for own in self.waves))
        return np.array([own[at] for own, at in zip(self.waves, places, strict=True)])

    def power(self, sheet: _Sheet) -> NDArray[np.float32]:
        """By how much each line lowers the weighted square, (l,): in single precision, for all that is asked is which stands out."""
        carried = (sheet.weight * sheet.left)[:, None] * sheet.points.normal
        sums = [np.bincount(self.voxel, column, math.prod(self.extent)).reshape(self.extent) for column in carried.T]
        plane = _transformed((sums[0] + 1j * sums[1]).astype(np.complex64), self.shape, self.along)
        mirrored, ahead = np.conj(plane.ravel()[self.mirror]), plane.ravel()[self.which]
        del plane
        upwards = _transformed(sums[2].astype(np.float32), self.shape, self.along).ravel()[self.which]
        moment = np.stack([(ahead + mirrored) / 2, (ahead - mirrored) / 2j, upwards])
        inverse = np.linalg.pinv(sheet.squares, rcond=SEEN).astype(np.float32)
        return np.asarray(2 * np.real((np.conj(moment) * (inverse @ moment)).sum(axis=0)), dtype=np.float32)


def _transformed(values: NDArray[np.inexact], shape: list[int], lines: list[Ints]) -> NDArray[np.complexfloating]:
    """Some lines of the spectrum of values, which are 0 from them up to `shape`, along each axis; the last axis first: what is 0, and lines that nobody
    asks for, need no transform along the others."""
    lines_of: NDArray[np.complexfloating] = values + 0j
    for axis in (2, 1, 0):
        lines_of = fft.fft(lines_of, shape[axis], axis=axis).take(lines[axis], axis=axis)
    return lines_of
