"""The screw that carries the surface of a gear into itself: axis and twist from normals alone, for spur, helical and double helical gears.

A surface that a screw motion carries into itself has, at every point p with normal n, v · n = 0 with v = c̄ + c × p. That is linear in
(c̄, c), so the motion is the null vector of the rows (n, p × n), whatever the profile (Pottmann & Randrup 1998, "Rotational and helical
surface approximation for reverse engineering"). Scaled so that |c̄| = 1 it holds for a spur gear too: c = 0, and c̄ is the axis.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearwear.arrays import Bools, Floats
from gearwear.design.gear import Gear
from gearwear.placing.coarse import SAMPLE, Sample, among_neighbours

TRIES = 1500
LIMITS = (0.1, 0.06, 0.06, 0.04, 0.04, 0.04)
"""|v · n| of the points that are fitted, pass by pass."""
STEEPEST = 3.0
"""tan of the helix angle at the mean distance of the points, above which nothing is taken for a gear (worms are no gears here)."""
LEAST_ANGLE = math.radians(2.0)
"""Helix angle at the tip circle from which teeth are helical: 35 µm per mm of face width, where the coarsest class of spur gears allows 10."""
SAME_DIRECTION = math.cos(math.radians(2.0))
"""Cosine between two axes from which on they are one."""
SLABS = 12
"""Slices of the face width whose twist is looked at one by one."""
LEAST_IN_SLAB = 25


@dataclass(frozen=True, slots=True)
class Screw:
    """A motion along and about an axis.

    Parameters
    ----------
    axis : (3,) float
        Unit vector, in the scan's own frame.
    twist : float
        Turn per length along the axis, rad/mm: positive for a right hand.
    """

    axis: Floats
    twist: float


def fine_sample(points: Floats) -> Sample:
    """As `take_sample`, with the normals from the nearest neighbours in the scan itself (at most 300,000 points)."""
    rng = np.random.default_rng(0)
    points = points[rng.choice(len(points), min(len(points), 300_000), replace=False)]
    return among_neighbours(points[:SAMPLE], points, 13)


def find_screw(sample: Sample) -> Screw | None:
    """The screw motion that carries most of a scan into itself.

    Parameters
    ----------
    sample : Sample
        Thinned scan with normals of unknown sign.

    Returns
    -------
    Screw or None
        Of a double helical gear that of either half; None where nothing is carried into itself.
    """
    rng = np.random.default_rng(0)
    points = sample.points - np.median(sample.points, axis=0)
    reach = math.sqrt(float((points**2).sum(axis=1).mean()))
    rows = np.hstack([sample.normals, np.cross(points / max(reach, 1e-300), sample.normals)])
    motions = np.linalg.svd(rows[rng.integers(0, len(rows), (TRIES, 5))], full_matrices=True)[2][:, -1]
    along = np.linalg.norm(motions[:, :3], axis=1)
    motions = motions[along > 0.1] / along[along > 0.1, None]
    motions = motions[np.linalg.norm(motions[:, 3:], axis=1) < STEEPEST]
    if not len(motions):
        return None
    tested = rows[rng.choice(len(rows), min(3000, len(rows)), replace=False)]
    motion = motions[int(np.argmax((np.abs(tested @ motions.T) < LIMITS[1]).mean(axis=0)))]
    for limit in LIMITS:
        near = rows[np.abs(rows @ motion) < limit]
        motion = np.linalg.eigh(near.T @ near)[1][:, 0]
        size = float(np.linalg.norm(motion[:3]))
        if size < 0.1:
            return None
        motion = motion / size
    return Screw(np.asarray(motion[:3]), float(motion[3:] @ motion[:3]) / reach)


def helical_axes(sample: Sample, gear: Gear) -> list[Floats]:
    """Directions the axis of a helical gear may have, best first: of the screw, and of the moments of normals and points.

    Each is polished on the normals themselves: their cosines with the axis are 0 on lands, ± sin β_b on flanks and ± 1 on ends.
    """
    lean = abs(gear.base_helix_sine)
    targets = np.array([-1.0, -lean, 0.0, lean, 1.0])
    normals, about = sample.normals, sample.points - sample.points.mean(axis=0)
    screw = find_screw(sample)
    guesses = [] if screw is None else [screw.axis]
    guesses += [*np.linalg.eigh(normals.T @ normals)[1].T, *np.linalg.eigh(about.T @ about)[1].T]
    scored: list[tuple[float, Floats]] = []
    for guess in guesses:
        axis, share = np.asarray(guess), 0.0
        for limit in LIMITS:
            cosine = normals @ axis
            nearest = targets[np.abs(cosine[:, None] - targets).argmin(axis=1)]
            near = np.abs(cosine - nearest) < limit
            if near.sum() < LEAST_IN_SLAB:
                break
            share = float(near.mean())
            axis = np.linalg.lstsq(normals[near], nearest[near], rcond=None)[0]
            axis = axis / max(float(np.linalg.norm(axis)), 1e-12)
        if all(abs(float(axis @ other)) < SAME_DIRECTION for _, other in scored):
            scored.append((share, axis))
    scored.sort(key=lambda item: -item[0])
    return [axis for _, axis in scored[:3]]


def normal_twist(points: Floats, normals: Floats, tip: float, root: float) -> float:
    """Twist of teeth from their normals, rad/mm: the median over the flanks; 0 where there are too few.

    Parameters and method as `hand_changes_at`.
    """
    _, slope = _slopes(points, normals, tip, root)
    return float(np.median(slope)) / tip if len(slope) >= LEAST_IN_SLAB else 0.0


def twist_size(points: Floats, normals: Floats, tip: float, root: float) -> float:
    """Size of the twist of teeth of either hand from their normals, rad/mm; 0 where there are too few.

    Parameters and method as `hand_changes_at`.
    """
    _, slope = _slopes(points, normals, tip, root)
    return float(np.median(np.abs(slope))) / tip if len(slope) >= LEAST_IN_SLAB else 0.0


def hand_changes_at(points: Floats, normals: Floats, tip: float, root: float) -> float | None:
    """Height at which the hand of the teeth changes, mm, of a double helical gear; None for any other.

    Parameters
    ----------
    points, normals : (n, 3) float
        About the axis, mm.
    tip, root : float
        Ends of the teeth, mm.

    Notes
    -----
    At each point of a flank the screw is known from its normal: v · n = 0 gives the twist −n_z / (p × n)_z. Its median is taken slice by
    slice; the height is the one with fewest points of the wrong hand on either side.
    """
    height, slope = _slopes(points, normals, tip, root)
    if len(height) < SLABS * LEAST_IN_SLAB:
        return None
    order = np.argsort(height)
    height, slope = height[order], slope[order]
    twist = np.array([np.median(part) for part in np.array_split(slope, SLABS)])
    sign = np.where(np.abs(twist) > math.tan(LEAST_ANGLE), np.sign(twist), 0.0)
    lower, upper = sign[: SLABS // 4], sign[-(SLABS // 4) :]
    if not abs(lower.sum()) == abs(upper.sum()) == SLABS // 4 or lower[0] == upper[0]:
        return None
    return float(height[np.argmax(np.cumsum(np.sign(slope)) * lower[0])])


def _slopes(points: Floats, normals: Floats, tip: float, root: float) -> tuple[Floats, Floats]:
    """Heights of points on flanks and, times the tip radius, the twist at each."""
    radius = np.hypot(points[:, 0], points[:, 1])
    turning = points[:, 0] * normals[:, 1] - points[:, 1] * normals[:, 0]
    flank: Bools = (radius > root) & (radius < tip) & (np.abs(turning) > 0.5 * radius) & (np.abs(normals[:, 2]) < 0.9)
    return points[flank, 2], -normals[flank, 2] / turning[flank] * tip
