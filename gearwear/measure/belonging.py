"""Whether a scan that lies on the design is of this gear."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.gear import Gear
from gearwear.design.surface import FLANK, ROOT, TIP, SurfacePoints
from gearwear.errors import InputError
from gearwear.measure.robust import median_scale
from gearwear.measure.views import PlacedScan

LEAST_FLANK = 100
"""Points on flanks below which nothing can be said of a gear."""
CERTAIN, HARDLY = 0.8, 0.5
"""Share of points on the design from which on the scan is of it, however distorted or worn; and below which it is not, if the rest is off too."""
FAR, UNEVEN = 0.03, 0.05
"""Of both sides' flanks, in modules: distance from the design above which it may be of another gear; spread of the teeth at which it is."""
LEAST_LANDS = 0.02
"""Share of points on tips and bottom lands below which the scan's rims lie elsewhere than the design's."""
WAVES = 2
"""Waves round the gear that a distorted scan may show: one is an eccentric datum, two a plane scaled along one direction."""
FEWEST_TEETH = 4 * WAVES
"""Teeth below which that many waves would pass through anything."""


@dataclass(frozen=True, slots=True)
class FlanksOff:
    """How far flanks lie off the design on the better side, which wear of the drive side does not reach, slow waves round the gear apart.

    Parameters
    ----------
    distance : float
        Median distance of the points, mm.
    spread : float
        Standard deviation from tooth to tooth, mm, robust: another tooth count drifts through the design's.
    """

    distance: float
    spread: float


def flanks_off(points: SurfacePoints) -> FlanksOff:
    """Distance and spread of the flanks; nothing on a side counts as zero."""
    sides = [points.take((points.surface == FLANK) & (points.side == side)) for side in (1, -1)]
    found = [_one_side(own) for own in sides if len(own)]
    return FlanksOff(min((one.distance for one in found), default=0.0), min((one.spread for one in found), default=0.0))


def _one_side(points: SurfacePoints) -> FlanksOff:
    teeth, index = np.unique(points.tooth, return_inverse=True)
    medians = np.array([np.median(points.deviation[index == one]) for one in range(len(teeth))])
    angles = np.arctan2(points.position[:, 1], points.position[:, 0])
    round_gear = np.array([np.angle(np.exp(1j * angles[index == one]).mean()) for one in range(len(teeth))])
    slow = _slow_waves(round_gear, medians)
    spread = median_scale(medians - slow)[1] if len(teeth) > 2 else 0.0
    return FlanksOff(float(np.median(np.abs(points.deviation - slow[index]))), float(spread))


def _slow_waves(angle: Floats, medians: Floats) -> Floats:
    """The waves of low order in one value a tooth, without their mean."""
    if len(medians) < FEWEST_TEETH:
        return np.zeros(len(medians))
    orders = np.arange(1, WAVES + 1)
    waves = np.column_stack([np.cos(angle[:, None] * orders), np.sin(angle[:, None] * orders)])
    fitted = np.linalg.lstsq(np.column_stack([np.ones(len(angle)), waves]), medians, rcond=None)[0]
    return np.asarray(waves @ fitted[1:])


def check_gear(placed: PlacedScan, gear: Gear) -> None:
    """Refuse what lies on the design without being of this gear.

    Raises
    ------
    InputError
        If next to no points lie on flanks, or if the points, the flanks and the rims do not go together with the design.
    """
    points = placed.located
    flanks = int((points.surface == FLANK).sum())
    if flanks < LEAST_FLANK:
        raise InputError(f"{flanks} of {len(points):,} points lie on flanks of the design: at least {LEAST_FLANK} would be right")
    fitting = placed.registration.fitting
    if fitting >= CERTAIN:
        return
    off, m = flanks_off(points), gear.transverse_module
    lands = float(np.isin(points.surface, (TIP, ROOT)).mean())
    if off.spread > UNEVEN * m or (off.distance > FAR * m and (lands < LEAST_LANDS or fitting < HARDLY)):
        raise InputError(
            f"the scan is not of this gear: {100 * fitting:.0f} % of its points lie on the design of {gear.teeth} teeth and tip diameter "
            f"{2 * gear.tip_radius:.2f} mm, and the flanks on both sides lie up to some {max(off.distance, off.spread):.1f} mm off it; "
            "check the design, --part and --units; gearwear design SCAN proposes a design"
        )
