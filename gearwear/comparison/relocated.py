"""Points located again once the loop has told what measurement added, and the strays among them."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import numpy as np

from gearwear.arrays import Floats, Ints
from gearwear.comparison.on_design import OnDesign, Places
from gearwear.design.gear import Gear
from gearwear.design.surface import OTHER, Bands, SurfacePoints, locate
from gearwear.diagnose.effects.base import MADE, MEASURED
from gearwear.diagnose.loop import Loop
from gearwear.diagnose.rules import rules
from gearwear.diagnose.undo import undone, undone_deviation
from gearwear.placing.cells import CellGrid, Cells
from gearwear.placing.in_cells import InCells
from gearwear.placing.low_tips import below_tips, tip_shift
from gearwear.placing.pose import Pose, motion_columns, small_motion
from gearwear.placing.registration import narrowed_bands, stray_limit
from gearwear.placing.strays import StrayLimits
from gearwear.placing.views import PlacedScan

LEAST_NOISE = 1e-4
"""mm; what a scan is taken to scatter at least. An export from CAD has none, and rounding would be explained in its place."""
BAND_OF_SURFACE = ("flank", "flank", "root", "tip", "end_low", "end_high", "bore")
"""Field of `Bands` for each surface code."""


def clip_of(located: SurfacePoints) -> float:
    """How far from its cell's centre a point may lie, mm."""
    return max(stray_limit(located), 60.0 * LEAST_NOISE)


def in_cells(located: SurfacePoints, grid: CellGrid) -> InCells:
    """A scan in cells, its strays told."""
    return InCells.of(located, grid, clip_of(located))


def is_far(loop: Loop, cells: Cells) -> bool:
    """Whether the scan lies so far off the design that first order at the feet first found is not enough."""
    position = cells.points.position[loop.use]
    moved = float(np.sqrt(np.mean(np.sum((undone(position, loop) - position) ** 2, axis=1))))
    return max(loop.rms_before / rules().distorted, moved / rules().carried) > cells.grid.gear.transverse_module


@dataclass(frozen=True, slots=True)
class Relocation:
    """How points of a strongly distorted scan are put on the design: taken from far, and kept where the model explains them.

    Parameters
    ----------
    loop : Loop
        The model.
    grid : CellGrid
    bands : Bands
        How far a point may lie from a surface, the distortion undone.
    limits : StrayLimits
        How far from its cell's centre, of what the model leaves.
    noise : float
        Scatter of points, mm.
    shift : float
        How far the tips lie above those drawn, the distortion undone, mm.
    """

    loop: Loop
    grid: CellGrid
    bands: Bands
    limits: StrayLimits
    noise: float
    shift: float = 0.0

    @classmethod
    def of(cls, placed: PlacedScan, loop: Loop, grid: CellGrid) -> tuple[Relocation, SurfacePoints, SurfacePoints]:
        """By what the points held in memory say; and these as `located` gives them."""
        wide, narrow = Bands.wide(grid.gear), placed.registration.bands
        unseen = {name: (np.inf, np.inf) for name in ("end_low", "end_high") if np.isinf(getattr(narrow, name)[0])}
        far = Bands(**{f.name: tuple(3.0 * limit for limit in getattr(wide, f.name)) for f in fields(wide)} | unseen)
        unlimited = StrayLimits(np.zeros(grid.count), np.full(grid.count, np.inf), np.zeros(grid.count, dtype=bool))
        located = locate(undone(placed.measured, loop), grid.gear, far)
        free = cls(loop, grid, far, unlimited, placed.registration.noise, tip_shift(located))
        located, known, rest = free._left(located)
        again = replace(free, limits=StrayLimits.of(rest.deviation, grid.index(rest), grid, clip_of(rest)))
        return again, *again._judged(located, known, rest)

    def located(self, points: Floats) -> tuple[SurfacePoints, SurfacePoints]:
        """Points (n, 3) of the design frame on the design, and what the model leaves of their deviations."""
        return self._judged(*self._left(locate(undone(points, self.loop), self.grid.gear, self.bands)))

    def _judged(self, located: SurfacePoints, known: Ints, rest: SurfacePoints) -> tuple[SurfacePoints, SurfacePoints]:
        left = rest.deviation
        limits = np.array([getattr(Bands.wide(self.grid.gear), name) for name in BAND_OF_SURFACE])[rest.surface]
        off = (left < limits[:, 0]) | (left > limits[:, 1])
        off |= ~self.limits.hold(left, self.grid.index(rest))
        deviation, remain = located.deviation.copy(), located.deviation.copy()
        deviation[known] += undone_deviation(located.take(known), self.loop)
        remain[known] = left
        back, rest = (located.with_deviation(values).off_surface(known[off]) for values in (deviation, remain))
        return back, rest

    def _left(self, located: SurfacePoints) -> tuple[SurfacePoints, Ints, SurfacePoints]:
        """Points located with the distortion undone, which of them lie on a surface, and these with what the model leaves."""
        loop, located = self.loop, below_tips(located, self.grid.gear, self.noise, self.shift)
        known = np.flatnonzero(located.surface != OTHER)
        part = located.take(known)
        model = loop.deviation(part, MEASURED | MADE) + motion_columns(part.position, part.normal) @ loop.motion
        left = part.deviation - (model - undone_deviation(part, loop))
        return located, known, part.with_deviation(left)


@dataclass(frozen=True, slots=True)
class FinalMotion:
    """The small motion that the loop found together with its effects.

    Parameters
    ----------
    loop : Loop
    pose : Pose
        Of the scan after it: design = rotation · scan + translation.
    gear : Gear
    bands : Bands
        How far a point may lie from a surface then.
    noise : float
        Scatter of points, mm.
    shift : float
        How far the tips lie above those drawn, mm.
    again : Relocation or None
        How the points of a strongly distorted scan are located.
    """

    loop: Loop
    pose: Pose
    gear: Gear
    bands: Bands
    noise: float
    shift: float
    again: Relocation | None

    @classmethod
    def of(cls, placed: PlacedScan, loop: Loop, gear: Gear, again: Relocation | None) -> tuple[FinalMotion, SurfacePoints]:
        """By what the points held in memory say; and these after it."""
        back, noise = small_motion(-loop.motion), placed.registration.noise
        pose = placed.registration.pose.then(back)
        if again is not None:
            motion = cls(loop=loop, pose=pose, gear=gear, bands=again.bands, noise=noise, shift=0.0, again=again)
            return motion, motion._taken_off(placed.located)
        points = back.apply(placed.measured)
        # The bands go with the motion: a coat seen on one end only moves that end's points by its own thickness.
        bands = narrowed_bands(locate(points, gear), gear)
        located = locate(points, gear, bands)
        shift = tip_shift(located)
        motion = cls(loop=loop, pose=pose, gear=gear, bands=bands, noise=noise, shift=shift, again=None)
        return motion, below_tips(located, gear, noise, shift)

    @property
    def put(self) -> Places:
        """What puts points of the design frame, before the motion, on the design after it."""
        if self.again is not None:
            return self
        return OnDesign(self.gear, self.bands, self.noise, self.shift, small_motion(-self.loop.motion))

    def located(self, points: Floats) -> SurfacePoints:
        """Points (n, 3) of the design frame, before the motion, on the design after it."""
        return self.put.located(points) if self.again is None else self._taken_off(self.again.located(points)[0])

    def _taken_off(self, located: SurfacePoints) -> SurfacePoints:
        """So far off the design that the bands would cut it: the small motion is taken off the deviations instead."""
        return located.with_deviation(located.deviation - motion_columns(located.position, located.normal) @ self.loop.motion)
