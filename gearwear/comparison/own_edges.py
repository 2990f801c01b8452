"""A scan on the design with its flanks ending where the scan shows it."""

from __future__ import annotations

from collections.abc import Sequence

from gearwear.comparison.laying import laid_on, unstated_root
from gearwear.design.gear import Gear
from gearwear.placing.end_edge import EndEdge, fit_end_edge
from gearwear.placing.tip_edge import TipEdge, fit_tip_edge
from gearwear.placing.views import PlacedScan
from gearwear.scan.types import Scan

EDGE_PASSES = 2
"""An edge found in a pose that its points have bent is looked for once more in the better one."""


def on_its_tips(placed: PlacedScan, scans: Sequence[Scan], gear: Gear, smoothed: bool) -> tuple[PlacedScan, TipEdge]:
    """The scan on the design with the edges between flanks and tips that it shows.

    Parameters
    ----------
    placed : PlacedScan
        On the design's own edges.
    scans : sequence of Scan
        Views of one gear.
    gear : Gear
        The design.
    smoothed : bool
        Whether the scan was smoothed, which rounds every edge.
    """
    edge = fit_tip_edge(placed.located, gear, placed.registration.noise, smoothed)
    for _ in range(EDGE_PASSES):
        if edge.fits_design:
            break
        placed = laid_on(edge.gear, scans, unstated_root(edge.gear), placed)
        again = fit_tip_edge(placed.located, gear, placed.registration.noise, smoothed)
        if again.fits_design or again.height == edge.height:
            break
        edge = again
    return placed, edge


def on_tips_of(other: Gear, placed: PlacedScan, scans: Sequence[Scan], gear: Gear) -> tuple[PlacedScan, TipEdge]:
    """The same with the edges of another gear, as the same one has after wear."""
    edge = {key: getattr(other.spec, key) for key in ("tip_chamfer", "tip_chamfer_land", "tip_rounding")}
    if all(getattr(gear.spec, key) == value for key, value in edge.items()):
        return placed, TipEdge(gear)
    own = gear.recut(**edge)
    return laid_on(own, scans, unstated_root(own), placed), TipEdge(own, other.spec.tip_chamfer)


def on_its_ends(placed: PlacedScan, scans: Sequence[Scan], gear: Gear, smoothed: bool) -> tuple[PlacedScan, EndEdge]:
    """The scan on the design with the edges at the ends of the face that it shows; what they bent of the pose is out of it before they are told.

    Parameters
    ----------
    placed : PlacedScan
        On the gear with the edges of the tips that it shows.
    scans : sequence of Scan
        Views of one gear.
    gear : Gear
        That gear.
    smoothed : bool
        Whether the scan was smoothed.
    """
    edge = fit_end_edge(placed.located, gear, placed.registration.noise, smoothed)
    if edge.fits_design:
        return placed, edge
    placed = laid_on(edge.gear, scans, unstated_root(gear), placed)
    again = fit_end_edge(placed.located, gear, placed.registration.noise, smoothed)
    if again.fits_design:
        return placed, edge
    return laid_on(again.gear, scans, unstated_root(gear), placed), again
