"""An inspection as columns of equal length, for CSV files and data frames: units in the names, nan or "" where not seen."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from gearwear.arrays import Floats
from gearwear.design.side import Side
from gearwear.inspection.estimate import Estimate

if TYPE_CHECKING:
    from gearwear.inspection.inspection import Inspection

Columns = dict[str, NDArray[Any]]


def finding_columns(inspection: Inspection) -> Columns:
    """The worst of every deviation, a row each; see `Inspection.finding_columns`."""
    found = inspection.findings
    classes = ("iso_class", "resolvable_class", "met_class")
    return {
        "symbol": np.array([one.symbol for one in found]),
        "quantity": np.array([one.quantity for one in found]),
        "flank": np.array(["" if one.side is None else str(one.side) for one in found]),
        "tooth": _numbers([None if one.tooth is None else one.tooth + 1 for one in found]),
        "value_um": 1e3 * np.array([one.value for one in found]),
        "U_um": 1e3 * np.array([one.expanded for one in found]),
        "noise_um": 1e3 * np.array([one.noise for one in found]),
        "tolerance_um": 1e3 * np.array([one.grade.tolerance for one in found]),
        **{name.removeprefix("iso_"): _numbers([getattr(one.grade, name) for one in found]) for name in classes},
        "verdict": np.array([str(one.grade.verdict) for one in found]),
        "statement": np.array([one.statement for one in found]),
        "seen": np.array([one.seen for one in found]),
    }


def flank_columns(inspection: Inspection) -> Columns:
    """Every flank, left and right of tooth 1 first; see `Inspection.flank_columns`."""
    evaluations = (("profile", inspection.profile), ("helix", inspection.helix))
    parts: dict[str, Estimate] = {
        f"{name}_{part}": getattr(one, part) for name, one in evaluations for part in ("slope", "form", "total", "crowning")
    }
    parts |= {"index": inspection.pitch.index, "single_pitch": inspection.pitch.single}
    if inspection.laboratory is not None:
        sections, areal = inspection.laboratory.sections, inspection.laboratory.areal
        for name, cuts in (("profile", sections.profiles), ("helix", sections.helices)):
            for cut in cuts:
                parts |= {f"{name}_{cut.place}_{part}": getattr(cut.evaluation, part) for part in ("slope", "form", "total")}
        parts |= {f"areal_{name}": part for name, part in areal.flanks.named().items()}
        parts |= {"lowest": areal.lowest, "highest": areal.highest}
    banded = {name: one.k for name, one in evaluations if one.k is not None}
    parts |= {f"{name}_k_excess": k.excess for name, k in banded.items()}
    shape = inspection.coverage.shape
    tooth, side = np.indices(shape)
    columns: Columns = {
        "tooth": tooth.ravel() + 1,
        "flank": np.array([str(side) for side in Side])[side.ravel()],
        "coverage": inspection.coverage.ravel(),
    }
    for name, part in parts.items():
        columns[f"{name}_um"], columns[f"{name}_U_um"] = 1e3 * part.value.ravel(), 1e3 * part.expanded.ravel()
    for name, k in banded.items():
        columns[f"{name}_k_verdict"] = np.array([str(k.verdict(*flank) or "") for flank in np.ndindex(*shape)])
    return columns


def trace_columns(inspection: Inspection) -> Columns:
    """Every point of every filtered trace, long; what `gearwear.design.files.traces` reads.

    ``part``, ``kind`` (profile, helix), ``place`` (mean; low, middle, high), ``tooth``, ``flank``, ``roll_mm``, ``diameter_mm``, ``z_mm`` (of a mean the middle of what it is over),
    ``deviation_um`` along the transverse base tangent, ``U_um`` (scatter alone), ``evaluated`` (1 inside the evaluation range).
    """
    found = [("mean", 0.5 * sum(one.band), one) for one in (inspection.profile, inspection.helix)]
    if inspection.laboratory is not None:
        sections = inspection.laboratory.sections
        found += [(cut.place, cut.at, cut.evaluation) for cut in (*sections.profiles, *sections.helices)]
    rows: list[Columns] = []
    for place, at, one in found:
        tooth, side, station = (index.ravel() for index in np.indices(one.filtered.shape))
        seen = np.isfinite(one.filtered.ravel())
        tooth, side, station = tooth[seen], side[seen], station[seen]
        along, across = one.station[station], np.full(len(station), at)
        roll, z = (along, across) if one.along == "roll" else (across, along)
        rows.append({
            "part": np.full(len(roll), inspection.gear.spec.name),
            "kind": np.full(len(roll), "profile" if one.along == "roll" else "helix"),
            "place": np.full(len(roll), place),
            "tooth": tooth + 1,
            "flank": np.array([str(side) for side in Side])[side],
            "roll_mm": np.abs(roll),
            "diameter_mm": 2.0 * np.hypot(roll, inspection.gear.base_radius),
            "z_mm": z,
            "deviation_um": 1e3 * one.filtered[tooth, side, station],
            "U_um": 2e3 * one.standard[tooth, side, station],
            "evaluated": ((along >= one.range.start) & (along <= one.range.end)).astype(np.int64),
        })  # fmt: skip
    return {name: np.concatenate([row[name] for row in rows]) for name in rows[0]}


def tooth_columns(inspection: Inspection) -> Columns:
    """Every tooth; see `Inspection.tooth_columns`."""
    found, teeth = inspection.dimensions, inspection.gear.teeth
    parts: dict[str, Estimate] = {
        "thickness": found.thickness, "chordal_thickness": found.chord_thickness,
        "constant_chord": found.constant_chord_thickness, "span": found.span_lengths, "over_pins": found.pin_lengths,
    }  # fmt: skip
    if inspection.runout is not None:
        parts["ball_radius_less_nominal"] = inspection.runout.radial
    columns: Columns = {"tooth": np.arange(teeth) + 1}
    for name, part in parts.items():
        columns[f"{name}_mm"], columns[f"{name}_U_mm"] = _padded(part.value, teeth), _padded(part.expanded, teeth)
    return columns


def _padded(values: Floats, count: int) -> Floats:
    """`values` and nan behind them: over pins an even number of teeth has half as many places."""
    return np.concatenate([values, np.full(count - len(values), np.nan)])


def _numbers(values: list[int | None]) -> Floats:
    return np.array([np.nan if value is None else float(value) for value in values])
