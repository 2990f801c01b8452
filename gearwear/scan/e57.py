"""Points from E57: read by pye57, imported only when such a file comes."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from gearwear.arrays import Floats
from gearwear.errors import InputError
from gearwear.memory import check_memory
from gearwear.scan.contents import Contents
from gearwear.scan.parsing import MOST_UNPACKED, check_count, not_installed, short_by
from gearwear.scan.pieces import PIECE, Pieces, join

FIELDS = {
    "cartesianInvalidState": ("cartesianX", "cartesianY", "cartesianZ"),
    "sphericalInvalidState": ("sphericalRange", "sphericalAzimuth", "sphericalElevation"),
}
"""Coordinates, the better ones first, by the field that marks which of them are no good."""


def read_e57(data: bytes) -> Contents:
    """Read all scans of an E57, each at its stated pose; points marked invalid are left out and counted.

    Parameters
    ----------
    data : bytes
        The file.

    Returns
    -------
    Contents

    Raises
    ------
    InputError
        If pye57 is missing, the file is damaged, or it holds fewer points than it says.
    """
    with tempfile.TemporaryDirectory() as folder:  # pye57 opens files by name only, and only unpacked ones
        path = Path(folder) / "scan.e57"
        path.write_bytes(data)
        pieces = e57_pieces(path)
        check_memory(points=pieces.count)
        return join(pieces)


def e57_pieces(path: Path) -> Pieces:
    """The points of all scans of an E57, piece by piece; parameters and errors as `read_e57`."""
    try:
        import pye57
    except ImportError:
        raise not_installed("E57", "pye57") from None
    file = pye57.E57(str(path))
    try:
        heads = [file.get_header(i) for i in range(file.scan_count)]
        promised = sum(head.point_count for head in heads)
        for head in heads:
            _marked_by(head.point_fields)
    finally:
        file.close()
    check_count("points", promised, 1, MOST_UNPACKED * path.stat().st_size)
    return Pieces(promised, lambda: _pieces(path))


def _marked_by(fields: Sequence[str]) -> str:
    """The key of `FIELDS` for the coordinates that a scan has."""
    for invalid, axes in FIELDS.items():
        if all(axis in fields for axis in axes):
            return invalid
    raise InputError(
        f"a scan of the E57 has neither {' '.join(FIELDS['cartesianInvalidState'])} nor ranges and angles: either would be right"
    )


def _pieces(path: Path) -> Iterator[Contents]:
    """No array is made for what the header promises: pye57's own `read_scan` leaves it as it was where the file ends before."""
    import pye57

    file = pye57.E57(str(path))
    try:
        for head in (file.get_header(i) for i in range(file.scan_count)):
            invalid = _marked_by(head.point_fields)
            axes = FIELDS[invalid]
            wanted = [*axes, *([invalid] if invalid in head.point_fields else [])]
            data, buffers = file.make_buffers(wanted, PIECE)
            reader = head.points.reader(buffers)
            remaining = head.point_count
            while remaining > 0:
                count = reader.read()
                if not count:
                    raise short_by("points", head.point_count, head.point_count - remaining)
                remaining -= count
                points = np.column_stack([data[axis][:count] for axis in axes])
                keep = ~data[invalid][:count].astype(bool) if invalid in data else np.ones(count, dtype=bool)
                points = points[keep]
                if invalid == "sphericalInvalidState":
                    points = _cartesian(points)
                if head.has_pose():
                    points = file.to_global(points, head.rotation, head.translation)
                yield Contents(points, rejected={} if keep.all() else {"invalid": int((~keep).sum())})
            reader.close()
    finally:
        file.close()


def _cartesian(points: Floats) -> Floats:
    """x, y and z of ranges, azimuths from x to y, and elevations above them (ASTM E2807)."""
    distance, azimuth, elevation = points.T
    level = distance * np.cos(elevation)
    return np.column_stack([level * np.cos(azimuth), level * np.sin(azimuth), distance * np.sin(elevation)])
