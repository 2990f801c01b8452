"""Points from E57: read by pye57, imported only when such a file comes."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np

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
            promised = [file.get_header(i).point_count for i in range(file.scan_count)]
            check_count("points", sum(promised), 1, MOST_UNPACKED * len(data))
            clouds = [file.read_scan(i, ignore_missing_fields=True) for i in range(file.scan_count)]
        finally:
            file.close()
    axes = ("cartesianX", "cartesianY", "cartesianZ")
    points = np.concatenate([np.empty((0, 3))] + [np.column_stack([cloud[axis] for axis in axes]) for cloud in clouds])
    invalid = sum(promised) - len(points)
    return Contents(points, rejected={"invalid": invalid} if invalid else {})
