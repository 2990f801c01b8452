"""Whether the teeth of a scan are as many as the design's, by how often their pattern repeats round the gear.

A design of one tooth too few, rolled off the scan's axis, meshes with half of its teeth so well that deviations do not tell.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from gearwear.arrays import Floats, Ints
from gearwear.design.gear import Gear
from gearwear.robust import median_scale

MORE_OFTEN = 1.2
"""How many times as strongly as the design's teeth another number must repeat to be the scan's; of one's own gear it repeats less, whatever part is seen."""
LEAST_TEETH_SEEN = 0.5
"""Share of the teeth from which on one more or less can be told."""
OTHER_TEETH = 0.25
"""By which share the scan's teeth may be more or fewer than the design's."""
OFF_AXIS = 0.25
"""Modules by which the tips' centre lies off the design's axis where teeth that mesh there say nothing: it is known to less, unless most teeth are broken."""
LEAST_POINTS = 200
"""Points on either half of the tooth height from which there is a pattern."""
DIRECTIONS = 8192
"""Round the gear, in which points are counted: twenty to a tooth of the largest number; numerical."""
TIP = 0.97
"""Share of the points of a pitch that lie lower than the one that is taken for its tip: strays apart."""


def other_count(flat: Floats, gear: Gear) -> int | None:
    """Number of teeth of a scan that is laid on a design of another number; None where it may be the design's.

    Parameters
    ----------
    flat : (n, 2) float
        Points in the design frame, turned back along the helix, mm.
    gear : Gear

    Notes
    -----
    Points beyond the middle of the tooth height count +, the others −: they add up in the harmonic z, about the design's axis or, where that is off the
    scan's, about the centre of its tips.
    """
    low, high = sorted((gear.tip_radius, gear.root_radius))
    radius = np.hypot(*flat.T)
    flat = flat[np.abs(radius - 0.5 * (low + high)) < 0.5 * (high - low) + gear.transverse_module]
    drawn = _repeats(flat, gear)
    off = np.zeros(2)
    for _ in range(3):  # a point of another tooth is a tip's only about the centre
        centre = _centre_of_tips(flat, gear)
        if centre is None:
            return None
        flat, off = flat - centre, off + centre
    own, z = _repeats(flat, gear), gear.teeth
    known = own[z] if np.hypot(*off) > OFF_AXIS * gear.transverse_module else max(drawn[z], own[z])
    first, last = math.ceil((1.0 - OTHER_TEETH) * z), int((1.0 + OTHER_TEETH) * z)
    other = first + int(np.argmax(own[first : last + 1]))
    return other if own[other] > MORE_OFTEN * known else None


def _repeats(flat: Floats, gear: Gear) -> Floats:
    """How strongly the pattern repeats so many times round, by that number."""
    radius, angle = np.hypot(*flat.T), np.arctan2(flat[:, 1], flat[:, 0])
    half = (radius > 0.5 * (gear.tip_radius + gear.root_radius)).astype(np.int64)
    if np.bincount(half, minlength=2).min() < LEAST_POINTS:
        return np.zeros(DIRECTIONS // 2 + 1)
    return np.abs(tooth_harmonics(angle, half, 2, LEAST_POINTS))


def tooth_harmonics(angle: Floats, ring: Ints, rings: int, fewest: int) -> NDArray[np.complex128]:
    """Harmonics n = 0 … `DIRECTIONS` / 2 of the pattern of teeth: sums of exp(−i n (θ + π)) over points, + in the outer half of the rings and − in the inner one,
    in which teeth and spaces add up.

    Parameters
    ----------
    angle : (n,) float
        About the axis, rad, −π … π.
    ring : (n,) int
        Which of so many `rings` each point is in, from the root on for teeth that point outwards; −1: in none.
    rings : int
    fewest : int
        Points from which on a ring counts; each counts the same.
    """
    result = np.zeros(DIRECTIONS // 2 + 1, dtype=np.complex128)
    for number in range(rings):
        inside = angle[ring == number]
        if len(inside) >= fewest:
            density = np.histogram(inside, DIRECTIONS, (-math.pi, math.pi))[0] / len(inside)
            result += np.fft.rfft(density) * (1.0 if number >= rings // 2 else -1.0)
    return result


def _centre_of_tips(flat: Floats, gear: Gear) -> Floats | None:
    """(2,) mm, of the highest points in each pitch, without broken teeth; None where too few teeth were seen."""
    radius, angle = np.hypot(*flat.T), np.arctan2(flat[:, 1], flat[:, 0])
    pitch = np.floor(angle / gear.pitch_angle)
    order = np.lexsort((gear.orientation * radius, pitch))
    _, first, count = np.unique(pitch[order], return_index=True, return_counts=True)
    seen = count > 0.2 * np.median(count) if len(count) else np.zeros(0, dtype=np.bool_)
    if seen.sum() < LEAST_TEETH_SEEN * gear.teeth:
        return None
    top = order[(first + (TIP * (count - 1)).astype(np.int64))[seen]]
    columns = np.column_stack([np.cos(angle[top]), np.sin(angle[top]), np.ones(len(top))])
    on = np.ones(len(top), dtype=np.bool_)
    for _ in range(3):
        found = np.linalg.lstsq(columns[on], radius[top][on], rcond=None)[0]
        off = radius[top] - columns @ found
        middle, scale = median_scale(off)
        on = np.abs(off - middle) <= 3.0 * scale + 1e-9
    return np.asarray(found[:2])
