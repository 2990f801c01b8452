"""A meshing study as plain numbers: ``meshing.json``."""

from __future__ import annotations

import math

import numpy as np

from gearwear.loaded.study import LoadedStudy
from gearwear.meshing.backlash import Backlash
from gearwear.meshing.clearance import Interference
from gearwear.meshing.recommended import RecommendedBacklash
from gearwear.meshing.shafts import ShaftMovement, TakeUp
from gearwear.meshing.study import ActiveProfile, PairStudy, SlidingRow
from gearwear.meshing.worn_gear import WornGear
from gearwear.report.records.loaded import loaded_record
from gearwear.report.records.numbers import Json
from gearwear.report.records.wear_law import wear_law_record
from gearwear.wear_law.study import WearStudy

SCHEMA = "gearwear.meshing/1"


def study_record(study: PairStudy, loaded: LoadedStudy | None = None, law: WearStudy | None = None) -> Json:
    """Everything as plain numbers; mm, µm and degrees with the unit in the key, teeth counted from 1."""
    design = study.design
    record: Json = {
        "schema": SCHEMA,
        "design": {
            "source": design.source,
            **{
                part: {
                    "teeth": gear.teeth,
                    "module_mm": gear.spec.normal_module,
                    "profile_shift": gear.spec.profile_shift,
                    "helix_angle_deg": math.degrees(gear.spec.helix_angle),
                    "hand": gear.spec.hand,
                }
                for part, gear in design.gears.items()
            },
        },
        "exact": exact_record(study),
        "worn": _worn(study.worn),
        "contact": _contact(study),
        "notes": list(study.notes),
    }
    if study.worn_mate is not None:
        record["worn_mate"] = {**_worn(study.worn_mate), "mate_tooth": study.mate_tooth + 1}
    if study.shafts is not None:
        record["take_up"] = take_up_record(study.shafts)
    if loaded is not None:
        record["loaded"] = loaded_record(loaded)
    if law is not None:
        record["wear_law"] = wear_law_record(law)
    return record


def _worn(one: WornGear) -> Json:
    """What is worn of a gear."""
    return {
        "part": one.part,
        "source": one.source,
        "thickness_loss_mm": one.loss,
        "tooth": None if one.tooth is None else one.tooth + 1,
        "at_z_mm": one.z,
    }


def exact_record(study: PairStudy) -> Json:
    """The involute relations of the gears as designed."""
    exact, path, at, active = study.exact, study.exact.path, study.centre_distances, study.active_profiles
    return {
        "centre_distance_mm": exact.centre_distance,
        "working_pressure_angle_deg": math.degrees(exact.working_pressure_angle),
        "pitch_radius_pinion_mm": exact.pitch_radius_pinion,
        "pitch_radius_gear_mm": exact.pitch_radius_gear,
        "backlash": _backlash(exact.backlash),
        "recommended_backlash": _recommended(study.recommended),
        "zero_backlash_centre_distance_mm": at.zero_backlash,
        "bottoming_centre_distance_mm": at.bottoming,
        "interference_free_centre_distance_mm": at.interference_free,
        "path_of_contact_mm": path.length,
        "approach_mm": path.approach,
        "recess_mm": path.recess,
        "base_pitch_mm": path.base_pitch,
        "contact_ratio": path.total_contact_ratio,
        "transverse_contact_ratio": path.contact_ratio,
        "overlap_ratio": path.overlap_ratio,
        "pinion": _profile(active["pinion"]),
        "gear": _profile(active["gear"]),
        "sliding": sliding_records(study.sliding_rows(path.named_points)),
        "tip_clearance_pinion_mm": exact.tip_clearance_pinion,
        "tip_clearance_gear_mm": exact.tip_clearance_gear,
        "interference_pinion": _interference(exact.interference_pinion),
        "interference_gear": _interference(exact.interference_gear),
    }


def _backlash(one: Backlash) -> Json:
    return {
        "circumferential_mm": one.circumferential,
        "circumferential_reference_mm": one.circumferential_reference,
        "normal_mm": one.normal,
        "transverse_mm": one.transverse,
        "axial_mm": one.axial,
        "radial_mm": one.radial,
        "radial_closing_mm": one.radial_closing,
        "angular_pinion_deg": math.degrees(one.angular_pinion),
        "angular_gear_deg": math.degrees(one.angular_gear),
    }


def _recommended(advised: RecommendedBacklash) -> Json:
    return {
        "least_normal_mm": advised.least_normal,
        "least_source": "ISO/TR 10064-2 (agrees with one independent implementation)",
        "coarse_pitch_normal_mm": advised.coarse_pitch and list(advised.coarse_pitch),
        "coarse_pitch_source": "AGMA coarse-pitch range, as reprinted in handbooks",
        "assembly_mm": advised.assembly and list(advised.assembly),
        "assembly_source": "range for assembly by diametral pitch, of a handbook that was not read again",
    }


def _profile(one: ActiveProfile) -> Json:
    """Active profile of one gear."""
    return {
        "start_roll_mm": one.start[0], "start_radius_mm": one.start[1], "end_roll_mm": one.end[0], "end_radius_mm": one.end[1],
        "single_contact_roll_mm": None if one.alone is None else [roll for roll, _ in one.alone],
        "single_contact_radius_mm": None if one.alone is None else [radius for _, radius in one.alone],
        "start_set_by": one.start_set_by,
    }  # fmt: skip


def _interference(one: Interference) -> Json:
    return {
        "overrun_mm": one.overrun,
        "largest_mate_tip_radius_mm": one.largest_mate_tip_radius,
        "below_form_mm": one.below_form,
        "penetration_mm": one.penetration,
    }


def sliding_records(rows: list[SlidingRow]) -> list[Json]:
    """A row of the table of sliding per place, each with its name."""
    return [
        {
            "point": row.point,
            "pinion_roll_mm": float(row.motion.roll_pinion[0]),
            "pinion_radius_mm": row.radius_pinion,
            "gear_roll_mm": float(row.motion.roll_gear[0]),
            "gear_radius_mm": row.radius_gear,
            "sliding_velocity_mm_per_rad": float(row.motion.velocity[0]),
            "specific_sliding_pinion": float(row.motion.specific_pinion[0]),
            "specific_sliding_gear": float(row.motion.specific_gear[0]),
            "equivalent_radius_mm": float(row.motion.equivalent_radius[0]),
        }
        for row in rows
    ]


def _contact(study: PairStudy) -> Json:
    contact = study.contact
    ends = {
        "greatest": (study.greatest_backlash, contact.backlash_max.rotation),
        "least": (study.least_backlash, contact.backlash_min.rotation),
    }
    teeth, counts = np.unique(contact.driver_tooth, return_counts=True)
    return {
        "driver": "pinion",
        "drive_flank": str(study.drive_side),
        "cycle": study.cycle,
        "positions": len(contact.rotation),
        "transmission_error_um": contact.peak_to_peak_um,
        "transmission_error_lowest_um": 1e3 * contact.transmission_error_min.value,
        "transmission_error_lowest_at_deg": math.degrees(contact.transmission_error_min.rotation),
        "transmission_error_highest_um": 1e3 * contact.transmission_error_max.value,
        "backlash": {name: {**_backlash(play), "at_deg": math.degrees(rotation)} for name, (play, rotation) in ends.items()},
        "contact_ratio": contact.contact_ratio_on(study.exact.path),
        "contact_ratio_within": [{"tolerance_um": 1e3 * t, "contact_ratio": value} for t, value in contact.contact_ratio],
        "carries": [
            {"pinion_tooth": int(tooth) + 1, "share_of_positions": float(count) / len(contact.rotation)}
            for tooth, count in zip(teeth, counts, strict=True)
        ],
    }


def take_up_record(found: TakeUp) -> Json:
    """Taking up wear by moving the shafts.

    `tightest` and `loosest` are from the play of the flanks in contact; the keys beside them are for the greatest loss of
    thickness, taken to be on every tooth.
    """
    return {
        **_movement(found.alike),
        "wanted_normal_backlash_mm": found.alike.backlash,
        "bottoming_centre_distance_mm": found.alike.bottoming_centre_distance,
        "bottoming_loss_mm": found.alike.bottoming_loss,
        "closest_centre_distance_mm": found.alike.closest_centre_distance,
        "takeable_loss_mm": found.alike.takeable_loss,
        "tightest": _movement(found.tightest),
        "loosest": _movement(found.loosest),
        "jam_normal_mm": found.jam,
    }


def _movement(one: ShaftMovement) -> Json:
    return {
        "thickness_loss_mm": one.thickness_loss,
        "movement_mm": one.movement,
        "movement_linear_mm": one.movement_linear,
        "centre_distance_mm": one.centre_distance,
        "working_pressure_angle_deg": None if one.working_pressure_angle is None else math.degrees(one.working_pressure_angle),
        "feasible": one.feasible,
        "obstacles": list(one.obstacles),
    }
