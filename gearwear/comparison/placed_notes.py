"""What a reader must know of how a scan lies on its design: doubts, which change what the numbers mean, and remarks, which do not."""

from __future__ import annotations

from gearwear.design.gear import Gear
from gearwear.design.surface import SurfacePoints
from gearwear.placing.cells import shared_errors
from gearwear.placing.refusal import doubtful_distance, flanks_off
from gearwear.placing.views import PlacedScan

SHARED = 0.5
"""Variance of neighbours' differences, in that inside cells, below which points share their errors."""
SMOOTHED = "neighbouring points share their errors: the scan was smoothed or averaged, so edges are rounded and narrow pits shallower than they are"


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
        said.append(f"the flanks of both sides lie {far:.2f} mm off the design: check that the scan is of this gear")
    if gear.face_width != drawn.face_width:
        said.append(
            f"the teeth of the scan are {gear.face_width:.4g} mm wide, and the design's face_width is {drawn.face_width:g} mm: taken as seen"
        )
    views = (view.accord.doubt(i, noise) for i, view in enumerate(placed.views, 1))
    return (*said, *filter(None, views))


def smoothing_of(located: SurfacePoints, noise: float, views: int) -> tuple[str, ...]:
    """That neighbouring points share their errors, where they do; views that are stitched differ inside a cell by more than their noise."""
    return (SMOOTHED,) if views == 1 and shared_errors(located, noise) < SHARED else ()


def sample_note(points: int, sample: int) -> str:
    """That a scan was streamed, and what rests on its sample alone."""
    return (
        f"streamed: effects, wear, thickness and meshing are of all {points:,} points; the inspection, the terms of the wear law and what is"
        f" broken off rest on a sample of {sample:,}"
    )
