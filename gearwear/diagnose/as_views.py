"""Whether an effect is what views out of place leave behind: sectors of the teeth moved, each as a rigid body.

Views that were put together in one file, and do not quite lie on each other, are told by the scatter of their overlaps (`placing.layers`), not by where their
borders are. So no sector is looked for: what four quarters of the gear can do, each by a motion of its own, views may have done.
"""

from __future__ import annotations

import numpy as np

from gearwear.arrays import Bools, Floats
from gearwear.design.surface import FILLET, FLANK, ROOT, TIP, SurfacePoints
from gearwear.diagnose.effects.base import polar_angle
from gearwear.diagnose.rules import rules

QUARTERS = 4
"""Views of a gear that turns see a quarter of it and more."""
BORDERS = 2
"""Places of the borders that are tried, evenly over a quarter."""


def share_moved(points: SurfacePoints, field: Floats, used: Bools) -> float:
    """Share of an effect on the teeth that rigid motions of quarters explain, 0 … 1.

    Parameters
    ----------
    points : SurfacePoints
        Of the cells, (m,).
    field : (m,) float
        What the effect does to their deviation, mm.
    used : (m,) bool
        Those that count.
    """
    on = used & np.isin(points.surface, (FLANK, FILLET, TIP, ROOT)) & np.isfinite(field)
    whole = float((field[on] ** 2).sum())
    if whole <= 0.0:
        return 0.0
    teeth, value, angle = points.take(on), field[on], polar_angle(points.take(on))
    motion = np.column_stack([teeth.normal, np.cross(teeth.position, teeth.normal)])
    width = 2.0 * np.pi / QUARTERS
    return max(_explained(motion, value, np.floor((angle + shift * width / BORDERS) / width)) for shift in range(BORDERS)) / whole


def may_be_views(points: SurfacePoints, field: Floats, used: Bools, size: float, apart: float) -> bool:
    """Whether views that lie `apart` from their mean, mm, may have left an effect of root mean square `size`: as they may all that is no larger than
    that, and what is moved quarters; others as `share_moved`."""
    return size < apart or share_moved(points, field, used) >= rules().moved


def _explained(motion: Floats, value: Floats, quarter: Floats) -> float:
    """Sum of squares that a motion (n, 6) of each quarter explains."""
    explained = 0.0
    for which in np.unique(quarter):
        here = quarter == which
        moved = motion[here] @ np.linalg.lstsq(motion[here], value[here])[0]
        explained += float(value[here] @ moved)
    return explained
