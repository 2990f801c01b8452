"""Several views of one gear."""

from __future__ import annotations

from collections.abc import Sequence

from gearwear.errors import InputError
from gearwear.scan.types import Scan


def views_of(scan: Scan | Sequence[Scan]) -> tuple[Scan, ...]:
    """A scan, or the views of one gear, as views.

    Raises
    ------
    InputError
        If there is none, or planar sections stand beside others.
    """
    views = (scan,) if isinstance(scan, Scan) else tuple(scan)
    if not views:
        raise InputError("no scan is given; what gw.read_scan returns would be right")
    if len({view.planar for view in views}) > 1:
        raise InputError("some views are planar sections, others are not; views of one kind would be right")
    return views
