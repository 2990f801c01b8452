"""Tips lower than drawn: points of their land that a flank drawn up to the higher tip would take for its own."""

from __future__ import annotations

import numpy as np

from gearwear.design.gear import Gear
from gearwear.design.surface import FLANK, TIP, SurfacePoints

OFF = 3.0
"""Standard deviations of a point: tips lower than drawn by more let points of the land pass for the flank's."""


def tip_shift(located: SurfacePoints) -> float:
    """How far the tips lie above those drawn, mm."""
    tips = located.deviation[located.surface == TIP]
    return float(np.median(tips)) if len(tips) else 0.0


def below_tips(located: SurfacePoints, gear: Gear, noise: float, shift: float | None = None) -> SurfacePoints:
    """The points without those on flanks that lie as high as the tips do, where these are lower than drawn.

    A point of the land next to the corner is then nearer to the flank, as that is drawn up to the higher tip, than to the tip. `shift` (mm)
    is how far the tips lie above those drawn; None: as these points say.
    """
    highest = highest_flank(gear, noise, tip_shift(located) if shift is None else shift)
    if highest == np.inf:
        return located
    flank = np.flatnonzero(located.surface == FLANK)
    roll = located.own_roll(gear)[flank]
    land = flank[gear.orientation * np.hypot(roll, gear.base_radius) > highest]
    return located.off_surface(land)


def highest_flank(gear: Gear, noise: float, shift: float) -> float:
    """Up to which radius (mm, times ι) a point may be a flank's: all, where the tips are not lower than drawn; parameters as `below_tips`."""
    return gear.orientation * gear.tip_radius + shift - OFF * noise if shift < -OFF * noise else np.inf
