"""Where sections at the ends of the face are none: flanks that end askew, or are rounded off."""

from __future__ import annotations

import numpy as np

from gearwear.arrays import Bools, Floats, Ints
from gearwear.design.twist import Segment
from gearwear.placing.edges import at_either_end, least_drop, typical_fall

LEAST_SHARE_AT_ENDS = 0.5
"""Share of the points usual in a section that one at an end of the face must have on most teeth: flanks that end askew or are rounded off stop
short of it, and what is seen there is the edge."""


def beyond_flanks(count: Ints, heights: Floats, stretch: Segment) -> Bools:
    """Sections at either end of a stretch of the face where most flanks have ended, (n_z,)."""
    if len(heights) < 2:
        return np.zeros(len(heights), dtype=bool)
    step = heights[1] - heights[0]
    inside = np.minimum(heights + 0.5 * step, stretch.high) - np.maximum(heights - 0.5 * step, stretch.low)
    seen = count.sum(axis=2) > 0
    if not seen.any():
        return np.zeros(len(heights), dtype=bool)
    density = np.median(count[seen], axis=0) / np.maximum(inside, 0.1 * step)
    few = density < LEAST_SHARE_AT_ENDS * np.median(density)
    return np.asarray(np.logical_and.accumulate(few) | np.logical_and.accumulate(few[::-1])[::-1])


def rounded_off(flank: Floats, module: float, noise: float) -> Bools:
    """Sections next to the ends of the face where typical flanks of both sides fall off alike, (n_z,): the end is rounded there."""
    if flank.shape[2] < 3:
        return np.zeros(flank.shape[2], dtype=bool)
    from_low, from_high = at_either_end(np.all(typical_fall(flank) < -least_drop(module, noise), axis=0))
    return from_low | from_high
