"""What a reader must know of how a scan lies on its design: doubts, which change what the numbers mean, and remarks, which do not."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.gear import Gear
from gearwear.design.side import Side
from gearwear.design.surface import FLANK, SurfacePoints
from gearwear.diagnose.effects.base import MEASURED, SCALE_LIMIT, Context
from gearwear.diagnose.effects.view_registration import VIEW_REGISTRATION
from gearwear.diagnose.found import FoundEffect, Loop
from gearwear.diagnose.loop import LEVEL_GROUP, or_smoothing
from gearwear.placing.cells import Cells
from gearwear.placing.refusal import doubtful_distance, flanks_off, thicker_by
from gearwear.placing.smoothing import shared_errors
from gearwear.placing.together import doubtful, said_of_views
from gearwear.placing.views import PlacedScan

SHARED = 0.7
"""Variance of neighbours' differences, in that within a patch, below which points share their errors. Of eleven smoothed scans of the families the
greatest is 0.62, and of 20 that were not the least 0.78, of one with a short texture."""
THINNED = (
    "the thinning of the design, {thinning:.3f} mm, was measured on a gear that may be worn: depths, and how thin the teeth have become, are told from"
    " teeth that thin; what an even loss would have taken off them is in the limits of the volume alone"
)
"""An even loss of all flanks looks like teeth that were cut thin."""
SMOOTHED = "neighbouring points share their errors: the scan was smoothed or averaged, so edges are rounded and narrow pits shallower than they are"


FLAT = 0.1
"""Share of a form, RMS, that may be bent in one that is told as a plane."""


def alone(context: Context) -> str:
    """That the design has no mate, and where the pitch point is taken to lie.

    Where the pair's profile shifts do not sum to zero they slide at the reference circle, and wear of a whole side has another shape than about it.
    """
    still = "the reference circle"
    if context.pitch is not None:
        still = f"⌀ {2.0 * math.hypot(context.pitch, context.gear.base_radius):.4g} mm, as the wear shows it"
    return (
        "the design has one gear: what needs a mate (backlash, contact, transmission error) is left out, and the pitch point is taken at "
        + still
    )


def doubts_of(gear: Gear, drawn: Gear, placed: PlacedScan, noise: float) -> tuple[str, ...]:
    """Notes without which numbers would be taken for what they are not: another gear or face width, a view that lies wrong.

    Parameters
    ----------
    gear, drawn : Gear
        As the scan shows its face width, and as the design states it.
    placed : PlacedScan
    noise : float
        mm.
    """
    said = []
    far = flanks_off(placed.located).distance
    if far > doubtful_distance(gear):
        thicker = thicker_by(placed.located, gear)
        teeth = f" (teeth {abs(thicker):.2f} mm {'thicker' if thicker > 0.0 else 'thinner'})" if math.isfinite(thicker) else ""
        said.append(f"the flanks of both sides lie {far:.2f} mm off the design{teeth}: check that the scan is of this gear")
    if gear.face_width != drawn.face_width:
        said.append(
            f"the teeth of the scan are {gear.face_width:.4g} mm wide, and the design's face_width is {drawn.face_width:g} mm: taken as seen"
        )
    taken = [view.taken for view in placed.views]
    return (*said, *said_of_views(placed.accords, taken, placed.told, noise, placed.scatters))


def said_of_scale(ratio: float) -> tuple[str, ...]:
    """That the scale found, `ratio`, is more than a calibrated scanner may be off by."""
    if abs(ratio) <= SCALE_LIMIT:
        return ()
    way = "larger" if ratio > 0.0 else "smaller"
    return (
        f"all surfaces of the scan are {100.0 * abs(ratio):.2f} % {way} than drawn, more than a calibrated scanner may be off by: check its unit and scale. "
        "It is taken out as the scanner's; a gear that shrank or grew as a whole looks the same",
    )


def beside_views(loop: Loop, placed: PlacedScan, cells: Cells, noise: float) -> Loop:
    """A loop that was closed on several views, with what these leave open.

    Where something is wrong with a view that could not be taken out of it, what was named of the whole scan may be that: what scanner and mounting did,
    levels, and what every tooth has of its own. What was taken out of a view is no better known than the overlaps tell: that is among what is hidden.
    """
    if doubtful(placed.accords, placed.told, noise, placed.scatters):
        loop = replace(loop, effects=tuple(_or_a_view(effect) for effect in loop.effects))
    if placed.shares is None:
        return loop
    columns = np.where(cells.seen[:, None], np.nan_to_num(placed.spread(cells.points)), 0.0)
    hidden = columns if loop.hidden is None else np.hstack([loop.hidden, columns])
    flank = cells.seen & (cells.points.surface == FLANK)
    sides = [columns[flank & (cells.points.side == side)] for side in Side]
    more = [float(np.linalg.norm(its.mean(axis=0))) if len(its) else 0.0 for its in sides]
    left, right = (math.hypot(std, level) for std, level in zip(loop.level_std, more, strict=True))
    return replace(loop, hidden=hidden, level_std=(left, right))


def _or_a_view(effect: FoundEffect) -> FoundEffect:
    """The effect with a view among its alternatives, where it may be one's own."""
    known = effect.candidate.effect
    own = known.kind in MEASURED or known.group == LEVEL_GROUP or known.tooth_specific
    if not own or effect.name == VIEW_REGISTRATION:
        return effect
    return effect.or_one_of({VIEW_REGISTRATION})


def beside_smoothing(loops: Sequence[Loop], cells: Cells) -> tuple[Loop, ...]:
    """Loops that were closed on a scan, with what it leaves open if it was smoothed: a form of the flanks may be what rounded its edges.

    A mean over neighbours bends what ends; a plane it leaves as it is, and a slope that all of a flank has is none of it.
    """
    if not any(loop.context.smoothed for loop in loops):
        return tuple(loops)
    flanks = cells.points.take(cells.seen & (cells.points.surface == FLANK))

    def doubted(loop: Loop, effect: FoundEffect) -> FoundEffect:
        return or_smoothing(effect) if _bends(loop.of_effect(effect, flanks), flanks) else effect

    return tuple(replace(loop, effects=tuple(doubted(loop, effect) for effect in loop.effects)) for loop in loops)


def _bends(field: Floats, flanks: SurfacePoints) -> bool:
    """Whether a field (n,) at points of flanks is more than a plane over roll and height on each side, but for `FLAT` of it."""
    left = whole = 0.0
    for side in np.unique(flanks.side):
        own = flanks.side == side
        roll, z = flanks.roll[own], flanks.position[own, 2]
        plane = np.column_stack([np.ones(len(z)), roll, z, roll * z])
        rest = field[own] - plane @ np.linalg.lstsq(plane, field[own], rcond=None)[0]
        left += float(rest @ rest)
        whole += float(np.var(field[own])) * len(z)
    return left > FLAT**2 * whole


VIEWS_MAY_LIE_APART = (
    "points scatter more on some teeth than on others, on flanks and tips alike: views that do not quite lie on each other may have been put together in this "
    "scan; effects that they may have left, and all that are smaller than they lie apart, have a view among their alternatives"
)


def was_smoothed(located: SurfacePoints, views: int) -> bool:
    """Whether neighbouring points share their errors; of views that are stitched, which lie apart by more than their noise, that is not told."""
    return views == 1 and shared_errors(located) < SHARED


def sample_note(points: int, sample: int) -> str:
    """That a scan was streamed, and what rests on its sample alone."""
    return (
        f"streamed: effects, wear, thickness and meshing are of all {points:,} points; the inspection, the terms of the wear law and what is"
        f" broken off rest on a sample of {sample:,}"
    )
