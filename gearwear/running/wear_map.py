"""The wear of one side as a map: depth along the profile and across the face, tooth by tooth and in the mean."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gearwear.arrays import Bools, Floats, Ints
from gearwear.design.gear import Gear
from gearwear.design.side import Side
from gearwear.diagnose.found import Loop
from gearwear.errors import InputError
from gearwear.meshing.path import PathOfContact
from gearwear.placing.cells import Cells
from gearwear.wear.uncertainty import noise_covariance
from gearwear.wear_law.study import FORM_MARGIN_MODULES, TIP_MARGIN_MODULES
from gearwear.wear_law.teeth import in_proportion

SLICES = 6
"""Slices of the face, at most: the run has the same ones."""
STRIPS = 12
"""Strips of the profile, at most."""
FEWEST_SLICES, FEWEST_STRIPS = 3, 5
LEAST_SEEN = 0.5
"""Least share of the flanks on which a place must have been seen."""


@dataclass(frozen=True, slots=True, kw_only=True)
class WearMap:
    """Depth of flanks that are worn alike.

    Parameters
    ----------
    gear : Gear
    side : Side
    teeth : (k,) int
        0-based.
    roll_edges : (n + 1,) float
        Lengths of roll that part the strips of the profile, mm.
    slices : int
        Number of equal slices of the face, from z = 0 up.
    depth : (k, slices, n) float
        mm, + is missing; nan where not seen.
    seen : (slices, n) bool
        Which places were seen on enough flanks.
    errors : (m, m) float
        Covariance of the mean over the teeth at the places seen, in the order of `mean`: noise, texture, pose, effects; mm².
    """

    gear: Gear
    side: Side
    teeth: Ints
    roll_edges: Floats
    slices: int
    depth: Floats
    seen: Bools
    errors: Floats

    @property
    def mean(self) -> Floats:
        """(m,) mean over the teeth at the places seen, mm, slice by slice."""
        return self.mean_of(np.ones(len(self.teeth), dtype=np.bool_))

    def mean_of(self, teeth: Bools) -> Floats:
        """The same over some of the teeth, (k,) bool; where none of them was seen, that of all."""
        values = in_proportion(self.depth)
        with np.errstate(invalid="ignore"):
            return np.asarray(np.nanmean(values[teeth], axis=0)[self.seen], dtype=np.float64)

    @property
    def roll(self) -> Floats:
        """(m,) length of roll at the middle of the places, mm."""
        middle = np.sqrt(0.5 * (self.roll_edges[1:] ** 2 + self.roll_edges[:-1] ** 2))
        return np.broadcast_to(middle, self.seen.shape)[self.seen]

    @property
    def height(self) -> Floats:
        """(m,) ζ = z / b − ½ at the middle of the places."""
        middle = (np.arange(self.slices) + 0.5) / self.slices - 0.5
        return np.broadcast_to(middle[:, None], self.seen.shape)[self.seen]

    def tooth_means(self) -> tuple[Floats, Floats]:
        """(k,) mean depth of each tooth, and how much deeper it is at z = b than at z = 0, mm."""
        values, zeta = in_proportion(self.depth)[:, self.seen], self.height
        basis = np.column_stack([np.ones_like(zeta), zeta])
        sizes = values @ np.linalg.pinv(basis).T
        return sizes[:, 0], sizes[:, 1]


def wear_map(cells: Cells, side: Side, teeth: Ints, path: PathOfContact, loop: Loop | None, noise: float) -> WearMap:
    """The wear of some flanks of one side, on the path of contact.

    Parameters
    ----------
    cells : Cells
        Deviation from the as-made gear.
    side : Side
    teeth : (k,) int
        0-based; worn alike.
    path : PathOfContact
        Of this gear, as the pinion, and its mate.
    loop : Loop or None
        Where the as-made gear comes from.
    noise : float
        Scatter of points, mm.

    Raises
    ------
    InputError
        If too little was seen to tell a pattern.
    """
    grid, gear, half = cells.grid, cells.grid.gear, side.index
    lowest = max(gear.form_roll + FORM_MARGIN_MODULES * gear.transverse_module, path.start_pinion)
    highest = min(gear.tip_roll - TIP_MARGIN_MODULES * gear.transverse_module, path.end_pinion)
    inside = np.flatnonzero((grid.roll_edges[:-1] >= lowest) & (grid.roll_edges[1:] <= highest))
    if len(inside) < FEWEST_STRIPS or grid.rows < FEWEST_SLICES:
        raise InputError(
            f"{len(inside)} columns and {grid.rows} rows of cells on the path of contact: too few for a pattern of wear; more points"
        )
    strips, slices = min(STRIPS, len(inside)), min(SLICES, grid.rows)
    strip = np.full(grid.flank, -1)
    strip[inside] = np.arange(len(inside)) * strips // len(inside)
    row = np.arange(grid.rows) * slices // grid.rows
    firsts = np.array([inside[strip[inside] == i][0] for i in range(strips)] + [inside[-1] + 1])
    values = np.stack([grid.flank_shape(cells.points.deviation)[tooth, half] for tooth in teeth])
    known = np.stack([grid.flank_shape(cells.seen.astype(np.float64))[tooth, half] for tooth in teeth]) > 0.0
    known &= np.isfinite(values)
    depth = np.full((len(teeth), slices, strips), np.nan)
    weights = np.zeros((slices, strips, *grid.side_shape))
    for i in range(slices):
        for j in range(strips):
            block = np.ix_(np.arange(len(teeth)), row == i, strip == j)
            count = known[block].sum(axis=(1, 2))
            lost = -np.where(known[block], values[block], 0.0).sum(axis=(1, 2))
            depth[:, i, j] = np.where(count > 0, lost / np.maximum(count, 1), np.nan)
            share = known[block] / np.maximum(count, 1)[:, None, None] / max(int((count > 0).sum()), 1)
            place = np.ix_(teeth, np.array([half]), np.flatnonzero(row == i), grid.fillet + np.flatnonzero(strip == j))
            weights[i, j][place] = share[:, None]
    seen = np.isfinite(depth).mean(axis=0) >= LEAST_SEEN
    if seen.any(axis=1).sum() < FEWEST_SLICES or seen.any(axis=0).sum() < FEWEST_STRIPS:
        raise InputError("too little of the worn flanks was seen on enough teeth for a pattern of wear")
    errors = noise_covariance(cells, noise, loop, weights[seen])
    return WearMap(
        gear=gear,
        side=side,
        teeth=teeth,
        roll_edges=grid.roll_edges[firsts],
        slices=slices,
        depth=depth,
        seen=seen,
        errors=errors,
    )
