"""Wear of a helical pair that ran: lines of contact over elastic slices, flanks that wear by Archard's law, and what has worn carries less.

A route of its own, as `ran`: contact on the line of action of each transverse section alone, at nodes that both gears and all slices share, each slice
ahead of the one below by its part of the screw, rounded to whole nodes; one spring a slice and line, softer towards the ends of the path, the
slices of a line coupled by a chain; loads by non-negative least squares. No tip corners, no Hertz, no finite elements. Nothing here
comes from `gearwear`. Lengths in mm.

With `bridged`, contact leaves the line of action where wear is uneven along the profile, section by section, as in `ran`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from tests.synthetic.helical import Helical
from tests.synthetic.ran import _moved, _nearest, _shared, held_together
from tests.synthetic.tooth import Floats

POSITIONS = 24
"""A pitch."""
SLICES = 18
STEP = 0.0015
"""Greatest depth from one update to the next, mm."""


@dataclass(frozen=True)
class HelicalRan:
    """Wear of the flanks of one side of the driver, alike on all teeth.

    Parameters
    ----------
    gear, mate : Helical
        Of opposite hands and one width, mid-faces at one height.
    single_um : float
        k w N: what the place of sliding 1 would lose if one line carried all.
    side : int
        +1 left, −1 right.
    load : float
        Transverse, N per mm of face.
    gap_um : float
        Misalignment: gap over the face along the transverse line of action, + opens towards z = b.
    mate_rate : float
        Wear coefficient of the mate over that of the gear.
    softness, coupling, bridged
        As for `ran.RanWear`; coupling in normal modules.
    """

    gear: Helical
    mate: Helical
    single_um: float
    side: int = 1
    load: float = 150.0
    gap_um: float = 0.0
    mate_rate: float = 0.0
    softness: float = 1.0
    coupling: float = 1.2
    bridged: bool = False

    @cached_property
    def table(self) -> tuple[Floats, Floats, Floats]:
        """Lengths of roll (n,), heights (SLICES,), and depth along the normal in space (n, SLICES)."""
        one, two = self.gear, self.mate
        ratio = two.teeth / one.teeth
        line = (one.reference + two.reference) * math.sin(one.transverse)
        pitch = 2.0 * math.pi * one.base / one.teeth
        tips = [math.sqrt(g.tip**2 - g.base**2) for g in (one, two)]
        form = math.sqrt(max(float(one.fillet()[0][-1]) ** 2 - one.base**2, 0.0))
        low, high = max(line - tips[1], form), min(tips[0], line)
        step = pitch / POSITIONS
        roll = np.arange(low, high, step)
        other = line - roll
        slide, slide_mate = np.abs(1.0 - other / (ratio * roll)), np.abs(1.0 - ratio * roll / other)
        width = one.width / SLICES
        zeta = (np.arange(SLICES) + 0.5) / SLICES - 0.5
        # The upper section of a right-hand gear has turned further, so its left flank is touched further up, its right one further down.
        ahead = np.rint(self.side * one.turn * one.base * zeta * one.width / step).astype(int)
        off = (roll - 0.5 * (low + high)) / (0.5 * (high - low))
        soft = self.softness / 14e3 * (1.0 + 0.5 * off**2)
        coupled = held_together(SLICES, width, self.coupling * one.module * one.cos)
        depth, mate = np.zeros((len(roll), SLICES)), np.zeros((len(roll), SLICES))
        node, slice_ = np.meshgrid(np.arange(len(roll)), np.arange(SLICES), indexing="ij")
        arc, arc_mate, radius = roll**2 / (2.0 * one.base), other**2 / (2.0 * two.base), roll * other / line
        place, mate_place = np.zeros((len(roll), SLICES)), np.zeros((len(roll), SLICES))
        amount, wanted, force = 0.0, 1e-3 * self.single_um / self.load, self.load * one.width
        while amount < wanted:
            lost, lost_mate = depth / one.base_cos, mate / one.base_cos
            apart = lost + lost_mate
            for i in range(SLICES if self.bridged else 0):
                apart[:, i], way = _nearest(arc, arc_mate, radius, lost[:, i], lost_mate[:, i])
                place[:, i], mate_place[:, i] = arc + way, arc_mate - way
            gap = apart + 1e-3 * self.gap_um * zeta
            load = np.zeros_like(depth)
            for time in range(POSITIONS):
                on = (node - ahead[slice_]) % POSITIONS == time
                j, i = node[on], slice_[on]
                same = (j - ahead[i])[:, None] == (j - ahead[i])
                root = np.sqrt(soft[j])
                compliance = np.where(same, root[:, None] * coupled[np.ix_(i, i)] * root, 0.0)
                load[j, i] = _shared(compliance, gap[j, i], force) / width
            rate, mate_rate = load * slide[:, None], self.mate_rate / ratio * load * slide_mate[:, None]
            if self.bridged:
                rate, mate_rate = _moved(rate, arc, place), _moved(mate_rate[::-1], arc_mate[::-1], mate_place[::-1])[::-1]
            grown = min(STEP / max(rate.max(), mate_rate.max()), wanted - amount)
            depth, mate, amount = depth + grown * rate, mate + grown * mate_rate, amount + grown
        return roll, (zeta + 0.5) * one.width, depth

    def depth(self, side: Floats, roll: Floats, z: Floats) -> Floats:
        """Depth at places of the flanks, + is missing."""
        from scipy.interpolate import RegularGridInterpolator

        length, height, depth = self.table
        side, roll, z = np.broadcast_arrays(side, roll, z)
        at = np.stack([roll, np.clip(z, height[0], height[-1])], axis=-1)
        table = RegularGridInterpolator((length, height), depth, bounds_error=False, fill_value=0.0)
        return np.asarray(np.where(side == self.side, table(at), 0.0), dtype=np.float64)
