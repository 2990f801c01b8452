"""`report.json`: the contract's keys from a finished comparison. Millimetres become µm and radians degrees here and nowhere else."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import fields
from pathlib import Path

import numpy as np

import gearwear
from gearwear.comparison.consequences import Change
from gearwear.comparison.open_volume import Open, OpenVolume
from gearwear.comparison.results import PairResult, Results
from gearwear.comparison.weighed import WeighedLoss
from gearwear.design.gear import Gear
from gearwear.design.report_details import ReportDetails
from gearwear.design.side import Side
from gearwear.diagnose.found import FoundEffect
from gearwear.inspection.halves import Half
from gearwear.meshing.backlash import Backlash
from gearwear.meshing.published import PublishedMeshing
from gearwear.placing.end_edge import EndEdge, Places
from gearwear.placing.registration import Registration
from gearwear.placing.root import Root
from gearwear.placing.tip_edge import TipEdge
from gearwear.report.records.contact import contact_limits_record
from gearwear.report.records.inspection import as_dict
from gearwear.report.records.loaded import loaded_record
from gearwear.report.records.meshing import take_up_record
from gearwear.report.records.numbers import Json, parameters_record, value_std, value_std_unit
from gearwear.report.records.running import running_record
from gearwear.report.records.teeth import mark_record, pattern_values, same_teeth_record
from gearwear.report.records.unexplained import unexplained_record
from gearwear.report.records.views import view_record
from gearwear.report.records.wear_law import wear_law_record
from gearwear.report.words.lost import solid_words
from gearwear.report.words.verdict import doubts_of_design, grave_doubts, noise, weighed_words
from gearwear.wear.regions import Wear, WearRegion

SCHEMA = "gearwear.report/1"


def document(results: Results, files: Sequence[str] = (), command: str = "") -> Json:
    """Build the dict that is written as `report.json`.

    Parameters
    ----------
    results : Results
        A finished comparison.
    files : sequence of str
        What was written beside it.
    command : str
        How it was asked for; empty from Python.

    Returns
    -------
    dict
        Keys as in ``docs/report.md``; nan where something is not known (written as null).
    """
    return {
        "schema": SCHEMA,
        "version": gearwear.__version__,
        "command": command or None,
        "report": details_record(results.design.report),
        "design": _design(results),
        "scan": _scan(results),
        "registration": _registration(results),
        "closed_loop": _loop(results),
        "wear": _wear(results),
        "thickness": _thickness(results),
        "thinnest": _thinnest(results),
        "most_lost": _most_lost(results),
        "root": _root(results.measured.root),
        "tip_edge": _tip_edge(results.measured.tip_edge),
        "end_edge": _end_edge(results.measured.end_edge),
        "broken": [
            {
                "tooth": part.tooth + 1,
                "flank": part.flank,
                "kind": part.kind,
                "volume_mm3": value_std(part.volume, part.std),
                "seen": part.seen,
            }
            for part in results.measured.broken
        ],
        "meshing": None if results.pair is None else _meshing(results.pair),
        "inspection": None if results.inspection is None else as_dict(results.inspection),
        "inspection_halves": {str(half): as_dict(inspection) for half, inspection in zip(Half, results.halves, strict=True)}
        if results.halves
        else None,
        "doubtful": grave_doubts(results),
        "notes": [*doubts_of_design(results), *weighed_words(results.weighed), *solid_words(results), *results.notes],
        "files": list(files),
    }


def _weighed(weighed: WeighedLoss) -> Json:
    return {
        "lost_mass_g": weighed.mass,
        "volume_mm3": value_std(*weighed.weighed),
        "difference_mm3": value_std(weighed.difference, weighed.difference_std),
        "agrees": weighed.agrees,
    }


def details_record(details: ReportDetails) -> Json:
    """What was given to stand at the head of the report; null where nothing was."""
    stated = {field.name: getattr(details, field.name) or None for field in fields(details)}
    return stated | {"logo": Path(details.logo).name if details.logo else None}


def made_by() -> str:
    """Program and version."""
    return f"gearwear {gearwear.__version__}"


def _design(results: Results) -> Json:
    gear, spec = results.gear, results.gear.spec
    return {
        "source": results.design.source,
        "sha256": results.design.sha256 or None,
        "part": results.part,
        "teeth": gear.teeth,
        "module_mm": spec.normal_module,
        "pressure_angle_deg": math.degrees(spec.normal_pressure_angle),
        "helix_angle_deg": math.degrees(spec.helix_angle),
        "hand": spec.hand,
        **({"gap_mm": spec.gap} if spec.gap > 0.0 else {}),
        **({"internal": True} if spec.internal else {}),
        "normal_module_mm": spec.normal_module,
        "transverse_module_mm": gear.transverse_module,
        "transverse_pressure_angle_deg": math.degrees(gear.transverse_pressure_angle),
        "base_helix_angle_deg": math.degrees(gear.base_helix_angle),
        "profile_shift": spec.profile_shift,
        **({"thinning_mm": spec.thinning, "thinning_from": "measured"} if spec.thinning_measured else {}),
        "face_width_mm": gear.face_width,
        "reference_radius_mm": gear.reference_radius,
        "base_radius_mm": gear.base_radius,
        "tip_radius_mm": gear.tip_radius,
        "root_radius_mm": gear.root_radius,
        "form_radius_mm": gear.form_radius,
        "thickness_radius_mm": gear.thickness_radius,
        "tooth_thickness_mm": gear.tooth_thickness,
        "normal_tooth_thickness_mm": gear.normal_tooth_thickness,
        "undercut": gear.undercut,
        "section_area_mm2": gear.section_area(),
        "modifications": {str(side): _modification(gear, side) for side in Side},
        "warnings": list(results.design.warnings),
    }


def _modification(gear: Gear, side: Side) -> Json:
    """What the drawing modifies on one side, along the transverse base tangent, in the keys of the design file."""
    stated = gear.drawn(side).modification.stated
    return {name if isinstance(value, str) else f"{name}_mm": value for name, value in stated.items()}


def _scan(results: Results) -> Json:
    measured = results.measured
    return {
        "file": measured.scans[0].files[0],
        "files": [file for scan in measured.scans for file in scan.files],
        "sha256": [digest for scan in measured.scans for digest in scan.sha256],
        "before_files": list(results.before_files),
        "before_sha256": list(results.before_sha256),
        "mark": mark_record(measured.mark, measured.design.datum.mark),
        "before_teeth": same_teeth_record(results.same_teeth),
        "teeth_patterns": [
            {"name": pattern.name, "values": [pattern_values(tooth) for tooth in pattern.values]} for pattern in results.patterns
        ],
        "points": measured.points,
        "used": measured.used,
        "rejected": measured.rejected,
        "other": measured.other,
        "kind": measured.scans[0].kind,
        "coverage": measured.coverage,
    }


def _registration(results: Results) -> Json:
    placed, pose, seen = results.measured.placed, results.measured.pose, results.seen
    registration = placed.registration
    std = np.sqrt(np.diag(registration.covariance))
    return {
        "rotation": pose.rotation.tolist(),
        "translation_mm": pose.translation.tolist(),
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
        "flank_base_radius_mm": seen.base,
        "tip_radius_mm": seen.tip,
        "root_radius_mm": seen.root,
        "fitting_share": registration.fitting,
        "notes": list(registration.notes),
        "views": [
            {**_pose(view.registration), **view_record(view)}
            for view in placed.views
        ],
    }  # fmt: skip


def _root(root: Root) -> Json:
    """What was found of the root."""
    return {
        "seen": root.seen,
        "fits_design": root.fits_design,
        "free": root.free,
        "rack_tip_radius": root.rack_tip_radius,
        "dedendum": root.dedendum,
        "misfit_um": 1e3 * root.misfit,
        "design_misfit_um": 1e3 * root.design_misfit,
    }


def _depth_limits(open_: OpenVolume, region: WearRegion) -> Json:
    """Within what limits the deepest place lies, where more than its standard deviation is open."""
    limits = open_.depth_limits(region)
    return {} if limits is None else {"max_depth_low_um": 1e3 * limits[0], "max_depth_high_um": 1e3 * limits[1]}


def _tip_edge(edge: TipEdge) -> Json:
    """What was found of the edges between flanks and tips."""
    return {"fits_design": edge.fits_design, "height_mm": edge.height, "depth_um": 1e3 * edge.depth}


def _end_edge(edge: EndEdge) -> Json:
    """What was found of the edges at the ends of the face."""

    def ends(places: Places, unit: float) -> Json:
        return {
            end: {str(side): unit * values[side.index] for side in Side}
            for end, values in zip(("low", "high"), places, strict=True)
        }

    return {"fits_design": edge.fits_design, "reach_mm": ends(edge.reach, 1.0), "depth_um": ends(edge.depth, 1e3)}


def _pose(registration: Registration) -> Json:
    return {
        "rotation": registration.pose.rotation.tolist(),
        "translation_mm": registration.pose.translation.tolist(),
        "converged": registration.converged,
    }


def _loop(results: Results) -> Json:
    loop, stated = results.loop, results.design.scanner.noise
    record: Json = {"sought": loop is not None, "noise_um": 1e3 * noise(results)}
    if stated is not None:
        record["noise_stated_um"] = 1e3 * stated
    if loop is None:
        return record | {
            "note": "no effect was sought (--no-loop)",
            "before": {"rms_um": 1e3 * results.plain_rms, "heldout_rms_um": math.nan},
            "after": {"rms_um": math.nan, "heldout_rms_um": math.nan},
            "effects": [],
            "form": [],
            "undecided": [],
            "correlations": [],
            "unexplained": {"found": False, "rms_um": 0.0, "pattern": "not sought"},
            "changes": {},
            **running_record(results.pair),
        }
    return record | {
        "texture_um": 1e3 * math.sqrt(loop.covariance.texture),
        "before": {"rms_um": 1e3 * loop.rms_before, "heldout_rms_um": 1e3 * loop.held_out_before},
        "after": {"rms_um": 1e3 * loop.rms_after, "heldout_rms_um": 1e3 * loop.held_out_after},
        "effects": [effect_record(effect, results.open_sizes(effect)) for effect in results.effects],
        "form": [effect_record(level) for level in loop.form],
        "undecided": [[str(side) for side in sorted(sides, reverse=True)] for sides in loop.undecided],
        "correlations": [
            {"effects": list(pair.effects), "parameters": list(pair.parameters), "correlation": pair.value}
            for pair in loop.correlations
        ],
        "unexplained": unexplained_record(loop, results),
        "changes": change_records(results.changes),
        "candidates_tried": loop.tried,
        **running_record(results.pair),
    }


def change_records(changes: Iterable[Change]) -> Json:
    """`closed_loop` → `changes`."""
    return {
        change.name: {
            "before": change.before,
            "after": change.after,
            "difference": value_std(change.difference, change.std),
            "matters": change.matters,
            "as_made": change.as_made,
            "causes": [{"name": name, "change": size} for name, size in change.causes],
        }
        for change in changes
    }


def effect_record(effect: FoundEffect, limits: Mapping[str, tuple[float, float]] | None = None) -> Json:
    """One entry of `closed_loop` → `effects`; with limits beside sizes of which more is open than their standard deviation, by name."""
    evidence, parameters = effect.evidence, parameters_record(effect.parameters)
    for name, (low, high) in (limits or {}).items():
        parameters[name] |= {"low": low, "high": high, "range_from": str(Open.SIDES)}
    return {
        "name": effect.name,
        "kind": effect.kind.value,
        "parameters": parameters,
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


def _wear(results: Results) -> Json:
    wear, planar, unlooped = results.wear.found, results.planar, results.wear.before_loop
    open_ = results.open_volume
    below, above = open_.evenly
    size = "area_mm2" if planar else "volume_mm3"
    before = {size: _total(unlooped), "regions": len(unlooped.regions)}
    report: Json = {
        size: {**_total(wear), **_open(results)},
        "before_loop": before if results.loop is not None else {size: _total(wear), "regions": len(wear.regions)},
        **_limits(wear),
        **({} if planar else {"lost_volume_mm3": _lost(results)}),
        **({} if results.weighed is None else {"weighed": _weighed(results.weighed)}),
        "regions": [
            {
                "tooth": region.tooth + 1,
                "flank": str(region.side),
                size: value_std(region.volume, region.volume_std),
                "max_depth_um": 1e3 * region.max_depth,
                "max_depth_std_um": 1e3 * region.max_depth_std,
                **_depth_limits(open_, region),
                "mean_depth_um": 1e3 * region.mean_depth,
                **({} if planar else {"area_mm2": region.area}),
                "centroid_mm": region.centroid.tolist(),
                "patches": region.patches,
            }
            for region in wear.regions
        ],
        "evenly_um": {"below": 1e3 * below, "above": 1e3 * above},
        "burrs": [{"flanks": str(burr.side), "volume_mm3": value_std(burr.volume, burr.std)} for burr in wear.burrs],
        "active_face": [{"flanks": str(face.side), "low_mm": face.low, "high_mm": face.high} for face in results.measured.faces],
        "ridges": [
            {"flanks": str(ridge.side), "height_um": value_std(1e3 * ridge.height, 1e3 * ridge.std)} for ridge in wear.ridges
        ],
        "laws": [
            {
                "name": law.name,
                "parameters": {"depth_um": value_std_unit(1e3 * law.depth, 1e3 * law.std, "um")},
                "flanks": str(law.side),
                "rms_before_um": 1e3 * law.rms_before,
                "rms_after_um": 1e3 * law.rms_after,
            }
            for law in results.wear.laws
        ],
        "reference": "the unworn gear's scan" if results.before_files else "design and manufacture effects",
    }
    solids, boolean = results.wear.solids, results.wear.boolean
    if solids is not None:
        report["solid"] = {"volume_mm3": solids.volume, "bodies": len(solids.bodies)}
    if boolean is not None:
        report["plain_boolean"] = {
            "removed_mm3": boolean.removed, "signed_difference_mm3": boolean.signed, "pieces": boolean.pieces,
            "note": "nominal minus the scan's own triangles: the removed volume is one-sided and holds scan noise; the signed difference does not",
        }  # fmt: skip
    return report


def _limits(wear: Wear) -> Json:
    """From what depth on wear would have shown: of the worst flank of which anything can be said, and of each."""
    worst, extent = wear.would_have_shown, "length_mm" if wear.planar else "area_mm2"
    return {
        "detection_limit_um": math.nan if worst is None else 1e3 * worst.depth,
        f"detection_{extent}": math.nan if worst is None else worst.area,
        "flanks": [
            {
                "tooth": flank.tooth + 1,
                "flank": str(flank.side),
                "detection_limit_um": 1e3 * flank.depth,
                extent: flank.area,
                "seen": flank.seen,
            }
            for flank in wear.flanks
        ],
    }


def _open(results: Results) -> Json:
    """Limits beside a value, and why; nothing where it stands by itself."""
    if results.volume_range is None:
        return {}
    low, high, cause = results.volume_range
    return {"low": low, "high": high, "range_from": cause}


def _lost(results: Results) -> Json:
    """Worn and broken off: the limits are those of what is worn, beside what is broken off."""
    value, std = results.lost_volume
    limits = _open(results)
    broken = value - results.wear.volume
    return {**value_std(value, std), **limits, **{end: limits[end] + broken for end in ("low", "high") if limits}}


def _total(wear: Wear) -> Json:
    return value_std(wear.volume, wear.volume_std)


def _thinnest(results: Results) -> Json | None:
    least = results.wear.thickness.thinnest()
    if least is None:
        return None
    return {
        "tooth": least.tooth + 1,
        "value_mm": least.value,
        "std_mm": least.std,
        "low_mm": least.low,
        "high_mm": least.high,
        "at_z_mm": least.at_z,
        **({} if least.wider is None else {"range_from": str(least.wider)}),
    }


def _most_lost(results: Results) -> Json | None:
    most = results.wear.thickness.most_lost()
    if most is None:
        return None
    return {"tooth": most.tooth + 1, "value_mm": most.value, "std_mm": most.std, "at_z_mm": most.at_z}


def _thickness(results: Results) -> list[Json]:
    """Transverse arcs, and beside them the normal ones that drawings of helical gears state."""
    normal = math.cos(results.gear.helix_angle)
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
            "nominal_normal_mm": normal * tooth.nominal,
            "mean_normal_mm": normal * tooth.mean,
            "min_normal_mm": normal * tooth.least,
            "loss_max_normal_mm": normal * tooth.greatest_loss,
        }
        for tooth in results.wear.thickness.teeth()
    ]


def _backlash(backlash: Backlash, suffix: str = "") -> Json:
    helical = (
        {} if backlash.axial is None else {f"transverse_mm{suffix}": backlash.transverse, f"axial_mm{suffix}": backlash.axial}
    )
    return helical | {
        f"circumferential_mm{suffix}": backlash.circumferential,
        f"normal_mm{suffix}": backlash.normal,
        f"radial_mm{suffix}": backlash.radial,
        f"angular_pinion_deg{suffix}": math.degrees(backlash.angular_pinion),
        f"angular_gear_deg{suffix}": math.degrees(backlash.angular_gear),
    }


def _paper(paper: PublishedMeshing) -> Json:
    return {
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
    }


def _meshing(pair: PairResult) -> Json:
    design, contact, spread = pair.design, pair.contact, pair.spread
    play = _backlash(pair.greatest_backlash) | _backlash(pair.least_backlash, "_min")
    for std, suffix in ((pair.greatest_backlash_std, "_std"), (pair.least_backlash_std, "_min_std")):
        play |= {} if std is None else _backlash(std, suffix)
    if pair.open_backlash is not None:
        for (low, high), least in zip(pair.open_backlash, ("", "_min"), strict=True):
            play |= _backlash(low, f"{least}_low") | _backlash(high, f"{least}_high")
    report: Json = {
        "housing": "fixed at the design's centre distance",
        "paper": None if pair.published is None else _paper(pair.published),
        "design": {
            "centre_distance_mm": design.centre_distance,
            "working_pressure_angle_deg": math.degrees(design.working_pressure_angle),
            "pitch_radius_pinion_mm": design.pitch_radius_pinion,
            "pitch_radius_gear_mm": design.pitch_radius_gear,
            "backlash": _backlash(design.backlash),
            "path_of_contact_mm": design.path.length,
            "contact_ratio": design.path.total_contact_ratio,
            "overlap_ratio": design.path.overlap_ratio,
            "transmission_error_um": 1e3 * pair.transmission_error_as_drawn,
            "tip_clearance_pinion_mm": design.tip_clearance_pinion,
            "tip_clearance_gear_mm": design.tip_clearance_gear,
        },
        "worn": {
            "centre_distance_mm": design.centre_distance,
            "working_pressure_angle_deg": math.degrees(design.working_pressure_angle),
            "backlash": play,
            "path_of_contact_mm": pair.path_length,
            "contact_ratio": pair.contact_ratio,
            "contact_ratio_within": [{"tolerance_um": 1e3 * t, "contact_ratio": value} for t, value in contact.contact_ratio],
            "transmission_error_um": contact.peak_to_peak_um,
            "transmission_error_um_std": None if spread is None else 1e3 * spread.transmission_error,
            "transmission_error_lowest_um": 1e3 * contact.transmission_error_min.value,
            "backlash_max_at_deg": math.degrees(contact.backlash_max.rotation),
            "drive_flank": str(pair.drive_side),
            "mate": "nominal",
            **contact_limits_record(pair),
        },
    }
    if pair.loaded is not None:
        report["loaded"] = loaded_record(pair.loaded)
    if pair.law is not None:
        report["wear_law"] = wear_law_record(pair.law)
    if pair.shafts is not None:
        report["take_up"] = take_up_record(pair.shafts)
    return report
