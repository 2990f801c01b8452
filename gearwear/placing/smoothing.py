"""Whether neighbouring points share their errors, as those of a scan that was smoothed or averaged do."""

from __future__ import annotations

import numpy as np

from gearwear.arrays import Floats, Ints
from gearwear.design.surface import FLANK, SurfacePoints

PATCH_POINTS = 16
"""Points of a patch of a flank, and up to as many again, less one: so few that form, wear and texture are its plane."""
FEWEST_PATCHES, SIDES_LOOKED_AT = 20, 40
"""Patches, and tooth sides, from which it is told whether points share their errors."""
MOST_PATCHES = 32
"""Patches of a side that are looked at, from all over it: of a thousand the median is known to 0.01, however many points there are."""


def shared_errors(points: SurfacePoints) -> float:
    """How much less neighbouring points of the flanks differ than points of a patch: 1 where their errors are their own, 0 where they share them.

    Of what the plane of a patch leaves, half the mean square of the differences to the nearest neighbour over the variance: von Neumann's ratio
    (1941), whose mean is 1 for errors of their own whatever their size. The median over patches: an edge of wear goes through few of them.

    Parameters
    ----------
    points : SurfacePoints
        The located scan.
    """
    on = np.flatnonzero(points.surface == FLANK)
    sides = 2 * points.tooth[on].astype(np.int64) + (points.side[on] > 0)
    found = np.unique(sides)
    # Evenly round the gear; an odd step takes both sides.
    step = max(len(found) // SIDES_LOOKED_AT, 1) | 1
    ratios = [ratio for side in found[::step] for ratio in _ratios(points.take(on[sides == side]))]
    return float(np.median(ratios)) if len(ratios) >= FEWEST_PATCHES else 1.0


def _ratios(flank: SurfacePoints) -> list[float]:
    """Of the patches of one flank."""
    from scipy.spatial import cKDTree

    if len(flank) < PATCH_POINTS:
        return []
    at = np.stack([flank.roll, flank.position[:, 2]]).T  # each way by itself in memory: spans along it take a third of the time
    tree = cKDTree(flank.position)
    result, left, own = [], np.full(len(at), np.nan), np.zeros(len(at), np.bool_)
    patches = _patches(at)
    nearest_of = tree.query(flank.position[np.concatenate(patches)], k=2)[1][:, 1]
    for patch, nearest in zip(patches, np.split(nearest_of, np.cumsum([len(patch) for patch in patches])[:-1]), strict=True):
        plane = np.column_stack([np.ones(len(patch)), at[patch] - at[patch].mean(axis=0)])
        fitted, _, rank, _ = np.linalg.lstsq(plane, flank.deviation[patch], rcond=None)
        left[patch] = rest = flank.deviation[patch] - plane @ fitted
        own[patch] = True
        inside = own[nearest]
        own[patch] = False
        square = float(rest @ rest) / (len(patch) - int(rank))
        if inside.any() and square > 0.0:
            apart = rest[inside] - left[nearest[inside]]
            result.append(0.5 * float(np.mean(apart**2)) / square)
    return result


def _patches(at: Floats) -> list[Ints]:
    """Points (n, 2) halved along the longer way until a half would be smaller than a patch; of more than `MOST_PATCHES` every second half goes on."""
    parts, halvings = list[Ints]([np.arange(len(at))]), 0
    while max(map(len, parts)) >= 2 * PATCH_POINTS:
        parts = [half for part in parts for half in _halves(at, part)]
        if len(parts) > MOST_PATCHES:  # now the one, now the other: always the lower would be always the same corner
            parts = parts[halvings % 2 :: 2]
        halvings += 1
    return parts


def _halves(at: Floats, part: Ints) -> list[Ints]:
    """Of a part that is large enough; else the part."""
    if len(part) < 2 * PATCH_POINTS:
        return [part]
    along, half = max((way[part] for way in at.T), key=np.ptp), len(part) // 2
    order = part[np.argpartition(along, half) if half >= 2 * PATCH_POINTS else np.argsort(along, kind="stable")]
    return [order[:half], order[half:]]
