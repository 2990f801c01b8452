"""What `report.json` says of each of several views."""

from __future__ import annotations

import math

import numpy as np

from gearwear.placing.accord import OFFSET, SCALE
from gearwear.placing.together import Taken
from gearwear.placing.views import View
from gearwear.report.records.numbers import Json


def view_record(view: View) -> Json:
    """A view, but for its pose: how it was found against the others, and what was taken out of it."""
    accord = view.accord
    own = math.isfinite(accord.own_scale_std) and math.isfinite(accord.own_offset_std)
    return {
        "points": view.points, "kept": view.kept, "noise_um": 1e3 * view.registration.noise, "offset_um": 1e3 * view.offset, "mismatch_um": 1e3 * view.mismatch,
        "shared_cells": accord.shared, "place_um": 1e3 * accord.place, "stands_um": 1e3 * accord.offset,
        "stands_std_um": 1e3 * accord.offset_std, "scale_ppm": 1e6 * accord.scale, "scale_std_ppm": 1e6 * accord.scale_std,
        "residual_um": 1e3 * accord.residual, "torn_um": 1e3 * accord.torn, "own_scale_ppm": 1e6 * accord.own_scale if own else math.nan,
        "own_scale_std_ppm": 1e6 * accord.own_scale_std if own else math.nan, "own_offset_um": 1e3 * accord.own_offset if own else math.nan,
        "own_offset_std_um": 1e3 * accord.own_offset_std if own else math.nan, "mismatch_left_um": 1e3 * view.left,
        "taken_out": _taken_record(view.taken) if view.taken.any else None,
    }  # fmt: skip


def _taken_record(taken: Taken) -> Json:
    std = np.sqrt(np.diag(taken.covariance))
    return {
        "scale_ppm": 1e6 * taken.scale,
        "scale_std_ppm": 1e6 * float(std[SCALE]),
        "offset_um": 1e3 * taken.offset,
        "offset_std_um": 1e3 * float(std[OFFSET]),
        "moved_um": (1e3 * taken.motion[:3]).tolist(),
        "turned_deg": np.degrees(taken.motion[3:]).tolist(),
    }
