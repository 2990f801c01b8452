"""Points from E57: read by pye57, imported only when such a file comes."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np

from gearwear.memory import check_memory
from gearwear.scan.parsing import MOST_UNPACKED, check_count, not_installed
from gearwear.scan.types import Contents


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
    axes = ("cartesianX", "cartesianY", "cartesianZ")
    points = np.concatenate([np.empty((0, 3))] + [np.column_stack([cloud[axis] for axis in axes]) for cloud in clouds])
    invalid = sum(promised) - len(points)
    return Contents(points, rejected={"invalid": invalid} if invalid else {})
