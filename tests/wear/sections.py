"""Tooth thickness of points in one chunk."""

from __future__ import annotations

from gearwear.arrays import Floats
from gearwear.design.gear import Gear
from gearwear.design.surface import SurfacePoints
from gearwear.wear.section_sums import SectionBand, SectionSums
from gearwear.wear.thickness import SectionThickness, thickness_of


def section_thickness(
    points: SurfacePoints, gear: Gear, noise: float, radius: float | None = None, z: Floats | None = None
) -> SectionThickness:
    """`thickness_of` located points at a radius (mm; None: the reference circle) and heights (mm; None: 0.2 mm apart)."""
    return thickness_of(SectionSums.of(points, SectionBand.of(gear, radius, z)), noise)
