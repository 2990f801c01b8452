"""The thickness of teeth with worn places by the surfaces of their flanks, which rest on all points of these and not on those next to the radius alone.

A section of a thin scan is pooled with its neighbours, and the mean over it hides how deep a worn place is; a surface follows it. Of a side worn throughout
that is not so: at the pitch point, where nothing slides, its flanks have a ridge that no smooth surface follows, and sections tell more (`hollows`).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from gearwear.arrays import Bools, Floats, Ints
from gearwear.design.side import Side
from gearwear.wear.flank_arcs import WornArcs, drawn

WIDER = 1.7
"""Deviations of its own by which the least of a surface is off (RMS): 1.3 on scans of the families, 2.0 on hollows of 20 µm in noise of 6. The points that a
surface goes through tell how stiff it is as well, and where they are few it is too stiff."""


@dataclass(frozen=True, slots=True)
class SurfaceTeeth:
    """Teeth with worn places along the face, by the surfaces of their flanks.

    Parameters
    ----------
    teeth : (k,) int
        0-based.
    arc : (k, n_z) float
        mm; nan where sections did not measure the tooth, or a worn flank was not seen.
    std : (k, n_z) float
        Standard deviation, mm, without what all teeth share.
    luck : (k,) float
        By how much the least of the surfaces that may be theirs lies below that of the one that is expected, on average, mm: the true one is between them.
    """

    teeth: Ints
    arc: Floats
    std: Floats
    luck: Floats

    def shifted(self, by: Floats) -> SurfaceTeeth:
        """The same where all teeth are as much thicker, (teeth, n_z) mm; as on average where that is not known of a section."""
        own = by[self.teeth]
        known = np.isfinite(own)
        mean = np.where(known, own, 0.0).sum(axis=1, keepdims=True) / np.maximum(known.sum(axis=1, keepdims=True), 1)
        return replace(self, arc=self.arc + np.where(known, own, mean))

    def least(self, common: float) -> tuple[Floats, Floats, Ints]:
        """The least of each, (k,) mm, its standard deviation with what all share, of which it is off by `WIDER` as much, and its section."""
        at = np.nanargmin(self.arc, axis=1)
        rows = np.arange(len(at))
        std = np.sqrt(self.std[rows, at] ** 2 + (0.5 * self.luck) ** 2 + common**2)
        return self.arc[rows, at] - 0.5 * self.luck, std, at


def surface_teeth(arc: Floats, as_made: Floats, arcs: WornArcs, worn: frozenset[Side], pits: Bools) -> SurfaceTeeth | None:
    """Of the teeth with worn places that sections measured; None where there is none.

    Parameters
    ----------
    arc, as_made : (teeth, n_z) float
        As sections measured it, nan where they did not, and as made, mm.
    arcs : WornArcs
        The flanks of worn teeth.
    worn : frozenset of Side
        Sides worn throughout.
    pits : (teeth,) bool
        Teeth with pits, which are left out: a surface that is smooth does not follow them.
    """
    throughout = arcs.worn[:, [side.index for side in worn]].any(axis=1)
    here = arcs.measurable() & np.isfinite(arc)
    rows = list[tuple[int, Floats, Floats, float]]()
    for tooth in np.flatnonzero(arcs.worn.any(axis=1) & ~throughout & ~pits & here.any(axis=1)).tolist():
        flanks = arcs.flanks(tooth)
        if len(flanks) < len(Side):
            continue
        curve, off = as_made[tooth] + sum(flank.expected[0] for flank in flanks), drawn(flanks)
        luck = float(curve[here[tooth]].min() - (curve + off)[:, here[tooth]].min(axis=1).mean())
        rows.append((tooth, np.where(here[tooth], curve, np.nan), off.std(axis=0), luck))
    if not rows:
        return None
    teeth, curves, stds, lucks = zip(*rows, strict=True)
    return SurfaceTeeth(np.array(teeth), np.stack(curves), np.stack(stds), np.array(lucks))
