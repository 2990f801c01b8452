"""Cells of many points, kept while the points are: pits, sections, thickness and the wear law ask for them again and again."""

from __future__ import annotations

from collections.abc import Callable
from weakref import finalize

from gearwear.arrays import Ints
from gearwear.design.surface import SurfacePoints

REMEMBERED = 20_000
"""Points from which on the cells that they lie in are kept; numerical."""

Division = tuple[int | bytes, ...]
"""What a grid divides its gear into."""

_known: dict[int, dict[Division, tuple[object, Ints]]] = {}
"""By the identity of the points, and by the division; beside the cells what holds the gear of the division."""


def cells_kept(points: SurfacePoints, division: Division, holder: object, find: Callable[[SurfacePoints], Ints]) -> Ints:
    """Cells of points (n,) in a division, found once; nobody may change them. `holder` is kept, so that no other gear has the identity of its gear."""
    if len(points) < REMEMBERED:
        return find(points)
    known = _known.setdefault(id(points), {})
    if division not in known:
        if not known:
            finalize(points, _known.pop, id(points)).atexit = False
        known[division] = holder, find(points)
    return known[division][1]
