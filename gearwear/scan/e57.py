"""Points from E57: read by pye57, imported only when such a file comes."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from gearwear.memory import check_memory
from gearwear.scan.contents import Contents
from gearwear.scan.parsing import MOST_UNPACKED, check_count, not_installed, short_by
from gearwear.scan.pieces import PIECE, Pieces

AXES, INVALID = ("cartesianX", "cartesianY", "cartesianZ"), "cartesianInvalidState"


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
        If pye57 is missing or the file is damaged.
    """
    try:
        import pye57
    except ImportError:
        raise not_installed("E57", "pye57") from None
    with tempfile.TemporaryDirectory() as folder:  # pye57 opens files by name only, and only unpacked ones
        path = Path(folder) / "scan.e57"
        path.write_bytes(data)
        file = pye57.E57(str(path))
        try:
            heads = [file.get_header(i) for i in range(file.scan_count)]
            promised = [head.point_count for head in heads]
            check_count("points", sum(promised), 1, MOST_UNPACKED * len(data))
            # each field of each point becomes a number of 8 bytes, however few bits it has in the file
            check_memory(points=sum(promised), other=sum(8 * head.point_count * len(head.point_fields) for head in heads))
            clouds = [file.read_scan(i, ignore_missing_fields=True) for i in range(file.scan_count)]
        finally:
            file.close()
    points = np.concatenate([np.empty((0, 3))] + [np.column_stack([cloud[axis] for axis in AXES]) for cloud in clouds])
    invalid = sum(promised) - len(points)
    return Contents(points, rejected={"invalid": invalid} if invalid else {})


def e57_pieces(path: Path) -> Pieces | None:
    """The points of all scans of an E57, piece by piece; None where they are stored as ranges and angles. Parameters and errors as `read_e57`."""
    try:
        import pye57
    except ImportError:
        raise not_installed("E57", "pye57") from None
    file = pye57.E57(str(path))
    try:
        heads = [file.get_header(i) for i in range(file.scan_count)]
        promised = [head.point_count for head in heads]
        if any(axis not in head.point_fields for head in heads for axis in AXES):
            return None
    finally:
        file.close()
    check_count("points", sum(promised), 1, MOST_UNPACKED * path.stat().st_size)
    return Pieces(sum(promised), lambda: _pieces(path))


def _pieces(path: Path) -> Iterator[Contents]:
    import pye57

    file = pye57.E57(str(path))
    try:
        for head in (file.get_header(i) for i in range(file.scan_count)):
            wanted = [field for field in (*AXES, INVALID) if field in head.point_fields]
            data, buffers = file.make_buffers(wanted, PIECE)
            reader = head.points.reader(buffers)
            remaining = head.point_count
            while remaining > 0:
                count = reader.read()
                if not count:
                    raise short_by("points", head.point_count, head.point_count - remaining)
                remaining -= count
                points = np.column_stack([data[axis][:count] for axis in AXES])
                keep = ~data[INVALID][:count].astype(bool) if INVALID in data else np.ones(count, dtype=bool)
                points = points[keep]
                if head.has_pose():
                    points = file.to_global(points, head.rotation, head.translation)
                yield Contents(points, rejected={} if keep.all() else {"invalid": int((~keep).sum())})
            reader.close()
    finally:
        file.close()
