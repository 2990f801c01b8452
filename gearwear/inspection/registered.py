"""What the registration's uncertainty does to traces: an error that all flanks have in common."""

from __future__ import annotations

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.gear import Gear
from gearwear.design.side import Side
from gearwear.design.surface import flank_points
from gearwear.inspection.traces import Traces


def shared_errors(traces: Traces, gear: Gear, covariance: Floats) -> Floats:
    """Change of every bin per standard deviation of the six independent motions that a covariance is made of.

    Parameters
    ----------
    traces : Traces
        Profile or helix traces.
    gear : Gear
        The nominal gear.
    covariance : (6, 6) float
        Of the motion (tx, ty, tz in mm; wx, wy, wz in rad) of the scan in the design frame.

    Returns
    -------
    (teeth, 2, n, 6) float
        mm; 0 in a gap.

    Notes
    -----
    ``n · (t + w × p)`` at the bin's own place, in first order.
    """
    value, vector = np.linalg.eigh(covariance)
    root = vector * np.sqrt(np.maximum(value, 0.0))
    if traces.across is None:
        raise ValueError("these traces do not know where across them their points lie")
    seen = traces.count > 0
    tooth, side, _ = np.nonzero(seen)
    along, across = traces.station[seen], traces.across[seen]
    roll, z = (along, across) if traces.along == "roll" else (across, along)
    points = flank_points(gear, tooth, np.array(Side)[side], roll, z)
    out = np.zeros((*seen.shape, 6))
    out[seen] = np.hstack([points.normal, np.cross(points.position, points.normal)]) @ root
    return out
