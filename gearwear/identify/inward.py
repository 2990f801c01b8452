"""Whether teeth point inwards: a ring and an external gear have the same flanks, with the metal on the other side."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gearwear.arrays import Bools, Floats
from gearwear.identify.free_involute import FreeInvolute

LEAST_SEEN = 60
"""Points from which on end faces or corners say something."""
NEAR_LAND = (0.02, 0.10)
"""Part of the tooth height next to a land where a fillet leaves the involute and the corner of a tip does not."""
LEAST_FILLET, SURE = 0.001, 5.0
"""Mean distance there from the involute, in tooth heights and in standard deviations, from which on it is a fillet."""
BESIDE = (0.1, 3.0)
"""Tooth heights from a land between which the faces of a body beside the teeth are looked for."""
RATIO = 3.0
"""How much more must speak for inward teeth than against them."""


@dataclass(frozen=True, slots=True)
class Teeth:
    """A gear, or half of a double helical one.

    Parameters
    ----------
    points, normals : (n, 3) float
        Along the axis, mm; the normals of unknown sign.
    flank : FreeInvolute
        Fitted as if the teeth pointed outwards: the space of a ring has the shape of an external tooth.
    count : int
        z.
    middle : float
        Height where the phase of `flank` holds, mm.
    """

    points: Floats
    normals: Floats
    flank: FreeInvolute
    count: int
    middle: float

    def polar(self) -> tuple[Floats, Floats]:
        """Radius of each point, and how far along the arc it lies outside of its tooth, mm."""
        flank, height = self.flank, self.points[:, 2] - self.middle
        offset = self.points[:, :2] - flank.centre - np.outer(height, flank.lean)
        radius = np.hypot(offset[:, 0], offset[:, 1])
        pitch = 2.0 * math.pi / self.count
        angle = np.arctan2(offset[:, 1], offset[:, 0]) - flank.phase - flank.twist * height
        within = np.abs(np.mod(angle + 0.5 * pitch, pitch) - 0.5 * pitch)
        pressure = np.arccos(np.minimum(flank.base_radius / np.maximum(radius, 1e-300), 1.0))
        return radius, radius * (within - flank.base_half_angle + np.tan(pressure) - pressure)


def points_inward(halves: Sequence[Teeth], inner: float, outer: float) -> bool:
    """Whether what was fitted as teeth are the spaces of a ring.

    Parameters
    ----------
    halves : sequence of Teeth
        One, or those of a double helical gear, the lower first.
    inner, outer : float
        Radii of the lands, mm.

    Notes
    -----
    End faces lie in teeth, not in spaces (but a table does, at one end). The body is beyond the roots: outside of a ring. And fillets are at
    the roots: of a ring at the outer land, of an external gear at the inner one. A ring is named where both end faces of its teeth say so;
    or, where none of those is seen, both ends of its body; or else the fillets.
    """
    tooth, space = _at_end(halves[0], -1.0, inner, outer)
    upper_tooth, upper_space = _at_end(halves[-1], 1.0, inner, outer)
    if min(space, upper_space) >= LEAST_SEEN and space + upper_space > RATIO * (tooth + upper_tooth):
        return True
    if tooth + upper_tooth >= LEAST_SEEN:
        return False
    outside, within = zip(_beside(halves[0], -1.0, inner, outer), _beside(halves[-1], 1.0, inner, outer), strict=True)
    if min(outside) >= LEAST_SEEN and sum(outside) > RATIO * sum(within):
        return True
    return _rounded_outside(halves[0], inner, outer)


def _at_end(teeth: Teeth, end: float, inner: float, outer: float) -> tuple[int, int]:
    """Points of the upper (+1) or lower (−1) end face that lie inside of teeth and of spaces, well off the flanks and lands."""
    radius, beyond = teeth.polar()
    off = 0.1 * (outer - inner)
    face: Bools = (np.abs(teeth.normals[:, 2]) > 0.9) & (end * (teeth.points[:, 2] - teeth.middle) > 0.0)
    face &= (radius > inner + off) & (radius < outer - off)
    return int((face & (beyond < -off)).sum()), int((face & (beyond > off)).sum())


def _beside(teeth: Teeth, end: float, inner: float, outer: float) -> tuple[int, int]:
    """Points of the upper (+1) or lower (−1) end face of a body outside of the outer land, and of one inside of the inner land."""
    radius, _ = teeth.polar()
    near, far = (share * (outer - inner) for share in BESIDE)
    face: Bools = (np.abs(teeth.normals[:, 2]) > 0.9) & (end * (teeth.points[:, 2] - teeth.middle) > 0.0)
    outside = face & (radius > outer + near) & (radius < outer + far)
    within = face & (radius < inner - near) & (radius > inner - far)
    return int(outside.sum()), int(within.sum())


def _rounded_outside(teeth: Teeth, inner: float, outer: float) -> bool:
    """Whether the fillets are at the outer land; without lands on both sides nothing is known of corners."""
    radius, beyond = teeth.polar()
    depth = outer - inner
    share = (radius - inner) / depth
    outward = (teeth.points[:, :2] - teeth.flank.centre) / np.maximum(radius, 1e-300)[:, None]
    radial = np.abs(np.einsum("ij,ij->i", outward, teeth.normals[:, :2])) > 0.9
    if min((radial & (np.abs(share - land) < NEAR_LAND[0])).sum() for land in (0.0, 1.0)) < LEAST_SEEN:
        return False
    side = np.abs(teeth.normals[:, 2]) < 0.9
    low, high = (beyond[side & (part > NEAR_LAND[0]) & (part < NEAR_LAND[1])] for part in (share, 1.0 - share))
    if min(len(low), len(high)) < LEAST_SEEN:
        return False
    at_inner, at_outer = float(np.mean(low)) / depth, -float(np.mean(high)) / depth
    noise = float(np.std(high)) / depth / math.sqrt(len(high))
    return at_outer > max(LEAST_FILLET, SURE * noise) and at_outer > RATIO * abs(at_inner)
