"""Flanks with known deviations: what is put in, to be asked back."""

from __future__ import annotations

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.gear import Gear
from gearwear.design.surface import SurfacePoints, flank_points, locate
from gearwear.inspection.traces import Traces


def flanks(gear: Gear, n_roll: int = 120, n_z: int = 30, seed: int = 0) -> SurfacePoints:
    """Points of every flank, one at a random place in each of n_roll × n_z equal cells."""
    rng = np.random.default_rng(seed)
    tooth, side, i, j = (
        a.ravel() for a in np.meshgrid(np.arange(gear.teeth), [1, -1], np.arange(n_roll), np.arange(n_z), indexing="ij")
    )
    roll = gear.form_roll + (i + rng.random(len(i))) / n_roll * (gear.tip_roll - gear.form_roll)
    z = (j + rng.random(len(j))) / n_z * gear.face_width
    return flank_points(gear, tooth, side, roll, z)


def displaced(points: SurfacePoints, deviation: Floats, gear: Gear) -> SurfacePoints:
    """The points moved along their normals and located anew, as a scan of that part would be."""
    return locate(points.position + deviation[:, None] * points.normal, gear, workers=1)


def hand_traces(station: Floats, deviation: Floats, error: Floats, along: str = "roll") -> Traces:
    """Traces (teeth, 2, n) made by hand, one point a bin."""
    shape = deviation.shape
    step = float(station[1] - station[0])
    return Traces(
        along,
        (0.0, 1.0),
        step,
        station,
        np.broadcast_to(station, shape).copy(),
        deviation,
        np.broadcast_to(error, shape).copy(),
        np.ones(shape, np.int64),
        np.zeros(shape),
    )
