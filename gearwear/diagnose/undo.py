"""Strong effects taken back in space: what is first order in the deviation is not enough for a tenth of a millimetre on a fillet."""

from __future__ import annotations

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.surface import SurfacePoints
from gearwear.diagnose.found import Loop
from gearwear.placing.pose import motion_columns, small_motion

STEPS = 4
"""Of the fixed point P = P′ − d(P); each gains a factor of about the displacement's gradient, at most 0.05."""


def undone(points: Floats, loop: Loop) -> Floats:
    """Points without the motion that the loop found and without the effects whose displacement is known in space.

    Parameters
    ----------
    points : (n, 3) float
        As registered, mm.
    loop : Loop

    Returns
    -------
    (n, 3) float
        Where the part's own points were before the scanner carried them off, to the size of what the loop found.
    """
    back = small_motion(-loop.motion).apply(points)
    true = back
    for _ in range(STEPS):
        true = back - _carried(true, loop)
    return true


def undone_deviation(points: SurfacePoints, loop: Loop) -> Floats:
    """What `undone` took off the deviation of points that lie here now, mm, (n,), to first order in what the loop found.

    Added to their deviation it gives the same linear problem as before, but at the right feet.
    """
    total = motion_columns(points.position, points.normal) @ loop.motion
    for effect in loop.effects:
        own = effect.candidate
        if own.effect.displacement(np.zeros((1, 3)), effect.amplitudes, own.shape) is not None:
            total = total + own.effect.basis(points, loop.context, own.shape) @ effect.amplitudes
    return np.asarray(total, dtype=np.float64)


def _carried(position: Floats, loop: Loop) -> Floats:
    total = np.zeros_like(position)
    for effect in loop.effects:
        moved = effect.candidate.effect.displacement(position, effect.amplitudes, effect.candidate.shape)
        if moved is not None:
            total += moved
    return total
