"""Points from LAS and LAZ: read by laspy, imported only when such a file comes."""

from __future__ import annotations

from io import BytesIO

import numpy as np

from gearwear.scan.parsing import MOST_UNPACKED, check_count, not_installed
from gearwear.scan.types import Contents


def read_las(data: bytes) -> Contents:
    """Read the points of a LAS or LAZ; those flagged as withheld are left out and counted.

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
        If laspy (with lazrs for LAZ) is missing or the file is damaged.
    """
    try:
        import laspy
    except ImportError:
        raise not_installed("LAS", "laspy") from None
    with laspy.open(BytesIO(data), closefd=False) as file:
        header = file.header
        packed = header.are_points_compressed
        room = (len(data) - header.offset_to_point_data) * (MOST_UNPACKED if packed else 1)
        check_count("points", header.point_count, header.point_format.size, max(room, 0))
        try:
            cloud = file.read()
        except laspy.errors.LaspyException as error:
            if "backend" in str(error).lower():
                raise not_installed("LAZ", "lazrs") from None
            raise
    points = np.column_stack([np.asarray(cloud.x), np.asarray(cloud.y), np.asarray(cloud.z)]).astype(np.float64)
    withheld = np.asarray(cloud.withheld, bool)
    return Contents(points[~withheld], rejected={"invalid": int(withheld.sum())} if withheld.any() else {})
