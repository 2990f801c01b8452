"""Wear of a pair that ran: elastic slices share the load, flanks wear by Archard's law, and what has worn carries less.

A route of its own: contact on the line of action alone, at nodes that both gears share, so that no flank is interpolated; a pair as one spring a
slice, softer towards the ends of the path, slices coupled by a chain of springs; loads by non-negative least squares. No tip
corners, no Hertz, no finite elements. Nothing here comes from `gearwear`.

With `bridged`, contact leaves the line of action where wear is uneven: two flanks of relative radius R part as x² / 2R, so at a node they touch
where ``x² / 2R + depth(s + x) + mate depth(s − x)`` is least, and the loss is taken off there. Without it a step in the load, such as at the ends
of single contact, stays a step in the wear for good, which no real flank can follow.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from scipy.optimize import nnls

from tests.synthetic.outline import PINION, WHEEL, Floats, GearNumbers, Ints, Outline

POSITIONS = 20
"""A pitch."""
SLICES = 9
STEP = 0.002
"""Greatest depth from one update to the next, mm."""
REACH, WAYS = 0.8, 161
"""mm of flank to either side of a node that are looked at, and in how many places."""
EXACT = 1e4
"""Weight of the sum of the loads beside the rows of compliance."""


@dataclass(frozen=True)
class RanWear:
    """Wear of the flanks of one side.

    Parameters
    ----------
    single_um : float
        k w N: what the place of sliding 1 loses where one pair carries alone and aligned.
    side : int
        +1 left, −1 right.
    load : float
        N/mm.
    gap_um : float
        Misalignment: gap over the face, + opens towards z = b.
    mate_rate : float
        Wear coefficient of the mate over that of the gear.
    softness : float
        Factor on the compliance of a pair, 1 is 1 / 14 µm mm/N at the pitch point.
    coupling : float
        Length over which slices hold together, in modules.
    factors : tuple of float
        Of each tooth; empty: all 1.
    bridged : bool
        Whether contact leaves the line of action where wear is uneven.
    early_um : float
        By how much the mate's base pitch is the greater: a pair is ahead at the mate's tip of that a pitch later.
    gear, mate : GearNumbers
    """

    single_um: float
    side: int = 1
    load: float = 150.0
    gap_um: float = 0.0
    mate_rate: float = 0.0
    softness: float = 1.0
    coupling: float = 1.2
    factors: tuple[float, ...] = ()
    bridged: bool = False
    early_um: float = 0.0
    gear: GearNumbers = PINION
    mate: GearNumbers = field(default=WHEEL)

    @cached_property
    def table(self) -> tuple[Floats, Floats, Floats]:
        """Lengths of roll (n,), heights (SLICES,), mm, and depth (n, SLICES), mm."""
        one, two = Outline.of(self.gear), Outline.of(self.mate)
        alpha, ratio = math.radians(self.gear.pressure_angle_deg), self.mate.teeth / self.gear.teeth
        line = (one.reference_radius + two.reference_radius) * math.sin(alpha)
        pitch = math.pi * self.gear.module * math.cos(alpha)
        low, high = max(line - two.tip_roll, one.form_roll), min(one.tip_roll, line - two.form_roll)
        roll = np.arange(low, high, pitch / POSITIONS)
        other = line - roll
        slide, slide_mate = np.abs(1.0 - other / (ratio * roll)), np.abs(1.0 - ratio * roll / other)
        width = self.gear.face_width / SLICES
        zeta = (np.arange(SLICES) + 0.5) / SLICES - 0.5
        off = (roll - 0.5 * (low + high)) / (0.5 * (high - low))
        soft = self.softness / 14e3 * (1.0 + 0.5 * off**2)
        coupled = held_together(SLICES, width, self.coupling * self.gear.module)
        arc, arc_mate = roll**2 / (2.0 * one.base_radius), other**2 / (2.0 * two.base_radius)
        radius = roll * other / line
        off_line, off_mate = np.zeros((len(roll), SLICES)), np.zeros((len(roll), SLICES))
        depth, mate = np.zeros((len(roll), SLICES)), np.zeros((len(roll), SLICES))
        amount, wanted = 0.0, 1e-3 * self.single_um / self.load
        force = self.load * self.gear.face_width
        while amount < wanted:
            apart = depth + mate
            if self.bridged:
                for i in range(SLICES):
                    apart[:, i], way = _nearest(arc, arc_mate, radius, depth[:, i], mate[:, i])
                    off_line[:, i], off_mate[:, i] = arc + way, arc_mate - way
            gap = apart + 1e-3 * self.gap_um * zeta - 1e-3 * self.early_um * (other / pitch)[:, None]
            load = np.zeros_like(depth)
            for first in range(POSITIONS):
                nodes = np.arange(first, len(roll), POSITIONS)
                root = np.repeat(np.sqrt(soft[nodes]), SLICES)
                compliance = root[:, None] * np.kron(np.eye(len(nodes)), coupled) * root
                load[nodes] = _shared(compliance, gap[nodes].ravel(), force).reshape(len(nodes), SLICES) / width
            rate, mate_rate = load * slide[:, None], self.mate_rate / ratio * load * slide_mate[:, None]
            if self.bridged:
                rate, mate_rate = _moved(rate, arc, off_line), _moved(mate_rate[::-1], arc_mate[::-1], off_mate[::-1])[::-1]
            grown = min(STEP / max(rate.max(), mate_rate.max()), wanted - amount)
            depth, mate, amount = depth + grown * rate, mate + grown * mate_rate, amount + grown
        return roll, (zeta + 0.5) * self.gear.face_width, depth

    def depth(self, outline: Outline, tooth: Ints, side: Ints, roll: Floats, z: Floats) -> Floats:
        from scipy.interpolate import RegularGridInterpolator

        length, height, depth = self.table
        tooth, side, roll, z = np.broadcast_arrays(tooth, side, roll, z)
        at = np.stack([roll, np.clip(z, height[0], height[-1])], axis=-1)
        table = RegularGridInterpolator((length, height), depth, bounds_error=False, fill_value=0.0)
        factor = np.asarray(self.factors or (1.0,) * outline.teeth)[tooth] * (side == self.side)
        return np.asarray(factor * table(at), dtype=np.float64)

    def breaks(self, outline: Outline) -> tuple[list[float], list[float]]:
        length, height, _ = self.table
        return [float(length[0]), outline.reference_roll, float(length[-1])], height.tolist()


def held_together(slices: int, width: float, length: float) -> Floats:
    """(slices, slices) what a load on each of a chain of springs, `width` mm wide, gives way at each, held together over a length, mm."""
    chain = np.diag(np.full(slices, width))
    for i in range(slices - 1):
        chain[i : i + 2, i : i + 2] += length**2 / width * np.array([[1.0, -1.0], [-1.0, 1.0]])
    return np.linalg.inv(chain)


def _nearest(arc: Floats, arc_mate: Floats, radius: Floats, depth: Floats, mate: Floats) -> tuple[Floats, Floats]:
    """At each node: the least distance of two flanks, mm, and how far along the driver's flank from the node they have it."""
    way = np.linspace(-REACH, REACH, WAYS)
    clear = way**2 / (2.0 * radius[:, None])
    clear = clear + np.interp(arc[:, None] + way, arc, depth) + np.interp(arc_mate[:, None] - way, arc_mate[::-1], mate[::-1])
    least = clear.argmin(axis=1)
    return clear[np.arange(len(arc)), least], way[least]


def _moved(rate: Floats, arc: Floats, place: Floats) -> Floats:
    """Loss of depth (n, SLICES) at nodes of rising arc, taken off at other places instead; what is lost in section stays the same."""
    cell = np.gradient(arc)
    moved = np.zeros_like(rate)
    for i in range(rate.shape[1]):
        at = np.clip(np.interp(place[:, i], arc, np.arange(len(arc))), 0.0, len(arc) - 1.0)
        low = np.minimum(at.astype(int), len(arc) - 2)
        section = rate[:, i] * cell
        np.add.at(moved[:, i], low, section * (1.0 - at + low))
        np.add.at(moved[:, i], low + 1, section * (at - low))
    return np.asarray(moved / cell[:, None], dtype=np.float64)


def _shared(compliance: Floats, gap: Floats, force: float) -> Floats:
    """Loads, N, of springs with gaps, mm, that carry a force together: least ½ FᵀCF + gᵀF with F ≥ 0 and Σ F = force."""
    root = np.linalg.cholesky(compliance).T
    scale = EXACT * np.sqrt(np.trace(compliance) / len(gap))
    matrix = np.vstack([root, scale * np.ones(len(gap))])
    wanted = np.concatenate([np.linalg.solve(root.T, -gap), [scale * force]])
    return np.asarray(nnls(matrix, wanted)[0], dtype=np.float64)
