"""An inspection as columns of equal length, for CSV files and data frames: units in the names, nan or "" where not seen."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from gearwear.arrays import Floats
from gearwear.design.side import Side
from gearwear.inspection.estimate import Estimate
from gearwear.inspection.radial import STANDARD as RADIAL_STANDARD

if TYPE_CHECKING:
    from gearwear.inspection.inspection import Inspection

Columns = dict[str, NDArray[Any]]


def finding_columns(inspection: Inspection) -> Columns:
    """The worst of every deviation, a row each, and those of rolling with a master."""
    findings = (*inspection.findings, *inspection.radial)
    standards = [str(inspection.settings.edition)] * len(inspection.findings) + [RADIAL_STANDARD] * len(inspection.radial)
    classes = ("iso_class", "resolvable_class", "met_class")
    return {
        "symbol": np.array([finding.symbol for finding in findings]),
        "quantity": np.array([finding.quantity for finding in findings]),
        "flank": np.array(["" if finding.side is None else str(finding.side) for finding in findings]),
        "tooth": _numbers([None if finding.tooth is None else finding.tooth + 1 for finding in findings]),
        "value_um": 1e3 * np.array([finding.value for finding in findings]),
        "U_um": 1e3 * np.array([finding.expanded for finding in findings]),
        "noise_um": 1e3 * np.array([finding.noise for finding in findings]),
        "tolerance_um": 1e3 * np.array([finding.grade.tolerance for finding in findings]),
        **{name.removeprefix("iso_"): _numbers([getattr(finding.grade, name) for finding in findings]) for name in classes},
        "verdict": np.array([str(finding.grade.verdict) for finding in findings]),
        "statement": np.array([finding.statement for finding in findings]),
        "seen": np.array([finding.seen for finding in findings]),
        "standard": np.array(standards),
    }


def flank_columns(inspection: Inspection) -> Columns:
    """Every flank, left and right of tooth 1 first."""
    evaluations = (("profile", inspection.profile), ("helix", inspection.helix))
    parts: dict[str, Estimate] = {
        f"{name}_{part}": getattr(evaluation, part)
        for name, evaluation in evaluations
        for part in ("slope", "form", "total", "crowning")
    }
    parts |= {"index": inspection.pitch.index, "single_pitch": inspection.pitch.single}
    if inspection.laboratory is not None:
        sections, areal = inspection.laboratory.sections, inspection.laboratory.areal
        for name, cuts in (("profile", sections.profiles), ("helix", sections.helices)):
            for cut in cuts:
                parts |= {f"{name}_{cut.place}_{part}": getattr(cut.evaluation, part) for part in ("slope", "form", "total")}
        parts |= {f"areal_{name}": part for name, part in areal.flanks.named().items()}
        parts |= {"lowest": areal.lowest, "highest": areal.highest}
    banded = {name: evaluation.k for name, evaluation in evaluations if evaluation.k is not None}
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
    traced = [("mean", 0.5 * sum(evaluation.band), evaluation) for evaluation in (inspection.profile, inspection.helix)]
    if inspection.laboratory is not None:
        sections = inspection.laboratory.sections
        traced += [(cut.place, cut.at, cut.evaluation) for cut in (*sections.profiles, *sections.helices)]
    rows: list[Columns] = []
    for place, at, evaluation in traced:
        tooth, side, station = (index.ravel() for index in np.indices(evaluation.filtered.shape))
        seen = np.isfinite(evaluation.filtered.ravel())
        tooth, side, station = tooth[seen], side[seen], station[seen]
        along, across = evaluation.station[station], np.full(len(station), at)
        roll, z = (along, across) if evaluation.along == "roll" else (across, along)
        rows.append({
            "part": np.full(len(roll), inspection.gear.spec.name),
            "kind": np.full(len(roll), "profile" if evaluation.along == "roll" else "helix"),
            "place": np.full(len(roll), place),
            "tooth": tooth + 1,
            "flank": np.array([str(side) for side in Side])[side],
            "roll_mm": np.abs(roll),
            "diameter_mm": 2.0 * np.hypot(roll, inspection.gear.base_radius),
            "z_mm": z,
            "deviation_um": 1e3 * evaluation.filtered[tooth, side, station],
            "U_um": 2e3 * evaluation.standard[tooth, side, station],
            "evaluated": ((along >= evaluation.range.start) & (along <= evaluation.range.end)).astype(np.int64),
        })  # fmt: skip
    return {name: np.concatenate([row[name] for row in rows]) for name in rows[0]}


def tooth_columns(inspection: Inspection) -> Columns:
    """Every tooth: thickness, span and over pins that start on it."""
    dimensions, teeth = inspection.dimensions, inspection.gear.teeth
    parts: dict[str, Estimate] = {
        "thickness": dimensions.thickness, "chordal_thickness": dimensions.chord_thickness,
        "constant_chord": dimensions.constant_chord_thickness, "span": dimensions.span_lengths, "over_pins": dimensions.pin_lengths,
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
