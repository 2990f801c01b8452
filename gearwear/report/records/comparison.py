"""`report.json`: the contract's keys from a finished comparison. Millimetres become µm and radians degrees here and nowhere else."""

from __future__ import annotations

import math
from importlib.metadata import PackageNotFoundError, version
from typing import Any

import numpy as np

from gearwear.comparison.results import MeshingStudy, Results
from gearwear.design.gear import Gear
from gearwear.design.side import Side
from gearwear.design.surface import SURFACE_NAMES
from gearwear.diagnose.effects.base import Kind
from gearwear.diagnose.loop import FoundEffect, Loop
from gearwear.meshing.backlash import backlash_from_normal
from gearwear.placing.refusal import base_radius, rims
from gearwear.placing.registration import Registration
from gearwear.placing.views import PlacedScan
from gearwear.report.records.inspection import as_dict
from gearwear.report.words.consequences import change_records
from gearwear.report.words.shafts import take_up_record
from gearwear.report.words.wear_law import wear_law_record
from gearwear.wear.regions import Wear

SCHEMA = "gearwear.report/1"

Json = dict[str, Any]


def document(results: Results, files: list[str]) -> Json:
    """Build the dict that is written as `report.json`.

    Parameters
    ----------
    results : Results
        A finished comparison.
    files : list of str
        What was written beside it.

    Returns
    -------
    dict
        Keys as in ``docs/report.md``; nan where something is not known (written as null).
    """
    report: Json = {
        "schema": SCHEMA,
        "version": _version(),
        "design": _design(results),
        "scan": _scan(results),
        "registration": _registration(results),
        "closed_loop": _loop(results),
        "wear": _wear(results),
        "thickness": _thickness(results),
        "thinnest": _thinnest(results),
        "broken": [
            {
                "tooth": one.tooth + 1,
                "flank": one.flank,
                "kind": one.kind,
                "volume_mm3": {"value": one.volume, "std": one.std},
                "seen": one.seen,
            }
            for one in results.broken
        ],
        "meshing": None if results.meshing is None else _meshing(results, results.meshing),
        "inspection": None if results.inspection is None else as_dict(results.inspection),
        "notes": list(results.notes),
        "files": files,
    }
    if results.meshing is None:
        report["notes"].append("the design has one gear: what needs a mate (backlash, contact, transmission error) is left out")
    return report


def _version() -> str | None:
    """Of the installed package; None where it runs from its source alone."""
    try:
        return version("gearwear")
    except PackageNotFoundError:
        return None


def _design(results: Results) -> Json:
    gear, spec = results.gear, results.gear.spec
    return {
        "source": results.design.source,
        "part": results.part,
        "teeth": gear.teeth,
        "module_mm": spec.normal_module,
        "pressure_angle_deg": math.degrees(spec.normal_pressure_angle),
        "profile_shift": spec.profile_shift,
        "face_width_mm": gear.face_width,
        "reference_radius_mm": gear.reference_radius,
        "base_radius_mm": gear.base_radius,
        "tip_radius_mm": gear.tip_radius,
        "root_radius_mm": gear.root_radius,
        "form_radius_mm": gear.form_radius,
        "tooth_thickness_mm": gear.tooth_thickness,
        "undercut": gear.undercut,
        "section_area_mm2": gear.section_area(),
        "warnings": list(results.design.warnings),
    }


def _scan(results: Results) -> Json:
    located = results.placed.located
    rejected: dict[str, int] = {}
    for scan in results.scans:
        for reason, count in scan.rejected.items():
            rejected[reason] = rejected.get(reason, 0) + count
    if results.placed.thinned:
        rejected["overlap_of_views"] = results.placed.thinned
    used = int(np.nansum(results.raw.count))
    other = int((located.surface == len(SURFACE_NAMES) - 1).sum())
    strays = len(located) - used - other
    if results.fracture_points:
        rejected["fracture"] = results.fracture_points
    if strays > 0:
        rejected["stray"] = strays
    coverage = {}
    for code, (start, size) in results.raw.grid.blocks.items():
        if code != SURFACE_NAMES.index("bore") or results.gear.spec.bore_diameter > 0.0:
            seen = results.raw.count[start : start + size] > 0
            coverage[SURFACE_NAMES[code]] = float(seen.mean())
            if SURFACE_NAMES[code] == "flank":
                side = results.raw.points.side[start : start + size]
                coverage |= {f"flank_{sign}": float(seen[side == sign].mean()) for sign in Side}
    return {
        "file": results.scans[0].files[0],
        "files": [file for scan in results.scans for file in scan.files],
        "before_files": list(results.before_files),
        "points": sum(len(scan) for scan in results.scans) + sum(sum(scan.rejected.values()) for scan in results.scans),
        "used": used,
        "rejected": rejected,
        "other": other,
        "kind": results.scans[0].kind,
        "coverage": coverage,
    }


def _registration(results: Results) -> Json:
    registration = results.placed.registration
    std = np.sqrt(np.diag(registration.covariance))
    return {
        "rotation": results.pose.rotation.tolist(),
        "translation_mm": results.pose.translation.tolist(),
        "converged": registration.converged,
        "translation_std_um": [1e3 * v if seen else math.nan for v, seen in zip(std[:3], registration.observed[:3], strict=True)],
        "rotation_std_deg": [
            math.degrees(v) if seen else math.nan for v, seen in zip(std[3:], registration.observed[3:], strict=True)
        ],
        "rotation_std_at_base_circle_um": 1e3 * float(std[5]) * results.gear.base_radius,
        "covariance": registration.covariance.tolist(),
        "datum": list(registration.datum.surfaces),
        "worn_side": None if registration.datum.worn_side is None else str(registration.datum.worn_side),
        "offset_um": 1e3 * registration.offset,
        **seen_radii(results.placed, results.gear),
        "fitting_share": registration.fitting,
        "notes": list(registration.notes),
        "views": [
            {**_pose(view.registration), "points": view.points, "kept": view.kept, "offset_um": 1e3 * view.offset,
             "mismatch_um": 1e3 * view.mismatch}
            for view in results.placed.views
        ],
    }  # fmt: skip


def seen_radii(placed: PlacedScan, gear: Gear) -> Json:
    """What the scan itself shows of the gear's size, to hold against the design."""
    lands = rims(placed.measured, gear)
    return {
        "flank_base_radius_mm": base_radius(placed.located, gear),
        "tip_radius_mm": lands.tip_radius,
        "root_radius_mm": lands.root_radius,
    }


def _pose(registration: Registration) -> Json:
    return {
        "rotation": registration.pose.rotation.tolist(),
        "translation_mm": registration.pose.translation.tolist(),
        "converged": registration.converged,
    }


def _loop(results: Results) -> Json:
    loop, noise = results.loop, results.design.scanner.noise
    stated = {} if noise is None else {"noise_stated_um": 1e3 * noise}
    if loop is None:
        return {
            "sought": False,
            "note": "no effect was sought (--no-loop)",
            "noise_um": 1e3 * results.placed.registration.noise,
            **stated,
            "before": {"rms_um": _plain_rms(results), "heldout_rms_um": math.nan},
            "after": {"rms_um": math.nan, "heldout_rms_um": math.nan},
            "effects": [],
            "unexplained": {"found": False, "rms_um": 0.0, "pattern": "not sought"},
            "changes": {},
        }
    return {
        "sought": True,
        "noise_um": 1e3 * loop.noise,
        **stated,
        "texture_um": 1e3 * math.sqrt(loop.covariance.texture),
        "before": {"rms_um": 1e3 * loop.rms_before, "heldout_rms_um": 1e3 * loop.held_out_before},
        "after": {"rms_um": 1e3 * loop.rms_after, "heldout_rms_um": 1e3 * loop.held_out_after},
        "effects": [effect_record(effect) for effect in loop.effects if effect.kind is not Kind.WEAR],
        "unexplained": _unexplained(loop, results.gear),
        "changes": change_records(results.changes),
        "candidates_tried": loop.tried,
    }


def _plain_rms(results: Results) -> float:
    """RMS of cell means and scatter outside the wear, µm: what the loop would call before."""
    cells, wear = results.raw, results.wear
    grid = cells.grid
    outside = ~wear.mask
    parts = [grid.sides(values)[outside] for values in (cells.points.deviation, cells.scatter, cells.count)]
    deviation, scatter, count = (np.nan_to_num(part) for part in parts)
    return 1e3 * math.sqrt(float(((deviation**2 + scatter**2) * count).sum()) / max(float(count.sum()), 1.0))


def effect_record(effect: FoundEffect) -> Json:
    """One entry of `closed_loop` → `effects`."""
    evidence = effect.evidence
    return {
        "name": effect.name,
        "kind": effect.kind.value,
        "parameters": {
            name: {"value": _listed(item.value), "std": _listed(item.std), "unit": item.unit}
            for name, item in effect.parameters.items()
        },
        "alternatives": list(effect.alternatives),
        "tells_apart": effect.candidate.effect.tells_apart if effect.alternatives else None,
        "rms_before_um": 1e3 * effect.rms_before,
        "rms_after_um": 1e3 * effect.rms_after,
        "heldout_rms_before_um": 1e3 * effect.held_out_before,
        "heldout_rms_after_um": 1e3 * effect.held_out_after,
        "evidence": {
            "statistic": "F of the amplitudes under the residuals' own correlation",
            "value": evidence.statistic,
            "degrees_of_freedom": list(evidence.degrees),
            "effective_sample_size": evidence.effective_number,
            "p_value": evidence.p_value,
            "heldout_gain_um2": evidence.held_out_gain,
            "heldout_gain_std_error_um2": evidence.held_out_error,
            "contribution_rms_um": 1e3 * evidence.contribution,
        },
    }


def _listed(value: float | tuple[float, ...]) -> float | list[float]:
    return list(value) if isinstance(value, tuple) else value


def _unexplained(loop: Loop, gear: Gear) -> Json:
    if not loop.patterns:
        return {"found": False, "rms_um": 0.0, "pattern": None}
    rms = math.sqrt(sum(p.rms**2 for p in loop.patterns))
    return {
        "found": True,
        "rms_um": 1e3 * rms,
        "pattern": "; ".join(p.describe(gear.face_width) for p in loop.patterns),
        "patterns": [
            {
                "order": p.order, "sides": p.sides, "waves_across_face": p.waves_z, "waves_along_profile": p.waves_profile,
                "rms_um": 1e3 * p.rms, "peak_um": 1e3 * p.peak, "p_value": p.p_value,
            }
            for p in loop.patterns
        ],
        "treatment": "taken out as an empirical pattern, without a name, before wear is measured",
    }  # fmt: skip


def _wear(results: Results) -> Json:
    wear, planar = results.wear, results.planar
    size = "area_mm2" if planar else "volume_mm3"
    before = {size: _total(results.wear_before), "regions": len(results.wear_before.regions)}
    report: Json = {
        size: _total(wear),
        "before_loop": before if results.loop is not None else {size: _total(wear), "regions": len(wear.regions)},
        **_limits(wear),
        **({} if planar else {"lost_volume_mm3": dict(zip(("value", "std"), results.lost_volume, strict=True))}),
        "regions": [
            {
                "tooth": region.tooth + 1,
                "flank": str(region.side),
                size: {"value": region.volume, "std": region.volume_std},
                "max_depth_um": 1e3 * region.max_depth,
                "max_depth_std_um": 1e3 * region.max_depth_std,
                "mean_depth_um": 1e3 * region.mean_depth,
                **({} if planar else {"area_mm2": region.area}),
                "centroid_mm": region.centroid.tolist(),
                "patches": region.patches,
            }
            for region in wear.regions
        ],
        "laws": [
            {
                "name": law.name,
                "parameters": {"depth_um": {"value": 1e3 * law.depth, "std": 1e3 * law.std, "unit": "um"}},
                "flanks": str(law.side),
                "rms_before_um": 1e3 * law.rms_before,
                "rms_after_um": 1e3 * law.rms_after,
            }
            for law in results.laws
        ],
        "reference": "the unworn gear's scan" if results.before_files else "design and manufacture effects",
    }
    if results.solids is not None:
        report["solid"] = {"volume_mm3": results.solids.volume, "bodies": len(results.solids.bodies)}
    if results.boolean is not None:
        report["plain_boolean"] = {
            "removed_mm3": results.boolean.removed,
            "signed_difference_mm3": results.boolean.signed,
            "pieces": results.boolean.pieces,
            "note": "nominal minus the scan's own triangles: the removed volume is one-sided and holds scan noise; the signed difference does not",
        }
    return report


def _limits(wear: Wear) -> Json:
    """From what depth on wear would have shown: of the worst flank of which anything can be said, and of each."""
    worst, extent = wear.would_have_shown, "length_mm" if wear.planar else "area_mm2"
    return {
        "detection_limit_um": math.nan if worst is None else 1e3 * worst.depth,
        f"detection_{extent}": math.nan if worst is None else worst.area,
        "flanks": [
            {
                "tooth": one.tooth + 1,
                "flank": str(one.side),
                "detection_limit_um": 1e3 * one.depth,
                extent: one.area,
                "seen": one.seen,
            }
            for one in wear.flanks
        ],
    }


def _total(wear: Wear) -> Json:
    return {"value": wear.volume, "std": wear.volume_std}


def _thinnest(results: Results) -> Json | None:
    least = results.thickness.thinnest()
    if least is None:
        return None
    return {
        "tooth": least.tooth + 1,
        "value_mm": least.value,
        "std_mm": least.std,
        "low_mm": least.low,
        "high_mm": least.high,
        "at_z_mm": least.at_z,
    }


def _thickness(results: Results) -> list[Json]:
    return [
        {
            "tooth": tooth.tooth + 1,
            "nominal_mm": tooth.nominal,
            "mean_mm": tooth.mean,
            "min_mm": tooth.least,
            "loss_max_mm": tooth.greatest_loss,
            "at_z_mm": tooth.at_z,
            "std_mm": tooth.std,
            "min_std_mm": tooth.least_std,
            "loss_max_std_mm": tooth.loss_std,
        }
        for tooth in results.thickness.teeth()
    ]


def _meshing(results: Results, study: MeshingStudy) -> Json:
    pinion, gear = results.design.gears["pinion"], results.design.gears["gear"]
    paper, design, contact = study.published, study.design, study.contact
    centre = design.centre_distance
    greatest = backlash_from_normal(pinion, gear, centre, contact.backlash_max.value)
    least = backlash_from_normal(pinion, gear, centre, contact.backlash_min.value)

    def named(backlash: Any, suffix: str = "") -> Json:
        return {
            f"circumferential_mm{suffix}": backlash.circumferential,
            f"normal_mm{suffix}": backlash.normal,
            f"radial_mm{suffix}": backlash.radial,
            f"angular_pinion_deg{suffix}": math.degrees(backlash.angular_pinion),
            f"angular_gear_deg{suffix}": math.degrees(backlash.angular_gear),
        }

    ratio = contact.contact_ratio_on(design.path)
    stds: Json = {}
    if study.spread is not None:
        for suffix, std in (("_std", study.spread.backlash_greatest), ("_min_std", study.spread.backlash_least)):
            stds |= named(backlash_from_normal(pinion, gear, centre, std), suffix)
    report: Json = {
        "housing": "fixed at the design's centre distance",
        "paper": {
            "thickness_loss_mm": paper.thickness_loss,
            "backlash_mm": paper.backlash,
            "centre_distance_change_mm": paper.centre_distance_change,
            "centre_distance_mm": paper.centre_distance,
            "pressure_angle_deg": math.degrees(paper.pressure_angle),
            "pitch_radius_pinion_mm": paper.pitch_radius_pinion,
            "pitch_radius_gear_mm": paper.pitch_radius_gear,
            "contact_length_design_mm": paper.contact_length_design,
            "contact_length_worn_mm": paper.contact_length_worn,
            "baseline": paper.baseline.value,
        },
        "design": {
            "centre_distance_mm": centre,
            "working_pressure_angle_deg": math.degrees(design.working_pressure_angle),
            "pitch_radius_pinion_mm": design.pitch_radius_pinion,
            "pitch_radius_gear_mm": design.pitch_radius_gear,
            "backlash": named(design.backlash),
            "path_of_contact_mm": design.path.length,
            "contact_ratio": design.path.contact_ratio,
            "transmission_error_um": 0.0,
            "tip_clearance_pinion_mm": design.tip_clearance_pinion,
            "tip_clearance_gear_mm": design.tip_clearance_gear,
        },
        "worn": {
            "centre_distance_mm": centre,
            "working_pressure_angle_deg": math.degrees(design.working_pressure_angle),
            "backlash": {**named(greatest), **named(least, "_min"), **stds},
            "path_of_contact_mm": ratio * design.path.base_pitch,
            "contact_ratio": ratio,
            "contact_ratio_within": [{"tolerance_um": 1e3 * t, "contact_ratio": value} for t, value in contact.contact_ratio],
            "transmission_error_um": contact.peak_to_peak_um,
            "transmission_error_um_std": None if study.spread is None else 1e3 * study.spread.transmission_error,
            "transmission_error_lowest_um": 1e3 * contact.transmission_error_min.value,
            "backlash_max_at_deg": math.degrees(contact.backlash_max.rotation),
            "drive_flank": str(study.drive_side),
            "mate": "nominal",
        },
    }
    if study.law is not None:
        report["wear_law"] = wear_law_record(study.law)
    if study.shafts is not None:
        report["take_up"] = take_up_record(study.shafts)
    return report
