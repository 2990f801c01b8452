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


def _worn(worn: WornGear) -> Json:
    """What is worn of a gear."""
    return {
        "part": worn.part,
        "source": worn.source,
        "thickness_loss_mm": worn.loss,
        "tooth": None if worn.tooth is None else worn.tooth + 1,
        "at_z_mm": worn.z,
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


def _backlash(backlash: Backlash) -> Json:
    return {
        "circumferential_mm": backlash.circumferential,
        "circumferential_reference_mm": backlash.circumferential_reference,
        "normal_mm": backlash.normal,
        "transverse_mm": backlash.transverse,
        "axial_mm": backlash.axial,
        "radial_mm": backlash.radial,
        "radial_closing_mm": backlash.radial_closing,
        "angular_pinion_deg": math.degrees(backlash.angular_pinion),
        "angular_gear_deg": math.degrees(backlash.angular_gear),
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


def _profile(active: ActiveProfile) -> Json:
    """Active profile of one gear."""
    return {
        "start_roll_mm": active.start[0], "start_radius_mm": active.start[1], "end_roll_mm": active.end[0], "end_radius_mm": active.end[1],
        "single_contact_roll_mm": None if active.alone is None else [roll for roll, _ in active.alone],
        "single_contact_radius_mm": None if active.alone is None else [radius for _, radius in active.alone],
        "start_set_by": active.start_set_by,
    }  # fmt: skip


def _interference(interference: Interference) -> Json:
    return {
        "overrun_mm": interference.overrun,
        "largest_mate_tip_radius_mm": interference.largest_mate_tip_radius,
        "below_form_mm": interference.below_form,
        "penetration_mm": interference.penetration,
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


def take_up_record(take_up: TakeUp) -> Json:
    """Taking up wear by moving the shafts.

    `tightest` and `loosest` are from the play of the flanks in contact; the keys beside them are for the greatest loss of
    thickness, taken to be on every tooth.
    """
    return {
        **_movement(take_up.alike),
        "wanted_normal_backlash_mm": take_up.alike.backlash,
        "bottoming_centre_distance_mm": take_up.alike.bottoming_centre_distance,
        "bottoming_loss_mm": take_up.alike.bottoming_loss,
        "closest_centre_distance_mm": take_up.alike.closest_centre_distance,
        "takeable_loss_mm": take_up.alike.takeable_loss,
        "tightest": _movement(take_up.tightest),
        "loosest": _movement(take_up.loosest),
        "jam_normal_mm": take_up.jam,
    }


def _movement(shafts: ShaftMovement) -> Json:
    return {
        "thickness_loss_mm": shafts.thickness_loss,
        "movement_mm": shafts.movement,
        "movement_linear_mm": shafts.movement_linear,
        "centre_distance_mm": shafts.centre_distance,
        "working_pressure_angle_deg": None
        if shafts.working_pressure_angle is None
        else math.degrees(shafts.working_pressure_angle),
        "feasible": shafts.feasible,
        "obstacles": list(shafts.obstacles),
    }
