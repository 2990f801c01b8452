"""A scan on the design with the root that it shows."""

from __future__ import annotations

from collections.abc import Sequence

from gearwear.comparison.laying import ROOT_SURFACES, laid_on
from gearwear.design.gear import Gear
from gearwear.design.surface import locate
from gearwear.placing.proportion import common_ratio
from gearwear.placing.root import Root, fit_root
from gearwear.placing.views import PlacedScan
from gearwear.scan.types import Scan
from gearwear.wear.breakage import on_whole_teeth

ROOT_PASSES = 2
"""A root found in a pose that the wrong root has bent is looked for once more in the better one."""


def on_its_root(placed: PlacedScan, scans: Sequence[Scan], gear: Gear) -> tuple[PlacedScan, Root]:
    """The scan on the design with the root that it shows; a root that nothing generates is no datum.

    Parameters
    ----------
    placed : PlacedScan
        On the design's own root.
    scans : sequence of Scan
        Views of one gear.
    gear : Gear
        The design.
    """
    root = _of_whole_teeth(placed, gear, scans[0].planar)
    for _ in range(ROOT_PASSES):
        if root.fits_design:
            break
        placed = laid_on(root.gear, scans, no_datum(root), placed)
        root = _of_whole_teeth(placed, gear, scans[0].planar)
    return placed, root


def no_datum(root: Root) -> frozenset[int]:
    """Surfaces that are no datum."""
    return ROOT_SURFACES if root.free else frozenset()


def _of_whole_teeth(placed: PlacedScan, gear: Gear, planar: bool) -> Root:
    """The root that the teeth share; a fracture is none, and of a scan that is out of scale the gear has another one than it shows."""
    whole = on_whole_teeth(placed.measured, gear, planar)
    root = fit_root(placed.located.take(whole), gear)
    ratio = None if root.fits_design else common_ratio(placed.located, gear)
    return root if ratio is None else fit_root(locate(placed.measured[whole] / (1.0 + ratio), gear), gear)
