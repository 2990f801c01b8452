"""An inspection as plain numbers for `report.json`: units in the keys, teeth counted from 1, null where nothing was seen."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.side import Side
from gearwear.inspection.budget import BudgetLine
from gearwear.inspection.dimensions import Chord
from gearwear.inspection.estimate import COVERAGE_FACTOR, Estimate
from gearwear.inspection.evaluation import Evaluation, pressure_angle_deviation
from gearwear.inspection.grading import Finding
from gearwear.inspection.radial import STANDARD as RADIAL_STANDARD
from gearwear.inspection.tolerances import FOOTNOTE
from gearwear.report.records.laboratory import laboratory_record
from gearwear.report.records.numbers import Json, estimate, lengths, per_flank, rolls, rounded

if TYPE_CHECKING:
    from gearwear.inspection.inspection import Inspection


def as_dict(inspection: Inspection) -> Json:
    """Everything but the traces and the topography.

    Parameters
    ----------
    inspection : Inspection
        What was found.

    Returns
    -------
    dict
        Deviations in µm, dimensions in mm. Every number that was measured is ``{"value", "expanded"}``, U with k = 2, and ``noise``, the
        most that the scan's noise may have added to it, where that is not 0.
    """
    settings, gear, pitch = inspection.settings, inspection.gear, inspection.pitch
    return {
        "standard": str(settings.edition),
        "axis": settings.axis,
        "required_class": settings.required_class,
        "k_bands": settings.k_bands.source if settings.k_bands is not None else None,
        "class": inspection.iso_class,
        "coverage_factor": COVERAGE_FACTOR,
        "noise_um": rounded(inspection.noise, 1e3, 2),
        "sample_factor": None if settings.sample_factor is None else rounded(settings.sample_factor, 1, 2),
        "points": inspection.points,
        "stray": inspection.stray,
        "coverage": [
            {"tooth": tooth + 1, **{side: rounded(inspection.coverage[tooth, i], 1, 3) for i, side in enumerate(map(str, Side))}}
            for tooth in range(gear.teeth)
        ],
        "findings": [_finding(finding) for finding in inspection.findings],
        "radial": None
        if not inspection.radial
        else {"standard": RADIAL_STANDARD, "findings": [_finding(finding) for finding in inspection.radial]},
        "profile": _evaluation(inspection.profile, inspection) | {"band_z_mm": lengths(inspection.profile.band)},
        "helix": _evaluation(inspection.helix, inspection) | {"band_roll_mm": rolls(inspection.helix.band)},
        "pitch": {
            "measuring_roll_mm": rounded(pitch.roll, 1, 4),
            "measuring_radius_mm": rounded(math.hypot(gear.base_radius, pitch.roll), 1, 4),
            "band_z_mm": lengths(settings.pitch_band or inspection.profile.band),
            "sector_pitches": pitch.sector,
            "flanks": per_flank({"index_um": pitch.index, "single_um": pitch.single}),
        },
        "runout": _runout(inspection),
        "dimensions": _dimensions(inspection),
        "budget": [_budget(line) for line in inspection.budget],
        "laboratory": None if inspection.laboratory is None else laboratory_record(inspection.laboratory, gear),
        "notes": [note for note in inspection.notes if note != FOOTNOTE],
        "footnote": FOOTNOTE,
    }


def _budget(line: BudgetLine) -> Json:
    parts = {f"{name}_um": rounded(getattr(line, name), 1e3, 3) for name in ("own", "registration", "scale", "noise")}
    return {"quantity": line.quantity, **parts, "expanded_um": rounded(line.expanded, 1e3, 3)}


def about_axis_record(inspection: Inspection) -> Json:
    """What depends on the axis, of an inspection about another one."""
    return {
        "axis": inspection.settings.axis,
        "findings": [
            _finding(finding)
            for finding in inspection.findings
            if finding.quantity.endswith("pitch") or finding.quantity == "runout"
        ],
        "runout": _runout(inspection),
    }


def _finding(finding: Finding) -> Json:
    mark = finding.grade
    return {
        "symbol": finding.symbol,
        "quantity": finding.quantity,
        "flank": None if finding.side is None else str(finding.side),
        "tooth": None if finding.tooth is None else finding.tooth + 1,
        "value_um": rounded(finding.value, 1e3, 2),
        "expanded_um": rounded(finding.expanded, 1e3, 2),
        "noise_um": rounded(finding.noise, 1e3, 2),
        "tolerance_um": rounded(mark.tolerance, 1e3, 1),
        "class": mark.iso_class,
        "resolvable_class": mark.resolvable_class,
        "met_class": mark.met_class,
        "verdict": str(mark.verdict),
        "statement": finding.statement,
        "seen": finding.seen,
    }


def _evaluation(evaluation: Evaluation, inspection: Inspection) -> Json:
    where, roll = evaluation.range, evaluation.along == "roll"
    parts = {
        "slope_um": evaluation.slope,
        "form_um": evaluation.form,
        "total_um": evaluation.total,
        "crowning_um": evaluation.crowning,
    }
    flanks = per_flank(parts)
    for row, share in zip(flanks, evaluation.share.ravel(), strict=True):
        row["share_of_range"] = rounded(share, 1, 3)
    for row, (tooth, side) in zip(flanks, np.ndindex(*evaluation.share.shape), strict=True):
        if evaluation.k is not None and evaluation.k.bands[side] is not None:
            row["k_band"] = {
                "verdict": str(evaluation.k.verdict(tooth, side)),
                "excess_um": estimate(evaluation.k.excess.at(tooth, side), 1e3, 2),
            }
    if roll:
        angle = pressure_angle_deviation(evaluation, inspection.gear)
        for row, (tooth, side) in zip(flanks, np.ndindex(*angle.value.shape), strict=True):
            row["pressure_angle_deg"] = estimate(angle.at(tooth, side), 180.0 / math.pi, 5)
    return {
        "range_roll_mm" if roll else "range_z_mm": (rolls if roll else lengths)(where.ends),
        **({"slope_over_mm": rounded(where.stated, 1, 4)} if roll else {}),
        "cutoff_mm": rounded(where.cutoff, 1, 4),
        "widest_cutoff_mm": rounded(evaluation.cutoff, 1, 4),
        "stylus_radius_mm": inspection.settings.stylus_radius,
        "k_bands": _k_bands(evaluation),
        "mean": {side: {name: _mean(part.value[:, i]) for name, part in parts.items()} for i, side in enumerate(map(str, Side))},
        "flanks": flanks,
    }


def _k_bands(evaluation: Evaluation) -> Json | None:
    """The bands as they were applied, and how many flanks have each verdict."""
    if evaluation.k is None:
        return None
    name = "roll_mm" if evaluation.along == "roll" else "z_mm"
    return {
        side: {
            name: [rounded(abs(value) if evaluation.along == "roll" else value, 1, 4) for value in band.station],
            "lower_um": [rounded(value, 1e3, 2) for value in band.lower],
            "upper_um": [rounded(value, 1e3, 2) for value in band.upper],
            "flanks": {str(verdict): count for verdict, count in evaluation.k.count(i).items()},
        }
        for i, side in enumerate(map(str, Side))
        if (band := evaluation.k.bands[i]) is not None
    }


def _runout(inspection: Inspection) -> Json | None:
    balls = inspection.runout
    if balls is None:
        return None
    x, y = (float(v) for v in balls.eccentricity.value)
    return {
        "ball_diameter_mm": rounded(balls.pins.diameter, 1, 4),
        "runout_um": estimate(balls.runout, 1e3, 2),
        "spaces": [
            {"after_tooth": i + 1, "radial_um": estimate(balls.radial.at(i), 1e3, 2)} for i in range(inspection.gear.teeth)
        ],
        "eccentricity_um": rounded(math.hypot(x, y), 1e3, 2),
        "eccentricity_direction_deg": rounded(math.degrees(math.atan2(y, x)), 1, 2),
    }


def _dimensions(inspection: Inspection) -> Json:
    dimensions, gear = inspection.dimensions, inspection.gear
    record: Json = {
        "tooth_thickness": {
            "nominal_mm": rounded(gear.drawn_tooth_thickness, 1, 6),
            "nominal_normal_mm": rounded(gear.drawn_tooth_thickness * math.cos(gear.helix_angle), 1, 6),
            "teeth": [{"tooth": i + 1, "thickness_mm": estimate(dimensions.thickness.at(i), 1, 5)} for i in range(gear.teeth)],
        },
        "chordal": _chord(dimensions.chord, dimensions.chord_thickness),
        "constant_chord": _chord(dimensions.constant_chord, dimensions.constant_chord_thickness),
        "span": None,
        "over_pins": None,
    }
    if dimensions.span is not None:
        record["span"] = {
            "teeth": dimensions.span.teeth,
            "nominal_mm": rounded(dimensions.span.length, 1, 6),
            "contact_radius_mm": rounded(dimensions.span.radius, 1, 4),
            "rise_mm": rounded(dimensions.span.rise, 1, 4),
            "from_tooth": [
                {"tooth": i + 1, "length_mm": estimate(dimensions.span_lengths.at(i), 1, 5)} for i in range(gear.teeth)
            ],
        }
    if dimensions.pins is not None:
        record["over_pins"] = {
            "diameter_mm": rounded(dimensions.pins.diameter, 1, 5),
            "nominal_mm": rounded(dimensions.pins.length, 1, 6),
            "contact_radius_mm": rounded(dimensions.pins.radius, 1, 4),
            **(
                {}
                if gear.twist == 0.0 or gear.spec.internal
                else {"nominal_over_cylinders_mm": rounded(dimensions.pins.over_cylinders, 1, 6)}
            ),
            "after_tooth": [
                {"tooth": i + 1, "length_mm": estimate(dimensions.pin_lengths.at(i), 1, 5)}
                for i in range(len(dimensions.pin_lengths.value))
            ],
        }
    drawn = dimensions.drawn(gear)
    if drawn is not None:
        gauge, kept = drawn
        record["span" if gauge.pin_diameter is None else "over_pins"] |= {"limits_mm": [gauge.low, gauge.high], "limits": kept}
    return record


def _chord(nominal: Chord, measured: Estimate) -> Json:
    return {
        "nominal_mm": rounded(nominal.thickness, 1, 6),
        "height_mm": rounded(nominal.height, 1, 6),
        "teeth": [{"tooth": i + 1, "thickness_mm": estimate(measured.at(i), 1, 5)} for i in range(len(measured.value))],
    }


def _mean(values: Floats) -> float | None:
    seen = values[np.isfinite(values)]
    return rounded(float(seen.mean()), 1e3, 2) if len(seen) else None
