"""An inspection as plain numbers for `report.json`: units in the keys, teeth counted from 1, null where nothing was seen."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.side import Side
from gearwear.inspection.dimensions import Chord
from gearwear.inspection.estimate import COVERAGE_FACTOR, Estimate
from gearwear.inspection.evaluation import Evaluation, pressure_angle_deviation
from gearwear.inspection.grading import Finding
from gearwear.inspection.tolerances import FOOTNOTE

if TYPE_CHECKING:
    from gearwear.inspection.inspection import Inspection

Record = dict[str, object]


def as_dict(inspection: Inspection) -> Record:
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
        "required_class": settings.required_class,
        "k_bands": settings.k_bands.source if settings.k_bands is not None else None,
        "class": inspection.iso_class,
        "coverage_factor": COVERAGE_FACTOR,
        "noise_um": _number(inspection.noise, 1e3, 2),
        "sample_factor": None if settings.sample_factor is None else _number(settings.sample_factor, 1, 2),
        "points": inspection.points,
        "stray": inspection.stray,
        "coverage": [
            {"tooth": tooth + 1, **{side: _number(inspection.coverage[tooth, i], 1, 3) for i, side in enumerate(map(str, Side))}}
            for tooth in range(gear.teeth)
        ],
        "findings": [_finding(finding) for finding in inspection.findings],
        "profile": _evaluation(inspection.profile, inspection) | {"band_z_mm": _rounded(inspection.profile.band)},
        "helix": _evaluation(inspection.helix, inspection) | {"band_roll_mm": _rounded(inspection.helix.band)},
        "pitch": {
            "measuring_roll_mm": _number(pitch.roll, 1, 4),
            "measuring_radius_mm": _number(math.hypot(gear.base_radius, pitch.roll), 1, 4),
            "band_z_mm": _rounded(settings.pitch_band or inspection.profile.band),
            "sector_pitches": pitch.sector,
            "flanks": _per_flank({"index_um": pitch.index, "single_um": pitch.single}),
        },
        "runout": _runout(inspection),
        "dimensions": _dimensions(inspection),
        "notes": [note for note in inspection.notes if note != FOOTNOTE],
        "footnote": FOOTNOTE,
    }


def _finding(finding: Finding) -> Record:
    mark = finding.grade
    return {
        "symbol": finding.symbol,
        "quantity": finding.quantity,
        "flank": None if finding.side is None else str(finding.side),
        "tooth": None if finding.tooth is None else finding.tooth + 1,
        "value_um": _number(finding.value, 1e3, 2),
        "expanded_um": _number(finding.expanded, 1e3, 2),
        "noise_um": _number(finding.noise, 1e3, 2),
        "tolerance_um": _number(mark.tolerance, 1e3, 1),
        "class": mark.iso_class,
        "resolvable_class": mark.resolvable_class,
        "met_class": mark.met_class,
        "verdict": str(mark.verdict),
        "statement": finding.statement,
        "seen": finding.seen,
    }


def _evaluation(evaluation: Evaluation, inspection: Inspection) -> Record:
    where, roll = evaluation.range, evaluation.along == "roll"
    parts = {
        "slope_um": evaluation.slope,
        "form_um": evaluation.form,
        "total_um": evaluation.total,
        "crowning_um": evaluation.crowning,
    }
    flanks = _per_flank(parts)
    for row, share in zip(flanks, evaluation.share.ravel(), strict=True):
        row["share_of_range"] = _number(share, 1, 3)
    for row, (tooth, side) in zip(flanks, np.ndindex(*evaluation.share.shape), strict=True):
        if evaluation.k is not None and evaluation.k.bands[side] is not None:
            row["k_band"] = {
                "verdict": str(evaluation.k.verdict(tooth, side)),
                "excess_um": _estimate(evaluation.k.excess.at(tooth, side), 1e3, 2),
            }
    if roll:
        angle = pressure_angle_deviation(evaluation, inspection.gear)
        for row, (tooth, side) in zip(flanks, np.ndindex(*angle.value.shape), strict=True):
            row["pressure_angle_deg"] = _estimate(angle.at(tooth, side), 180.0 / math.pi, 5)
    return {
        "range_roll_mm" if roll else "range_z_mm": [_number(where.start, 1, 4), _number(where.end, 1, 4)],
        **({"slope_over_mm": _number(where.stated, 1, 4)} if roll else {}),
        "cutoff_mm": _number(where.cutoff, 1, 4),
        "widest_cutoff_mm": _number(evaluation.cutoff, 1, 4),
        "k_bands": _k_bands(evaluation),
        "mean": {side: {name: _mean(part.value[:, i]) for name, part in parts.items()} for i, side in enumerate(map(str, Side))},
        "flanks": flanks,
    }


def _k_bands(evaluation: Evaluation) -> Record | None:
    """The bands as they were applied, and how many flanks have each verdict."""
    if evaluation.k is None:
        return None
    name = "roll_mm" if evaluation.along == "roll" else "z_mm"
    return {
        side: {
            name: [_number(value, 1, 4) for value in band.station],
            "lower_um": [_number(value, 1e3, 2) for value in band.lower],
            "upper_um": [_number(value, 1e3, 2) for value in band.upper],
            "flanks": {str(verdict): count for verdict, count in evaluation.k.count(i).items()},
        }
        for i, side in enumerate(map(str, Side))
        if (band := evaluation.k.bands[i]) is not None
    }


def _runout(inspection: Inspection) -> Record | None:
    found = inspection.runout
    if found is None:
        return None
    x, y = (float(v) for v in found.eccentricity.value)
    return {
        "ball_diameter_mm": _number(found.pins.diameter, 1, 4),
        "runout_um": _estimate(found.runout, 1e3, 2),
        "spaces": [
            {"after_tooth": i + 1, "radial_um": _estimate(found.radial.at(i), 1e3, 2)} for i in range(inspection.gear.teeth)
        ],
        "eccentricity_um": _number(math.hypot(x, y), 1e3, 2),
        "eccentricity_direction_deg": _number(math.degrees(math.atan2(y, x)), 1, 2),
    }


def _dimensions(inspection: Inspection) -> Record:
    found, gear = inspection.dimensions, inspection.gear
    record: Record = {
        "tooth_thickness": {
            "nominal_mm": _number(gear.tooth_thickness, 1, 6),
            "nominal_normal_mm": _number(gear.normal_tooth_thickness, 1, 6),
            "teeth": [{"tooth": i + 1, "thickness_mm": _estimate(found.thickness.at(i), 1, 5)} for i in range(gear.teeth)],
        },
        "chordal": _chord(found.chord, found.chord_thickness),
        "constant_chord": _chord(found.constant_chord, found.constant_chord_thickness),
        "span": None,
        "over_pins": None,
    }
    if found.span is not None:
        record["span"] = {
            "teeth": found.span.teeth,
            "nominal_mm": _number(found.span.length, 1, 6),
            "contact_radius_mm": _number(found.span.radius, 1, 4),
            "rise_mm": _number(found.span.rise, 1, 4),
            "from_tooth": [{"tooth": i + 1, "length_mm": _estimate(found.span_lengths.at(i), 1, 5)} for i in range(gear.teeth)],
        }
    if found.pins is not None:
        record["over_pins"] = {
            "diameter_mm": _number(found.pins.diameter, 1, 5),
            "nominal_mm": _number(found.pins.length, 1, 6),
            "contact_radius_mm": _number(found.pins.radius, 1, 4),
            **({} if gear.twist == 0.0 else {"nominal_over_cylinders_mm": _number(found.pins.over_cylinders, 1, 6)}),
            "after_tooth": [
                {"tooth": i + 1, "length_mm": _estimate(found.pin_lengths.at(i), 1, 5)}
                for i in range(len(found.pin_lengths.value))
            ],
        }
    return record


def _per_flank(parts: dict[str, Estimate]) -> list[Record]:
    """A row per tooth and side."""
    shape = next(iter(parts.values())).value.shape
    return [
        {"tooth": tooth + 1, "flank": str(tuple(Side)[side])}
        | {name: _estimate(part.at(tooth, side), 1e3, 2) for name, part in parts.items()}
        for tooth, side in np.ndindex(*shape)
    ]


def _estimate(one: Estimate, factor: float, digits: int) -> Record | None:
    if not np.isfinite(one.value):
        return None
    record: Record = {
        "value": _number(float(one.value), factor, digits),
        "expanded": _number(float(one.expanded), factor, digits),
    }
    if float(one.noise) != 0.0:
        record["noise"] = _number(float(one.noise), factor, digits)
    return record


def _chord(nominal: Chord, measured: Estimate) -> Record:
    return {
        "nominal_mm": _number(nominal.thickness, 1, 6),
        "height_mm": _number(nominal.height, 1, 6),
        "teeth": [{"tooth": i + 1, "thickness_mm": _estimate(measured.at(i), 1, 5)} for i in range(len(measured.value))],
    }


def _mean(values: Floats) -> float | None:
    seen = values[np.isfinite(values)]
    return _number(float(seen.mean()), 1e3, 2) if len(seen) else None


def _rounded(pair: tuple[float, float]) -> list[float | None]:
    return [_number(value, 1, 4) for value in pair]


def _number(value: float, factor: float, digits: int) -> float | None:
    return round(float(value) * factor, digits) + 0.0 if math.isfinite(value) else None
