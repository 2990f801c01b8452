"""Several views of one gear."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from gearwear.errors import InputError, check_kind
from gearwear.scan.types import Scan

SCAN = "what gw.read_scan or gw.as_scan returns"


def views_of(scan: Scan | Sequence[Scan]) -> tuple[Scan, ...]:
    """A scan, or the views of one gear, as views.

    Raises
    ------
    InputError
        If there is none, or what is given is no scan, or planar sections stand beside others.
    """
    if not isinstance(scan, Scan | Iterable):
        check_kind(scan, Scan, "scan", SCAN)
    views = (scan,) if isinstance(scan, Scan) else tuple(scan)
    other = next((view for view in views if not isinstance(view, Scan)), None)
    if other is not None:
        check_kind(scan if isinstance(scan, str) else other, Scan, "scan", SCAN)
    if not views:
        raise InputError("no scan is given; what gw.read_scan returns would be right")
    if len({view.planar for view in views}) > 1:
        raise InputError("some views are planar sections, others are not; views of one kind would be right")
    return views
