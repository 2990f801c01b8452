"""A scan on the design with the root that it shows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from gearwear.design.gear import Gear
from gearwear.design.surface import FILLET, ROOT, locate
from gearwear.diagnose.loop import Loop
from gearwear.diagnose.undo import undone
from gearwear.placing.root import Root, fit_root
from gearwear.placing.views import PlacedScan, place
from gearwear.scan.types import Scan
from gearwear.wear.breakage import on_whole_teeth

ROOT_PASSES = 2
"""A root found in a pose that the wrong root has bent is looked for once more in the better one."""


def on_its_root(placed: PlacedScan, scans: Sequence[Scan], gear: Gear, planar: bool) -> tuple[PlacedScan, Root]:
    """The scan on the design with the root that it shows; a root that nothing generates is no datum.

    Parameters
    ----------
    placed : PlacedScan
        On the design's own root.
    scans : sequence of Scan
        Views of one gear.
    gear : Gear
        The design.
    planar : bool
        True for planar sections.
    """
    root = _of_whole_teeth(placed, gear, planar)
    for _ in range(ROOT_PASSES):
        if root.fits_design:
            break
        views, normals = [scan.points for scan in scans], [scan.normals for scan in scans]
        placed = place(views, root.gear, normals, planar, placed, no_datum(root))
        root = _of_whole_teeth(placed, gear, planar)
    return placed, root


def root_without(loop: Loop, placed: PlacedScan, root: Root, drawn: Gear, planar: bool) -> Root | None:
    """The root that the scan shows once what a loop found is taken back in space; None where that is the one it was placed on.

    A scan 0.4 % too large shows another root than it has.

    Parameters
    ----------
    loop : Loop
    placed : PlacedScan
        On the root below.
    root : Root
    drawn : Gear
        The design.
    planar : bool
        True for planar sections.
    """
    gear = Gear.from_spec(replace(drawn.spec, face_width=root.gear.face_width))
    points = undone(placed.measured, loop)
    again = fit_root(locate(points[on_whole_teeth(points, gear, planar)], gear), gear)
    same = (again.fits_design and root.fits_design) or (again.free and root.free) or not again.seen
    return None if same else again


def no_datum(root: Root) -> frozenset[int]:
    """Surfaces that are no datum."""
    return frozenset({FILLET, ROOT}) if root.free else frozenset()


def _of_whole_teeth(placed: PlacedScan, gear: Gear, planar: bool) -> Root:
    """The root that the teeth share; a fracture is none."""
    return fit_root(placed.located.take(on_whole_teeth(placed.measured, gear, planar)), gear)
