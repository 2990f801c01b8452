"""What moves flanks along their normals: how they were made, and what running took. Inside mm; + is more metal.

A field is called with tooth, side, roll length and height of many points of flanks (equal shapes) and gives their
deviations. `Frame` says where the flank begins and ends.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from benchmarks.families.gear import Array, GearNumbers

Rows = tuple[tuple[float, ...], ...]


@dataclass(frozen=True)
class Frame:
    """Numbers a field needs: roll lengths of form circle, reference circle and tip, face width, arc to normal."""

    teeth: int
    module: float
    form: float
    reference: float
    tip: float
    width: float
    cos: float

    @property
    def base(self) -> float:
        """Base radius."""
        return 0.5 * self.module * self.teeth * self.cos

    @classmethod
    def of(cls, gear: GearNumbers, form_roll: float) -> Frame:
        return cls(gear.teeth, gear.module, form_roll, gear.reference_roll, gear.tip_roll, gear.face_width, math.cos(gear.alpha))

    def u(self, roll: Array) -> Array:
        """−1 at the form circle, +1 at the tip."""
        return 2.0 * (roll - self.form) / (self.tip - self.form) - 1.0

    def zeta(self, z: Array) -> Array:
        return z / self.width - 0.5


class Field(Protocol):
    """Deviation of flanks."""

    def __call__(self, f: Frame, tooth: Array, side: Array, roll: Array, z: Array) -> Array: ...


def described(field: Any) -> dict[str, Any]:
    """A field as plain data for the truth file."""
    plain = {k: v.tolist() if isinstance(v, np.ndarray) else v for k, v in asdict(field).items()}
    return {"field": type(field).__name__, **plain}


# As made ------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Polynomial:
    """c u^i ζ^j on both sides, on one (`side`), or with the side's sign (`odd`)."""

    amount: float
    i: int = 0
    j: int = 0
    side: int = 0
    odd: bool = False

    def __call__(self, f: Frame, tooth: Array, side: Array, roll: Array, z: Array) -> Array:
        value = self.amount * f.u(roll) ** self.i * f.zeta(z) ** self.j * (side if self.odd else 1.0)
        return value if self.side == 0 else np.where(side == self.side, value, 0.0)


@dataclass(frozen=True)
class Relief:
    """Missing at the tip (or at the form circle, `root`), as a power of the way from `start` (roll length)."""

    amount: float
    start: float
    power: float = 1.0
    root: bool = False

    def __call__(self, f: Frame, tooth: Array, side: Array, roll: Array, z: Array) -> Array:
        end = f.form if self.root else f.tip
        return -self.amount * np.clip((roll - self.start) / (end - self.start), 0.0, None) ** self.power


@dataclass(frozen=True)
class EndRelief:
    """Missing at both ends over `length`, parabolic; the middle is flat."""

    amount: float
    length: float

    def __call__(self, f: Frame, tooth: Array, side: Array, roll: Array, z: Array) -> Array:
        into = np.clip(1.0 - np.minimum(z, f.width - z) / self.length, 0.0, None)
        relieved: Array = -self.amount * into**2
        return relieved


@dataclass(frozen=True)
class RoundWave:
    """A wave round the gear with any number of waves, whole or not; on both sides alike as an index error (`odd`) or as thickness."""

    amplitude: float
    waves: float
    phase: float
    odd: bool = True
    growth: int = 0

    def __call__(self, f: Frame, tooth: Array, side: Array, roll: Array, z: Array) -> Array:
        theta = (
            2.0 * math.pi * tooth / f.teeth
            + side * 0.5 * math.pi / f.teeth
            - (roll - f.reference) * side * 2.0 / (f.module * f.teeth)
        )
        wave = self.amplitude * np.cos(self.waves * theta + self.phase) * (0.5 * (f.u(roll) + 1.0)) ** self.growth
        return wave * side if self.odd else wave


@dataclass(frozen=True)
class Index:
    """Each tooth off its place: arcs at the reference circle."""

    arcs: tuple[float, ...]

    def __call__(self, f: Frame, tooth: Array, side: Array, roll: Array, z: Array) -> Array:
        arcs: Array = np.asarray(self.arcs)
        moved: Array = f.cos * side * arcs[tooth.astype(int)]
        return moved


@dataclass(frozen=True)
class EachFlank:
    """Every flank cut as itself: off its place along the base tangent, with a slope along the profile and one along the face; left flanks, then right."""

    places: tuple[tuple[float, ...], tuple[float, ...]]
    slopes: tuple[tuple[float, ...], tuple[float, ...]]
    leans: tuple[tuple[float, ...], tuple[float, ...]]

    def __call__(self, f: Frame, tooth: Array, side: Array, roll: Array, z: Array) -> Array:
        which = np.where(side > 0, 0, 1), tooth.astype(int)
        place, slope, lean = (np.asarray(amounts)[which] for amounts in (self.places, self.slopes, self.leans))
        share = (roll - f.form) / (f.tip - f.form) - 0.5
        moved: Array = side * place + slope * share + lean * (z / f.width - 0.5)
        return moved


@dataclass(frozen=True)
class FeedMarks:
    """A wave along z."""

    amplitude: float
    wavelength: float
    phase: float

    def __call__(self, f: Frame, tooth: Array, side: Array, roll: Array, z: Array) -> Array:
        return self.amplitude * np.cos(2.0 * math.pi * z / self.wavelength + self.phase)


@dataclass(frozen=True)
class Ripple:
    """Two waves along the profile, seldom whole; on both sides, or on one (`side`)."""

    amplitudes: tuple[float, float]
    waves: tuple[float, float]
    phases: tuple[float, float]
    side: int = 0

    def __call__(self, f: Frame, tooth: Array, side: Array, roll: Array, z: Array) -> Array:
        w = 0.5 * (f.u(roll) + 1.0)
        parts = zip(self.amplitudes, self.waves, self.phases, strict=True)
        value = sum((a * np.cos(2.0 * math.pi * n * w + p) for a, n, p in parts), np.zeros_like(roll))
        return value if self.side == 0 else np.where(side == self.side, value, 0.0)


# Wear and what goes with it -----------------------------------------------------------------------------------------


def _smooth(x: Array) -> Array:
    x = np.clip(x, 0.0, 1.0)
    return x * x * (3.0 - 2.0 * x)


@dataclass(frozen=True)
class Hollow:
    """A smooth patch on one flank: cos² to its edge in roll length and height."""

    tooth: int
    side: int
    depth: float
    roll: float
    z: float
    half_roll: float
    half_z: float

    def __call__(self, f: Frame, tooth: Array, side: Array, roll: Array, z: Array) -> Array:
        here = (tooth == self.tooth) & (side == self.side)
        far = np.hypot((roll - self.roll) / self.half_roll, (z - self.z) / self.half_z)
        return np.where(here & (far < 1.0), -self.depth * np.cos(0.5 * math.pi * np.minimum(far, 1.0)) ** 2, 0.0)


@dataclass(frozen=True)
class Sliding:
    """Loss with the sliding on all flanks of a side, for a mate `ratio` times as large; each tooth has its factor.

    ``depth · factor · |1 − (C − L) / (u L)|`` over its value at the start of contact, C = (1 + u) L at the reference circle;
    from the start of contact it fades to nothing at the form circle, so that no ledge is left.
    """

    side: int
    depth: float
    factors: tuple[float, ...]
    ratio: float = 2.0
    even: float = 0.0

    def __call__(self, f: Frame, tooth: Array, side: Array, roll: Array, z: Array) -> Array:
        start = self.start(f)
        safe = np.maximum(roll, start)
        loss = self.depth * (self._slide(f, safe) / self._slide(f, np.array(start)) + self.even)
        loss = loss * _smooth((roll - f.form) / (start - f.form)) * np.asarray(self.factors)[tooth.astype(int)]
        return np.where(side == self.side, -loss, 0.0)

    def start(self, f: Frame) -> float:
        return f.form + max(0.08 * (f.tip - f.form), 0.15 * f.module)

    def _slide(self, f: Frame, roll: Array) -> Array:
        total = (1.0 + self.ratio) * f.reference
        return np.abs(1.0 - (total - roll) / (self.ratio * roll))


@dataclass(frozen=True)
class Even:
    """The same loss all over the flanks of a side, each tooth with its factor; it fades to nothing at the form circle as `Sliding` does."""

    side: int
    depth: float
    factors: tuple[float, ...]

    def __call__(self, f: Frame, tooth: Array, side: Array, roll: Array, z: Array) -> Array:
        start = f.form + max(0.08 * (f.tip - f.form), 0.15 * f.module)
        loss = self.depth * _smooth((roll - f.form) / (start - f.form)) * np.asarray(self.factors)[tooth.astype(int)]
        return np.where(side == self.side, -loss, 0.0)


@dataclass(frozen=True)
class Within:
    """A loss where the mate ran alone, from `low` to `high` along the face; its edges are broken over `edge`, mm, there the loss runs out."""

    loss: Even | Sliding
    low: float
    high: float
    edge: float

    @property
    def side(self) -> int:
        return self.loss.side

    def __call__(self, f: Frame, tooth: Array, side: Array, roll: Array, z: Array) -> Array:
        return self.loss(f, tooth, side, roll, z) * np.clip((np.minimum(z - self.low, self.high - z)) / self.edge, 0.0, 1.0)


@dataclass(frozen=True, eq=False)
class Pits:
    """Small round pits on some flanks: rows (tooth, side, roll, z, radius, depth), each a bowl with a flat rim."""

    rows: Rows

    def __call__(self, f: Frame, tooth: Array, side: Array, roll: Array, z: Array) -> Array:
        result = np.zeros(roll.shape)
        for (r0, z0, radius, depth), near in _near(self.rows, tooth, side, z, 4):
            scale = r0 / f.base  # the arc of an involute: dl = L / rb dL
            far2 = (((roll[near] - r0) * scale) ** 2 + (z[near] - z0) ** 2) / radius**2
            bowl = np.where(far2 < 1.0, -depth * (1.0 - np.minimum(far2, 1.0)) ** 0.75, 0.0)
            result[near] = np.minimum(result[near], bowl)
        return result


def _near(rows: Rows, tooth: Array, side: Array, z: Array, reach: int) -> Iterator[tuple[tuple[float, ...], NDArray[np.intp]]]:
    """Each row without its tooth and side, and the indices of the points on its flank within its reach along z.

    `reach` is the place in the row of the half width along z; z itself is at place 3 of pits, 2 of grooves.
    """
    for flank in sorted({row[:2] for row in rows}):
        on = np.nonzero((tooth == flank[0]) & (side == flank[1]))[0]
        if not len(on):
            continue
        on = on[np.argsort(z[on], kind="stable")]
        heights = z[on]
        for row in rows:
            if row[:2] == flank:
                middle = row[reach - 1]
                low, high = np.searchsorted(heights, [middle - row[reach], middle + row[reach]])
                yield row[2:], on[low:high]


@dataclass(frozen=True, eq=False)
class Scores:
    """Grooves in the direction of sliding: rows (tooth, side, z, width, depth), from the tip down to `to` and up from `fro`."""

    rows: Rows

    def __call__(self, f: Frame, tooth: Array, side: Array, roll: Array, z: Array) -> Array:
        result = np.zeros(roll.shape)
        away = np.clip(np.abs(roll - f.reference) / (0.5 * (f.tip - f.form)), 0.0, 1.0)  # none on the pitch line
        away = away * _smooth((roll - f.form) / (0.1 * (f.tip - f.form)))
        for (z0, width, depth), near in _near(self.rows, tooth, side, z, 3):
            groove = -depth * np.cos(math.pi * np.clip((z[near] - z0) / width, -0.5, 0.5)) ** 2
            result[near] = np.minimum(result[near], groove * away[near])
        return result


@dataclass(frozen=True)
class Burr:
    """Metal thrown up at the tip of a worn side: a narrow ridge, uneven along z."""

    side: int
    height: float
    width: float
    phase: float

    def __call__(self, f: Frame, tooth: Array, side: Array, roll: Array, z: Array) -> Array:
        ridge = self.height * np.exp(-(((roll - f.tip) / self.width) ** 2))
        ridge = ridge * (0.6 + 0.4 * np.cos(5.0 * z / f.module + self.phase + 2.0 * tooth))
        return np.where(side == self.side, ridge, 0.0)
