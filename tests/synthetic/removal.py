"""Wear as metal removed along the inward normal of the as-made flank, and its exact volume.

Depth is given at foot points: roll length L and height z on the as-made flank. What is removed is all
metal outside the base circle whose foot lies in the worn range and whose depth is less than that. Where
the flank ends within the wear, the metal just past it goes too: above, under the tip land (feet on the
involute's continuation); below, on an undercut gear, down to the fillet (feet below the form circle).
The laws keep their value at the flank's ends there.

With own roll length l = L − h of the metal at depth h the area element is ``l / r_b dL dh``, so ::

    V = ∫∫ [h L − h² / 2] from h_0(L) to d(L, z) / r_b  dL dz

h_0 = 0 on the flank, L − L_tip above it, and the depth of the fillet below it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

import numpy as np

from tests.synthetic.outline import Bools, Floats, Ints, Outline

Shift = Callable[[Floats, Floats], Floats]
"""Normal shift of the as-made flank from the design at (L, z), mm."""


@dataclass(frozen=True, slots=True)
class Patch:
    """A worn place on one flank.

    Parameters
    ----------
    tooth, side : int
        0-based tooth; +1 left, −1 right.
    depth_um : float
        Greatest depth.
    r, z : (float, float)
        Where it lies: foot radius and height, mm; may reach past the flank.
    edge_mm : float or None
        None: a raised cosine over the whole range, in r and in z. A number: flat, with cosine edges this
        wide inside the range; 0 is a sharp step.
    """

    tooth: int
    side: int
    depth_um: float
    r: tuple[float, float]
    z: tuple[float, float]
    edge_mm: float | None = None

    def depth(self, outline: Outline, tooth: Ints, side: Ints, roll: Floats, z: Floats) -> Floats:
        here = (tooth == self.tooth) & (side == self.side)
        radius = np.hypot(outline.base_radius, roll)
        return 1e-3 * self.depth_um * here * _bump(radius, *self.r, self.edge_mm) * _bump(z, *self.z, self.edge_mm)

    def breaks(self, outline: Outline) -> tuple[list[float], list[float]]:
        rb, edge = outline.base_radius, self.edge_mm or 0.0
        radii = [self.r[0], self.r[0] + edge, self.r[1] - edge, self.r[1]]
        return [float(np.sqrt(x * x - rb * rb)) for x in radii if x > rb], [
            self.z[0], self.z[0] + edge, self.z[1] - edge, self.z[1],
        ]  # fmt: skip


@dataclass(frozen=True, slots=True)
class SlidingWear:
    """Wear that follows the sliding: none at the pitch point, `depth_um` at the form circle.

    Parameters
    ----------
    depth_um : float
    side : int
        The drive side: +1 left, −1 right.
    factors : tuple of float
        Depth of each tooth in units of `depth_um`; empty: all 1.
    law : str
        "linear": |L − L_p| / (L_p − L_form). "archard": |K_1|, the specific sliding, which is
        ∝ |L − L_p| / L whatever the mate (reference B7, D3).
    off : float
        How far up the line of action the pitch point lies from the reference circle, mm of roll.
    """

    depth_um: float
    side: int = 1
    factors: tuple[float, ...] = ()
    law: Literal["linear", "archard"] = "linear"
    off: float = 0.0

    def depth(self, outline: Outline, tooth: Ints, side: Ints, roll: Floats, z: Floats) -> Floats:
        factor = np.asarray(self.factors or (1.0,) * outline.teeth)[tooth] * (side == self.side)
        pitch, form = outline.reference_roll + self.off, outline.form_roll
        at = np.clip(roll, form, outline.tip_roll)
        slide = np.abs(at - pitch) / (pitch - form)
        if self.law == "archard":
            slide = slide * form / at
        return 1e-3 * self.depth_um * factor * slide

    def breaks(self, outline: Outline) -> tuple[list[float], list[float]]:
        return [outline.reference_roll + self.off], []


@dataclass(frozen=True, slots=True)
class AbrasiveWear:
    """Uniform loss of `depth_um` on the left (+1), right (−1) or both (0) flanks of `teeth` (empty: all)."""

    depth_um: float
    side: int = 0
    teeth: tuple[int, ...] = ()

    def depth(self, outline: Outline, tooth: Ints, side: Ints, roll: Floats, z: Floats) -> Floats:
        here = np.isin(tooth, self.teeth) if self.teeth else np.ones(np.shape(tooth), np.bool_)
        return 1e-3 * self.depth_um * (here & ((side == self.side) | (self.side == 0))) * np.ones(np.shape(roll))

    def breaks(self, outline: Outline) -> tuple[list[float], list[float]]:
        return [], []


Wear = Patch | SlidingWear | AbrasiveWear


def wear_depth(wear: Sequence[Wear], outline: Outline, tooth: Ints, side: Ints, roll: Floats, z: Floats) -> Floats:
    """Depth at foot points, (n,) mm: the wears add up."""
    total = np.zeros(np.broadcast_shapes(np.shape(roll), np.shape(z)))
    for one in wear:
        total = total + one.depth(outline, tooth, side, roll, z)
    return total


def depth_below(wear: Sequence[Wear], outline: Outline, tooth: int, side: int, own_roll: Floats, z: Floats) -> Floats:
    """Depth of the worn surface at its own radius: h = d(l + h, z), by 60 steps of iteration; 1e-9 where d is not steep.

    Parameters
    ----------
    own_roll : (n,) float
        sqrt(r² − r_b²) of the worn surface's own points, mm.
    z : (n,) float
    """
    h = np.zeros(np.broadcast_shapes(np.shape(own_roll), np.shape(z)))
    for _ in range(60):
        h = wear_depth(wear, outline, np.array(tooth), np.array(side), own_roll + h, z)
    return h


def is_removed(wear: Sequence[Wear], outline: Outline, tooth: Ints, side: Ints, own_roll: Floats, h: Floats, z: Floats) -> Bools:
    """Whether metal at own roll length l and normal depth h under the flank is worn away, (n,) bool."""
    foot = own_roll + h
    reached = foot >= (0.0 if outline.undercut else outline.form_roll - 1e-9)
    return reached & (h < wear_depth(wear, outline, tooth, side, foot, z) - 1e-9)


def removed_volume(wear: Sequence[Wear], outline: Outline, tooth: int, side: int, shift: Shift | None = None) -> float:
    """Exact removed volume of one flank in mm³.

    Parameters
    ----------
    wear : sequence of Wear
    outline : Outline
    tooth, side : int
    shift : callable or None
        Normal shift of the as-made flank at (L, z).

    Notes
    -----
    Gauss-Legendre between the shapes' own break lines, so that smooth shapes come out to rounding error;
    on the strips past the flank's ends, where the limit is a curve, to about 1e-4 of the strip.
    """
    rb, tip, form, b = outline.base_radius, outline.tip_roll, outline.form_roll, outline.face_width
    rolls, heights = [form, tip], [0.0, b]
    for one in wear:
        more_rolls, more_heights = one.breaks(outline)
        rolls += [x for x in more_rolls if form < x < tip]
        heights += [x for x in more_heights if 0.0 < x < b]
    z, dz = _gauss(heights, 24)

    def integral(roll: Floats, weight: Floats, least: Floats) -> float:
        d = wear_depth(wear, outline, np.array(tooth), np.array(side), roll[:, None], z[None, :])
        own = roll[:, None] + (0.0 if shift is None else shift(roll[:, None], z[None, :]))
        d, least = np.minimum(d, own), np.minimum(least[:, None], own)
        area = np.maximum((d * own - 0.5 * d * d) - (least * own - 0.5 * least * least), 0.0)
        return float(weight @ area @ dz) / rb

    roll, weight = _gauss(rolls, 24)
    total = integral(roll, weight, np.zeros_like(roll))
    deepest = _deepest(wear, outline, tooth, side)
    if deepest > 0.0:
        roll, weight = _gauss([tip, tip + deepest], 192)
        total += integral(roll, weight, roll - tip)
        if outline.undercut:
            roll, weight = _gauss([0.0, form], 192)
            total += integral(roll, weight, _fillet_crossing(outline, roll))
    return total


def _deepest(wear: Sequence[Wear], outline: Outline, tooth: int, side: int) -> float:
    """A bound for the depth anywhere on the flank."""
    roll = np.linspace(0.0, 1.1 * outline.tip_roll, 400)[:, None]
    z = np.linspace(0.0, outline.face_width, 61)[None, :]
    return 1.02 * float(wear_depth(wear, outline, np.array(tooth), np.array(side), roll, z).max())


def _fillet_crossing(outline: Outline, roll: Floats) -> Floats:
    """Depth h at which the normal from a foot below the form circle enters the metal: h = fillet depth at L − h."""
    low, high = np.zeros_like(roll), roll.copy()
    for _ in range(50):
        middle = 0.5 * (low + high)
        outside = middle < outline.undercut_depth(roll - middle)
        low, high = np.where(outside, middle, low), np.where(outside, high, middle)
    return high


def _bump(x: Floats, low: float, high: float, edge: float | None) -> Floats:
    inside = (x >= low) & (x <= high)
    if edge is None:
        return np.asarray(inside * 0.5 * (1.0 - np.cos(2.0 * np.pi * (x - low) / (high - low))))
    if edge == 0.0:
        return inside.astype(np.float64)
    return np.asarray(0.5 * (1.0 - np.cos(np.pi * np.clip(np.minimum(x - low, high - x) / edge, 0.0, 1.0))))


@lru_cache
def _legendre(order: int) -> tuple[Floats, Floats]:
    return np.polynomial.legendre.leggauss(order)


def _gauss(breaks: Sequence[float], order: int) -> tuple[Floats, Floats]:
    """Nodes and weights of composite Gauss-Legendre between sorted break points."""
    node, weight = _legendre(order)
    ends = np.unique(np.asarray(breaks))
    half, middle = 0.5 * np.diff(ends)[:, None], 0.5 * (ends[1:] + ends[:-1])[:, None]
    return (middle + half * node).ravel(), (half * weight).ravel()
