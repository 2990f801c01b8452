"""What no effect of the catalogue explains: found, described, and taken out without a name.

The teeth of a gear are repetitions. A structure they share (order 0), or that turns round the gear with some order n, is not noise:
texture differs from tooth to tooth, so its power is alike in all orders. Each order's map over a tooth side is tested in the
frequency plane (along z × along the profile) against the power of all orders there.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from scipy import ndimage
from scipy.fft import dct
from scipy.special import fdtrc

from gearwear.arrays import Bools, Floats
from gearwear.design.quantity import counted
from gearwear.design.surface import BORE, FILLET, FLANK, ROOT, TIP
from gearwear.diagnose.rules import rules
from gearwear.diagnose.space_waves import SpaceWave
from gearwear.placing.cells import CellGrid, Cells


@dataclass(frozen=True, slots=True)
class Pattern:
    """One unexplained structure.

    Parameters
    ----------
    order : int or None
        Waves round the gear (0: the same on every tooth); None of a wave that stands in space.
    sides : str
        "alike", "opposite", "left only", "right only" or "mixed": how left and right flanks go together.
    waves_z, waves_profile : float
        Waves across the face and along the tooth side.
    rms : float
        Over the tooth sides, mm.
    peak : float
        Greatest size, mm.
    p_value : float
        Corrected for all orders and frequencies looked at.
    field : (m,) float
        Its deviation in every cell, mm.
    in_space : SpaceWave or None
        The wave that it is, where it stands in space.
    """

    order: int | None
    sides: str
    waves_z: float
    waves_profile: float
    rms: float
    peak: float
    p_value: float
    field: Floats
    in_space: SpaceWave | None = None

    @classmethod
    def of(cls, grid: CellGrid, field: Floats, order: int | None, p_value: float) -> Pattern:
        """A field (m,) mm of some order, described."""
        own = grid.sides(field)
        flanks = own[..., grid.fillet :]  # fillets are alike where one side of flanks was left out
        rms, peak = float(np.sqrt(np.mean(own**2))), float(np.abs(own).max())
        parity = _parity(flanks if flanks.any() else own)
        return cls(order, parity, _waves(own, axis=2), _waves(own, axis=3), rms, peak, p_value, field)

    @classmethod
    def of_wave(cls, cells: Cells, wave: SpaceWave) -> Pattern:
        """A wave that stands in space."""
        field = np.where(cells.seen, wave.deviation(cells.points), 0.0)
        return replace(cls.of(cells.grid, field, None, wave.p_value), in_space=wave)

    @property
    def of_all_teeth(self) -> bool:
        """Whether it is the same on every tooth."""
        return self.order == 0

    @property
    def known_everywhere(self) -> bool:
        """Whether it is known where a flank is worn, from other teeth: not what goes round the gear, drawn on from beside the wear."""
        return self.of_all_teeth or self.in_space is not None

    def is_form(self, noise: float) -> bool:
        """Whether it is a form that all teeth have, larger than the scatter of points."""
        return self.of_all_teeth and self.rms > noise

    def describe(self, face_width: float) -> str:
        """A sentence an engineer can use."""
        if self.in_space is not None:
            return f"{self.in_space.describe()}, {1e3 * self.rms:.1f} µm rms, {1e3 * self.peak:.1f} µm at most"
        round_ = f"{counted(self.order, 'wave')} round the gear" if self.order else "the same on every tooth"
        along = _less_than_a_wave(self.waves_z) or f"wavelength {face_width / self.waves_z:.1f} mm"
        profile = _less_than_a_wave(self.waves_profile) or f"{self.waves_profile:.1f} waves"
        return f"{round_}, flanks {self.sides}, {along} along z, {profile} along the profile, {1e3 * self.rms:.1f} µm rms, {1e3 * self.peak:.1f} µm at most"


def _less_than_a_wave(waves: float) -> str:
    """How a pattern runs over a flank on which it has not one wave: it is none to those who see it; "" else."""
    if waves < 0.5:
        return "even"
    return "sloping or bowed" if waves < 0.8 else ""


def find_patterns(grid: CellGrid, residual: Floats, use: Bools, noise: float) -> tuple[Pattern, ...]:
    """Structures that the teeth share.

    Parameters
    ----------
    grid : CellGrid
        The cells.
    residual : (m,) float
        Deviation minus the named model, mm.
    use : (m,) bool
        Cells outside the wear.
    noise : float
        Scatter of points, mm.

    Returns
    -------
    tuple of Pattern
        Strongest first, at most three orders; a pattern must also lower the error of teeth it was not made from.
    """
    value = np.where(use, residual, np.nan)
    found: list[Pattern] = []
    for _ in range(rules().most_patterns):
        pattern = _strongest(grid, value, noise, {p.order for p in found})
        if pattern is None:
            break
        found.append(pattern)
        value = value - pattern.field
    return tuple(found)


def joined(grid: CellGrid, patterns: tuple[Pattern, ...]) -> tuple[Pattern, ...]:
    """Those of one order as one: what was found in two steps is one structure. Each wave in space by itself, and first."""
    together = [pattern for pattern in patterns if pattern.order is None]
    patterns = tuple(pattern for pattern in patterns if pattern.order is not None)
    for order in dict.fromkeys(pattern.order for pattern in patterns):
        same = [pattern for pattern in patterns if pattern.order == order]
        field = np.sum([pattern.field for pattern in same], axis=0)
        together.append(same[0] if len(same) == 1 else Pattern.of(grid, field, order, min(one.p_value for one in same)))
    return tuple(together)


def order_share(grid: CellGrid, field: Floats, order: int) -> float:
    """Share of a field's mean square on the tooth sides that belongs to one order round the gear, 0 … 1."""
    sides = grid.sides(field)
    whole = float(np.nanmean(sides**2))
    part = _order_map(sides, order, 0.0)
    return float(np.nanmean(np.where(np.isfinite(sides), part, np.nan) ** 2)) / max(whole, 1e-300)


def runs_along_face(grid: CellGrid, field: Floats) -> bool:
    """Whether a field (m,) varies along the face of the flanks, and along nothing else there."""
    flanks = np.nan_to_num(grid.flank_shape(field))
    along, across = (np.mean((flanks - flanks.mean(axis=axis, keepdims=True)) ** 2) for axis in (2, 3))
    few = rules().even_share * np.mean(flanks**2)
    return bool(along > few > across)


def along_face(grid: CellGrid, pattern: Pattern) -> float:
    """Root mean square on the tooth sides, mm, of what of a pattern varies along the face alone."""
    return float(np.sqrt(np.mean(grid.sides(pattern.field).mean(axis=3) ** 2)))


def _strongest(grid: CellGrid, value: Floats, noise: float, done: set[int | None]) -> Pattern | None:
    sides = grid.sides(value)
    if sides.shape[2] < rules().pattern_rows or sides.shape[0] < rules().pattern_teeth:
        return None  # planar sections and gears of few teeth give too few repetitions for this test
    power = _spectra(sides)
    # Texture has more power at low frequencies but the same in every order: the reference is local in the frequency plane.
    typical = np.median(power, axis=0) / math.log(2.0)
    reference = ndimage.median_filter(typical, size=(1, 3, 3), mode="nearest")
    reference = np.maximum(
        reference, max(rules().pattern_floor * float(np.median(reference)), 1e-300)
    )  # of exact data nothing is left elsewhere
    ratio = power / reference
    looks, broad = ratio.size, _broad(sides)
    peak = [looks * math.exp(-min(float(own.max()), 700.0)) for own in ratio]
    p_values = np.minimum(np.minimum(peak, broad), 1.0)
    shown = [order for order in range(len(p_values)) if p_values[order] < rules().significance and order not in done]
    for order in sorted(shown, key=lambda one: p_values[one]):
        # What goes round in other orders would drown this one in teeth left out.
        middle = rules().smoothings[len(rules().smoothings) // 2]
        rest = sides - sum((_order_map(sides, other, middle) for other in shown if other != order), np.zeros(1))
        gains = [(*_gain_on_left_out_teeth(rest, order, width), width) for width in rules().smoothings]
        sure = [(gain, width) for gain, errors, width in gains if errors > rules().errors]
        if not sure:
            continue
        width = max(sure)[1]  # the smoothest is the surest, and may have smoothed a fine wave away
        field = _field(grid, value, order, width)
        if float(np.sqrt(np.mean(grid.sides(field) ** 2))) < rules().least_share * noise:
            continue
        return Pattern.of(grid, field, order, float(p_values[order]))
    return None


def _broad(sides: Floats) -> Floats:
    """(orders,) p-values of what is broad on a tooth side (Legendre, 5 along the profile × 4 along z), corrected for all orders.

    Each coefficient's power in an order over that in the other orders is 1 where the teeth are independent; an order's mean over all
    coefficients is tested by F with half the nominal freedoms, texture ties neighbouring coefficients together.
    """
    teeth, _, rows, columns = sides.shape
    u, v = np.linspace(-1.0, 1.0, columns), np.linspace(-1.0, 1.0, rows)
    basis = np.einsum("ci,rj->rcij", np.polynomial.legendre.legvander(u, 4), np.polynomial.legendre.legvander(v, 3))
    basis = basis.reshape(rows * columns, -1)
    size = basis.shape[1]
    coefficient = np.zeros((teeth, 2, size))
    for tooth in range(teeth):
        for side in range(2):
            own = sides[tooth, side].reshape(-1)
            good = np.isfinite(own)
            if good.sum() > 2 * size:
                coefficient[tooth, side] = np.linalg.lstsq(basis[good], own[good], rcond=1e-6)[0]
    power = np.abs(np.fft.fft(coefficient, axis=0)[: teeth // 2 + 1]) ** 2
    freedoms = np.full(len(power), 2.0)
    freedoms[0] = 1.0
    if teeth % 2 == 0:
        freedoms[-1] = 1.0
    nominal = rules().freedom_share * 2 * size
    p_values = np.ones(len(power))
    for order in range(len(power)):
        others = np.arange(len(power)) != order
        reference = np.maximum((np.median(power[others], axis=0)) / math.log(2.0), 1e-300)
        mean = float((power[order] / reference).mean())
        p_values[order] = len(power) * float(fdtrc(freedoms[order] * nominal / 2.0, nominal * others.sum() / 2.0, mean))
    return p_values


def _waves(own: Floats, axis: int) -> float:
    """Waves of a pattern along z (axis 2) or the profile (axis 3); 0 where it is mostly even that way.

    From the cosine transform of its part that varies: half-waves k of the strongest term, refined by its neighbours.
    """
    varying = own - own.mean(axis=axis, keepdims=True)
    if own.shape[axis] < 3 or np.mean(varying**2) < rules().even_share * np.mean(own**2):
        return 0.0
    power = (dct(varying, axis=axis, norm="ortho") ** 2).mean(axis=tuple(a for a in range(own.ndim) if a != axis))
    k = int(np.argmax(power))
    near = slice(max(k - 1, 0), k + 2)
    return 0.5 * float((np.arange(len(power))[near] * power[near]).sum() / power[near].sum())


def _spectra(sides: Floats) -> Floats:
    """(orders, 2, rows, columns) power of the order maps of even and odd combinations of both sides, scaled to one mean."""
    teeth = sides.shape[0]
    filled = np.nan_to_num(sides)
    pair = np.stack([filled[:, 0] + filled[:, 1], filled[:, 0] - filled[:, 1]], axis=1)
    orders = np.fft.fft(pair, axis=0)[: teeth // 2 + 1]
    plane = np.fft.fft(orders, axis=2)
    # The profile is not periodic: a cosine transform has no seam.
    plane = dct(plane.real, axis=3, norm="ortho") + 1j * dct(plane.imag, axis=3, norm="ortho")
    power = np.abs(plane) ** 2
    return np.asarray(power, dtype=np.float64)


def _order_columns(teeth: int, order: int) -> Floats:
    angle = 2.0 * np.pi * order * np.arange(teeth) / teeth
    if order == 0 or 2 * order == teeth:
        return np.cos(angle)[:, None]
    return np.column_stack([np.cos(angle), np.sin(angle)])


def _order_map(sheet: Floats, order: int, width: float) -> Floats:
    """Smoothed pattern of one order on every tooth, same shape as `sheet` (teeth, …, rows, columns)."""
    basis, value, weight = _order_columns(sheet.shape[0], order), np.nan_to_num(sheet), np.isfinite(sheet).astype(np.float64)
    amplitude = _smoothed(*_order_sums(basis, value, weight), width)
    return np.asarray(np.tensordot(basis, np.moveaxis(amplitude, -1, 0), axes=1), dtype=np.float64)


def _order_sums(basis: Floats, value: Floats, weight: Floats) -> tuple[Floats, Floats]:
    """Moment (…, k) and information (…, k, k) of the waves of an order (teeth, k) in values (teeth, …) that are 0 where they have no weight."""
    moment = np.tensordot(basis.T, value, axes=1)
    return np.moveaxis(moment, 0, -1), np.einsum("ti,tj,t...->...ij", basis, basis, weight)


def _smoothed(moment: Floats, information: Floats, width: float) -> Floats:
    """Amplitudes (…, rows, columns, k) of the waves of an order with these sums, smoothed over so many cells."""
    amplitude = np.linalg.solve(information + 1e-3 * np.eye(moment.shape[-1]), moment[..., None])[..., 0]
    spread = [0.0] * (amplitude.ndim - 3) + [width, width, 0.0]
    return np.asarray(ndimage.gaussian_filter(amplitude, spread, mode="nearest"), dtype=np.float64)


def _gain_on_left_out_teeth(sides: Floats, order: int, width: float) -> tuple[float, float]:
    """Fall of the mean square of teeth the pattern was not made from, mm², and the same in its own standard errors."""
    gains, basis = list[float](), _order_columns(sides.shape[0], order)
    value, weight = np.nan_to_num(sides), np.isfinite(sides).astype(np.float64)
    moment, information = _order_sums(basis, value, weight)
    for wave, own, seen in zip(basis, value, weight, strict=True):
        good = seen > 0.0
        if good.sum() > 10:  # the sums of the others are those of all without its own
            others = moment - own[..., None] * wave, information - seen[..., None, None] * np.outer(wave, wave)
            predicted = _smoothed(*others, width) @ wave
            gains.append(float(np.mean(own[good] ** 2 - (own[good] - predicted[good]) ** 2)))
    if len(gains) < 4:
        return 0.0, 0.0
    mean = float(np.mean(gains))
    return mean, mean / max(float(np.std(gains, ddof=1)) / math.sqrt(len(gains)), 1e-300)


def _field(grid: CellGrid, value: Floats, order: int, width: float) -> Floats:
    """The pattern in every cell; each surface has a map of its own."""
    teeth, rows = grid.gear.teeth, grid.rows
    field = grid.on_cells(_order_map(grid.sides(value), order, width))
    for surface, (start, size) in grid.blocks.items():
        if surface in (FILLET, FLANK) or not np.isfinite(value[start : start + size]).any():
            continue
        shape = (teeth, rows, -1) if surface in (TIP, ROOT, BORE) else (teeth, 2, grid.ring)
        sheet = value[start : start + size].reshape(shape)
        field[start : start + size] = _order_map(sheet[:, None], order, width).reshape(-1)
    return field


def _parity(own: Floats) -> str:
    """How the two sides go together."""
    left, right = own[:, 0], own[:, 1]
    a, b = float(np.sqrt(np.mean(left**2))), float(np.sqrt(np.mean(right**2)))
    if min(a, b) < rules().one_sided * max(a, b):
        return "left only" if a > b else "right only"
    together = float((left * right).mean()) / max(a * b, 1e-300)
    return "alike" if together > rules().alike else "opposite" if together < -rules().alike else "mixed"
