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
    covariance : (6, 6) or (7, 7) float
        Of the motion (tx, ty, tz in mm; wx, wy, wz in rad) of the scan in the design frame, and of its relative scale, which hangs on none of it.

    Returns
    -------
    (teeth, 2, n, 6 or 7) float
        mm; 0 in a gap.

    Notes
    -----
    ``n · (t + w × p) / cos β_b`` at the bin's own place, in first order, along the transverse base tangent as the traces are.
    """
    seen = traces.count > 0
    along, across = (np.where(seen, place, 0.0) for place in (traces.station, traces.across))
    roll, z = (along, across) if traces.along == "roll" else (across, along)
    return np.where(seen[..., None], motion_errors(gear, roll, z, covariance), 0.0)


def covariance_root(covariance: Floats) -> Floats:
    """(p, p) of a covariance (p, p): what independent errors of variance 1 do; rounding below 0 counts as 0."""
    value, vector = np.linalg.eigh(covariance)
    return np.asarray(vector * np.sqrt(np.maximum(value, 0.0)), dtype=np.float64)


def motion_errors(gear: Gear, roll: Floats, z: Floats, covariance: Floats) -> Floats:
    """The same at any places of the flanks, L (of either sign: `ranges.profile_place`) and z in mm, (teeth, 2, …); (teeth, 2, …, 6 or 7) mm.

    The independent motions are those about the middle of the gear, of turns as lengths on its reference circle: then they are the gear's own, however it
    lies in its frame.
    """
    middle = np.array([0.0, 0.0, 0.5 * gear.face_width])
    about = np.eye(6)
    about[:3, 3:] = np.cross(np.eye(3), middle).T
    about[3:] *= gear.reference_radius
    root = covariance_root(about @ covariance[:6, :6] @ about.T)
    root[3:] /= gear.reference_radius
    tooth, side = np.indices(roll.shape)[:2]
    points = flank_points(gear, tooth.ravel(), np.array(Side)[side.ravel()], np.abs(roll.ravel()), z.ravel())
    position = points.position - middle
    columns = np.hstack([points.normal, np.cross(position, points.normal)]) @ root
    if len(covariance) > 6:  # a relative scale moves each point by itself: n · s p, that is s L on a spur flank
        grown = np.sum(points.normal * position, axis=1, keepdims=True)
        columns = np.hstack([columns, np.sqrt(covariance[6, 6]) * grown])
    columns /= gear.base_helix_cosine
    return np.asarray(columns.reshape(*roll.shape, len(covariance)), dtype=np.float64)
