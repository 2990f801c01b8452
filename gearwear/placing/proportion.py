"""Whether a scan is out of scale as a whole: larger or smaller than the design by one ratio, on each of the gear's surfaces.

Flanks alone cannot tell a scale from another base circle, nor tips from another tip diameter. Where flanks, tips and the face width or the bore, which no
one tool cuts, are all off by the same ratio, it is the scan, or the gear grew or shrank as a whole.
"""

from __future__ import annotations

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.gear import Gear
from gearwear.design.surface import BORE, END_HIGH, END_LOW, FLANK, TIP, SurfacePoints

ALIKE = 0.2
"""Share of the ratio by which surfaces may differ in it: a coat of 20 µm is that of 0.5 % at a radius of 20 mm."""
LEAST_POINTS = 100
"""Of a surface, that it tells anything."""


def common_ratio(located: SurfacePoints, gear: Gear) -> float | None:
    """The ratio by which all surfaces of a scan are larger than the design's, less 1; None where they differ in it, or too few were seen.

    Parameters
    ----------
    located : SurfacePoints
        As registered.
    gear : Gear
        The design.

    Notes
    -----
    A scale e moves every point by e P: its deviation is e (P · n). On flanks P · n is the length of roll: e is the slope of the deviation
    over it, and how thick the teeth are does not count. On other surfaces it is the median of the ratio of both; on the ends that of both together, from the
    middle of the face.
    """
    along = ((located.position - [0.0, 0.0, 0.5 * gear.face_width]) * located.normal).sum(axis=1)

    def seen(surface: int) -> tuple[Floats, Floats]:
        on = located.surface == surface
        return along[on], located.deviation[on]

    def ratio(surface: int) -> float:
        way, deviation = seen(surface)
        told = len(way) >= LEAST_POINTS and np.all(way != 0.0)  # a gear without a bore has one of no radius
        return float(np.median(deviation / way)) if told else float("nan")

    way, deviation = seen(FLANK)
    if len(way) < LEAST_POINTS:
        return None
    flanks = float(np.polyfit(way, deviation, 1)[0])
    # Of both ends: where one stands alone is the pose's.
    others = [told for told in (0.5 * (ratio(END_LOW) + ratio(END_HIGH)), ratio(BORE)) if np.isfinite(told)]
    told = np.array([flanks, ratio(TIP), *others])
    if not others or not np.isfinite(told).all():
        return None
    middle = float(np.median(told))
    return middle if np.ptp(told) <= ALIKE * abs(middle) else None
