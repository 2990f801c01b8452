"""A meshing study as plain numbers: ``meshing.json``."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from gearwear.arrays import Floats
from gearwear.design.gear import Gear
from gearwear.errors import InputError
from gearwear.meshing.backlash import Backlash, backlash_from_normal, zero_backlash_centre_distance
from gearwear.meshing.clearance import Interference, bottoming_centre_distance, interference_free_centre_distance
from gearwear.meshing.path import radius_at_roll, sliding
from gearwear.meshing.recommended import recommended_backlash
from gearwear.meshing.study import PairStudy
from gearwear.report.figures.meshing import named_points
from gearwear.report.words.shafts import take_up_record

SCHEMA = "gearwear.meshing/1"
Json = dict[str, Any]


def study_record(study: PairStudy) -> Json:
    """Everything as plain numbers; mm, µm and degrees with the unit in the key, teeth counted from 1."""
    design = study.design
    record: Json = {
        "schema": SCHEMA,
        "design": {
            "source": design.source,
            **{
                part: {"teeth": gear.teeth, "module_mm": gear.spec.normal_module, "profile_shift": gear.spec.profile_shift}
                for part, gear in design.gears.items()
            },
        },
        "exact": exact_record(study),
        "worn": {
            "part": study.worn.part,
            "source": study.worn.source,
            "thickness_loss_mm": study.worn.loss,
            "tooth": None if study.worn.tooth is None else study.worn.tooth + 1,
            "at_z_mm": study.worn.z,
        },
        "contact": _contact(study),
        "notes": list(study.notes),
    }
    if study.shafts is not None:
        record["take_up"] = take_up_record(study.shafts)
    return record


def exact_record(study: PairStudy) -> Json:
    """The involute relations of the gears as designed."""
    exact, path = study.exact, study.exact.path
    pinion, gear = study.design.gears["pinion"], study.design.gears["gear"]
    return {
        "centre_distance_mm": exact.centre_distance,
        "working_pressure_angle_deg": math.degrees(exact.working_pressure_angle),
        "pitch_radius_pinion_mm": exact.pitch_radius_pinion,
        "pitch_radius_gear_mm": exact.pitch_radius_gear,
        "backlash": _backlash(exact.backlash),
        "recommended_backlash": _recommended(pinion, gear, exact.centre_distance),
        "zero_backlash_centre_distance_mm": _zero_backlash(pinion, gear),
        "bottoming_centre_distance_mm": bottoming_centre_distance(pinion, gear),
        "interference_free_centre_distance_mm": interference_free_centre_distance(pinion, gear),
        "path_of_contact_mm": path.length,
        "approach_mm": path.approach,
        "recess_mm": path.recess,
        "base_pitch_mm": path.base_pitch,
        "contact_ratio": path.contact_ratio,
        "pinion": _profile(pinion, path.start_pinion, path.end_pinion, path.alone_pinion, path.limit_pinion),
        "gear": _profile(gear, path.start_gear, path.end_gear, path.alone_gear, path.limit_gear),
        "sliding": sliding_rows(study, named_points(path)),
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
        "radial_mm": one.radial,
        "radial_closing_mm": one.radial_closing,
        "angular_pinion_deg": math.degrees(one.angular_pinion),
        "angular_gear_deg": math.degrees(one.angular_gear),
    }


def _zero_backlash(pinion: Gear, gear: Gear) -> float | None:
    """None for teeth so thin that the base circles meet first."""
    try:
        return zero_backlash_centre_distance(pinion, gear)
    except InputError:
        return None


def _recommended(pinion: Gear, gear: Gear, centre_distance: float) -> Json:
    advised = recommended_backlash(pinion, gear, centre_distance)
    return {
        "least_normal_mm": advised.least_normal,
        "least_source": "ISO/TR 10064-2 (agrees with one independent implementation)",
        "coarse_pitch_normal_mm": advised.coarse_pitch and list(advised.coarse_pitch),
        "coarse_pitch_source": "AGMA coarse-pitch range, as reprinted in handbooks",
        "assembly_mm": advised.assembly and list(advised.assembly),
        "assembly_source": "range for assembly by diametral pitch, of a handbook that was not read again",
    }


def _profile(gear: Gear, start: float, end: float, alone: tuple[float, float] | None, limit: str) -> Json:
    """Active profile of one gear."""
    radius = radius_at_roll(gear, [start, end, *(alone or ())]).tolist()
    return {
        "start_roll_mm": start, "start_radius_mm": radius[0], "end_roll_mm": end, "end_radius_mm": radius[1],
        "single_contact_roll_mm": None if alone is None else list(alone),
        "single_contact_radius_mm": None if alone is None else radius[2:], "start_set_by": limit,
    }  # fmt: skip


def _interference(one: Interference) -> Json:
    return {
        "overrun_mm": one.overrun,
        "largest_mate_tip_radius_mm": one.largest_mate_tip_radius,
        "below_form_mm": one.below_form,
        "penetration_mm": one.penetration,
    }


def sliding_rows(study: PairStudy, rolls: dict[str, float]) -> list[Json]:
    """A row of the table of sliding per place, each with its name and its roll on the pinion (mm)."""
    pinion, gear = study.design.gears["pinion"], study.design.gears["gear"]
    roll = np.array(list(rolls.values()))
    found = sliding(pinion, gear, study.exact.centre_distance, roll)
    columns: dict[str, Floats] = {
        "pinion_roll_mm": found.roll_pinion, "pinion_radius_mm": radius_at_roll(pinion, found.roll_pinion),
        "gear_roll_mm": found.roll_gear, "gear_radius_mm": radius_at_roll(gear, found.roll_gear),
        "sliding_velocity_mm_per_rad": found.velocity, "specific_sliding_pinion": found.specific_pinion,
        "specific_sliding_gear": found.specific_gear, "equivalent_radius_mm": found.equivalent_radius,
    }  # fmt: skip
    return [{"point": name, **{key: float(value[i]) for key, value in columns.items()}} for i, name in enumerate(rolls)]


def _contact(study: PairStudy) -> Json:
    contact, centre = study.contact, study.exact.centre_distance
    pinion, gear = study.design.gears["pinion"], study.design.gears["gear"]
    ends = {"greatest": contact.backlash_max, "least": contact.backlash_min}
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
        "backlash": {
            name: {**_backlash(backlash_from_normal(pinion, gear, centre, one.value)), "at_deg": math.degrees(one.rotation)}
            for name, one in ends.items()
        },
        "contact_ratio": contact.contact_ratio_on(study.exact.path),
        "contact_ratio_within": [{"tolerance_um": 1e3 * t, "contact_ratio": value} for t, value in contact.contact_ratio],
        "carries": [
            {"pinion_tooth": int(tooth) + 1, "share_of_positions": float(count) / len(contact.rotation)}
            for tooth, count in zip(teeth, counts, strict=True)
        ],
    }
