"""How scans are laid on a gear, from nothing or from where they are."""

from __future__ import annotations

from collections.abc import Sequence

from gearwear.design.gear import Gear
from gearwear.design.surface import FILLET, ROOT
from gearwear.placing.views import PlacedScan, place
from gearwear.scan.types import Scan

ROOT_SURFACES = frozenset({FILLET, ROOT})
"""Fillets and the lands between them."""


def laid_on(gear: Gear, scans: Sequence[Scan], ignore: frozenset[int], start: PlacedScan | None = None) -> PlacedScan:
    """Scans on a gear.

    Parameters
    ----------
    gear : Gear
    scans : sequence of Scan
        Views of one gear.
    ignore : frozenset of int
        Surfaces that are no datum.
    start : PlacedScan or None
        Where they are; None: anywhere.
    """
    return place([scan.points for scan in scans], gear, [scan.normals for scan in scans], scans[0].planar, start, ignore)


def unstated_root(gear: Gear) -> frozenset[int]:
    """The surfaces of a root that nobody stated: as drawn they are no datum."""
    return frozenset() if gear.root_stated else ROOT_SURFACES
