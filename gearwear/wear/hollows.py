"""Hollows that sections hide: how far the bottom of a worn flank lies below the mean over the band and the height that points are taken from.

The surface of a flank (`surface`) rests on all of its points, not on those next to the radius alone. Only how it runs along the face is asked of
it, of a side that is worn throughout beyond what its flanks have in common: its level there, next to the ridge that wear leaves at the pitch point,
is that of the sections.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import ndimage
from scipy.sparse import csr_array

from gearwear.arrays import Bools, Floats, Ints
from gearwear.design.side import Side
from gearwear.placing.cells import Cells
from gearwear.wear.flank_arcs import ACROSS, FlankArcs, WornArcs
from gearwear.wear.section_sums import SectionSums


@dataclass(frozen=True, slots=True)
class Hollows:
    """Of some teeth, about each section.

    Parameters
    ----------
    teeth : (k,) int
        0-based.
    depth : (k, n_z) float
        By how much the least arc there, up to half way to the next place that is looked at, is less than what the points of the section have, mm.
    std : (k, n_z) float
        Its standard deviation, mm.
    spread : (k, 2, n_z) float
        Standard deviation of each flank's arc among these points, about their straight line, mm.
    """

    teeth: Ints
    depth: Floats
    std: Floats
    spread: Floats


def find_hollows(
    arcs: WornArcs, pits: Bools, worn: frozenset[Side], pooled: Ints, sections: SectionSums, made: Floats
) -> Hollows | None:
    """Of the worn teeth.

    Parameters
    ----------
    arcs : WornArcs
        Their flanks, beyond the as-made gear.
    pits : (teeth,) bool
        Teeth with pits, which are left out: a surface that is smooth does not follow them.
    worn : frozenset of Side
        Sides worn throughout.
    pooled : (teeth,) int
        Neighbouring sections whose points are taken together, odd.
    sections : SectionSums
        Their points.
    made : (teeth, n_z) float
        Arcs of the as-made gear, mm: crowned flanks are thinner towards the ends, too.

    Returns
    -------
    Hollows or None
        None where there is no such tooth.
    """
    teeth = sorted({tooth for tooth, _ in arcs.of} - set(np.flatnonzero(pits).tolist()))
    along, number = {one: arcs.of[one] for one in arcs.of if one[0] in teeth}, sections.moments[0].reshape(len(pits), 2, -1)
    # No smooth surface follows the ridge at the pitch point, which is more or less sharp along the face; the flanks of a side have it in common.
    for side in worn:
        own = [tooth for tooth in teeth if (tooth, side) in along]
        shared = np.median(np.stack([along[tooth, side].expected for tooth in own]), axis=0) if own else np.zeros(0)
        for tooth in own:
            along[tooth, side] = along[tooth, side].without(shared)
    known = [tooth for tooth in teeth if all((tooth, side) in along for side in Side)]
    if not known:
        return None
    seen = arcs.measurable()
    found = [
        _within([along[tooth, side] for side in Side], number[tooth], made[tooth], int(pooled[tooth]), seen[tooth])
        for tooth in known
    ]
    return Hollows(np.array(known), *(np.stack(values) for values in zip(*found, strict=True)))


def pitted(cells: Cells) -> Bools:
    """(teeth,) with pits."""
    if cells.far is None:
        return np.zeros(cells.grid.gear.teeth, dtype=np.bool_)
    return np.asarray(cells.grid.sides(cells.far.hung).any(axis=(1, 2, 3)))


def _within(flanks: Sequence[FlankArcs], number: Floats, made: Floats, width: int, seen: Bools) -> tuple[Floats, Floats, Floats]:
    """Depth and its standard deviation, (n_z,), and spread of each flank, (2, n_z), of arcs drawn for the two flanks beyond those they were made with,
    (n_z,): at the radius, and in parts of the band. Sections have `number` (2, n_z) points. A bottom is where a section was `seen` (n_z,): how low
    a surface runs on beyond that is in the standard deviation alone."""
    arcs = [arc.drawn() for arc in flanks]
    (draws, n), half = arcs[0][0].shape, width // 2
    at = np.arange(n)[:, None] + np.arange(-half, half + 1)
    inside, at = (at >= 0) & (at < n), at.clip(0, n - 1)
    over_band, spread = [], []
    for arc, (_, over), points in zip(flanks, arcs, number, strict=True):
        share = inside * (points[at] + 1e-6)  # the mean is that of the points
        windows = csr_array(
            ((share / share.sum(axis=1, keepdims=True)).ravel(), at.ravel(), np.arange(n + 1) * at.shape[1]), (n, n)
        )

        def mean(values: Floats, windows: csr_array = windows) -> Floats:
            """Over each window of values (k, n_z)."""
            return np.asarray((windows @ values.T).T, dtype=np.float64)

        over_band.append(mean(over + 0.5 * made))
        drawn = arc.expected[1:]
        about = drawn - np.outer(ACROSS, ACROSS @ drawn) / (ACROSS @ ACROSS)  # the straight line is taken out
        spread.append(np.sqrt(np.maximum(mean(about**2).mean(axis=0) - mean(about).mean(axis=0) ** 2, 0.0)))
    # Windows side by side may leave a gap of up to half of one.
    reach = 2 * (half + (width - 1) // 4) + 1
    expected = sum(arc.expected[0] for arc in flanks) + made
    # Of the surface that is expected: the least of one that is drawn is lower by its luck.
    over_all = sum(band.mean(axis=0) for band in over_band)
    least = ndimage.minimum_filter1d(np.where(seen, expected, np.inf), reach, mode="nearest")
    depth = np.where(np.isfinite(least), over_all - least, 0.0)
    # Both flanks have the same random numbers: turned, they are independent; either way, as neither flank comes first.
    quarter, variance, by_chance = draws // 4, np.zeros(n), np.zeros(n)
    for turned, still in ((0, 1), (1, 0)):
        at_radius, band = (
            np.roll(values[turned], quarter, axis=0) + values[still]
            for values in ([at_radius for at_radius, _ in arcs], over_band)
        )
        variance += 0.5 * (band - ndimage.minimum_filter1d(at_radius + made, reach, axis=1, mode="nearest")).var(axis=0)
        even = (band - band.mean(axis=0)) - ndimage.minimum_filter1d(
            at_radius - at_radius.mean(axis=0), reach, axis=1, mode="nearest"
        )
        by_chance += 0.5 * (even**2).mean(axis=0)
    # A flank that is even along the face has a lowest place too, by chance: what is hollow beyond that, as squares add. Where points lie lower than all that
    # there is about them, nothing was looked for.
    depth = np.where(depth > 0.0, np.sqrt(np.maximum(depth**2 - by_chance, 0.0)), depth)
    return depth, np.sqrt(variance), np.stack(spread)
