"""Which tooth is which, as records: what told tooth 1, how a scan before wear lies, and what the gear is known again by."""

from __future__ import annotations

import math
from typing import Any

from gearwear.arrays import Floats
from gearwear.comparison.same_teeth import SameTeeth
from gearwear.design.scan_spec import DatumMark
from gearwear.placing.mark import SeenMark
from gearwear.report.records.numbers import Json, value_std


def same_teeth_record(same: SameTeeth | None) -> Json | None:
    """How the teeth of the scan before wear were told; null without one."""
    if same is None:
        return None
    return {
        "turned_teeth": same.turned,
        "upside_down": same.flipped,
        "probability": same.probability,
        "told_by": list(same.told_by),
        "stated": same.stated,
    }


def mark_record(mark: SeenMark | None, drawn: DatumMark | None) -> Json | None:
    """What told tooth 1; null where the design states no mark."""
    if mark is None or drawn is None:
        return None
    off = value_std(math.degrees(mark.off), math.degrees(mark.std))
    return {
        "angle_deg": math.degrees(drawn.angle),
        "off_deg": off,
        "points": mark.points,
        "probability": mark.chance,
        "end_told": mark.end_told,
    }


def pattern_values(values: Floats) -> list[Any]:
    """Left and right flank, rows, columns of one tooth: deviations in µm to 0.01, damage in mm³·10³; null where not seen."""
    return [[[round(1e3 * v, 2) if math.isfinite(v) else None for v in row] for row in side] for side in values.tolist()]
