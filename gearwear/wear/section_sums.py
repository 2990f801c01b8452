"""What the thickness of sections needs of the points of a scan: sums that any number of chunks add to."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from gearwear.arrays import Bools, Floats
from gearwear.design.gear import Gear
from gearwear.design.quantity import at_least, at_most
from gearwear.design.surface import FLANK, SurfacePoints

STEP = 0.2
"""Default distance of the sections, mm (the paper's)."""
WINDOW = 0.1
"""Half width, in modules, of the band of arc round the radius whose points are averaged."""


def stations(face_width: float, step: float = STEP) -> Floats:
    """Heights 0, step, 2 step … across the face, mm; where it is no whole number of steps wide, as far from one end as from the other."""
    number = math.floor(face_width / step + 1e-9)
    left = face_width - number * step
    return np.asarray(np.arange(number + 1) * step + (0.5 * left if left > 1e-9 * face_width else 0.0), dtype=np.float64)


@dataclass(frozen=True, slots=True)
class SectionBand:
    """Where on the flanks thickness is measured.

    Parameters
    ----------
    gear : Gear
        The nominal gear.
    radius : float
        mm, on the involute.
    heights : (n_z,) float
        mm, evenly spaced. A single height takes all points (a planar section).
    """

    gear: Gear
    radius: float
    heights: Floats

    @classmethod
    def of(cls, gear: Gear, radius: float | None = None, z: Floats | None = None) -> SectionBand:
        """At a radius, None: `Gear.thickness_radius`; and heights, None: those of `stations`. ValueError if the radius is not on the involute."""
        r = gear.thickness_radius if radius is None else radius
        if not 0.0 <= gear.orientation * (r - gear.form_radius) <= abs(gear.flank_end_radius - gear.form_radius):
            raise ValueError(
                f"radius {r} mm is not on the involute: {at_least(min(gear.form_radius, gear.flank_end_radius))} … {at_most(max(gear.form_radius, gear.flank_end_radius))} mm"
            )
        return cls(gear, r, stations(gear.face_width) if z is None else np.asarray(z, dtype=np.float64))

    @property
    def reach(self) -> float:
        """Length of roll at the radius, mm."""
        return float(self.gear.roll_length(self.radius))

    @property
    def half(self) -> float:
        """Half the width of the band, in length of roll, mm."""
        gear = self.gear
        return WINDOW * gear.transverse_module * gear.base_radius / max(self.reach, 0.05 * gear.base_radius)

    def holds(self, points: SurfacePoints) -> Bools:
        """(n,) points of flanks in the band."""
        return np.asarray((points.surface == FLANK) & (np.abs(points.own_roll(self.gear) - self.reach) <= self.half))


@dataclass(frozen=True, slots=True)
class SectionSums:
    """Sums over the points of each section of each tooth side.

    Parameters
    ----------
    band : SectionBand
    moments : (9, teeth · 2 · n_z) float
        Number of points; of x, length of roll from the band's middle, and y, deviation, both mm: Σx, Σy, Σx², Σxy, Σy², Σ|x|, Σx|x|, Σ|x|y.
    """

    band: SectionBand
    moments: Floats

    @classmethod
    def of(cls, points: SurfacePoints, band: SectionBand) -> SectionSums:
        """Of located points."""
        gear, heights = band.gear, band.heights
        part = points.take(band.holds(points))
        if len(heights) > 1:
            row = np.rint((part.own_height - heights[0]) / (heights[1] - heights[0])).astype(np.int64)
        else:
            row = np.zeros(len(part), dtype=np.int64)
        inside = (row >= 0) & (row < len(heights))
        part, row = part.take(inside), row[inside]
        cell = (part.tooth.astype(np.int64) * 2 + (part.side < 0)) * len(heights) + row
        x, y = part.own_roll(gear) - band.reach, part.deviation
        size = gear.teeth * 2 * len(heights)
        away = np.abs(x)
        each = (np.ones_like(x), x, y, x * x, x * y, y * y, away, x * away, away * y)
        moments = [np.bincount(cell, values, minlength=size) for values in each]
        return cls(band, np.asarray(moments, dtype=np.float64))

    def plus(self, other: SectionSums) -> SectionSums:
        """Of the points of both."""
        return replace(self, moments=self.moments + other.moments)
