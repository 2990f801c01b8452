"""A meshing study as files and on the terminal: JSON, tables over the rotation and the path, pictures, one screen of text."""

from __future__ import annotations

import csv
import math
import textwrap
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from gearwear.arrays import Floats
from gearwear.card import Card, Row
from gearwear.design.gear import Gear
from gearwear.design.pair import Design
from gearwear.meshing.backlash import Backlash, backlash_from_normal, zero_backlash_centre_distance
from gearwear.meshing.clearance import Interference, bottoming_centre_distance, interference_free_centre_distance
from gearwear.meshing.contact_result import ContactResult
from gearwear.meshing.exact import ExactMeshing
from gearwear.meshing.path import radius_at_roll, sliding
from gearwear.meshing.shafts import TakeUp
from gearwear.report.arrays import MeshingCurves
from gearwear.report.pair_figures import named_points
from gearwear.report.shafts import ALIKE, take_up_record, take_up_words
from gearwear.report.words import SPACE, listed, number, plural, sentence
from gearwear.report.writing import write_json

SCHEMA = "gearwear.meshing/1"
FLANK_NAME = {1: "left", -1: "right"}
SLIDING_PLACES = 41
"""Places on the path of contact in the table of sliding."""
DPI = 150
Json = dict[str, Any]


@dataclass(frozen=True, slots=True)
class WornGear:
    """What of the pair is worn, for a meshing study.

    Parameters
    ----------
    part : str or None
        "pinion" or "gear"; None where both are as designed.
    source : str
        The file, or what was assumed, in words.
    loss : float
        Greatest loss of tooth thickness, mm of arc at the reference circle.
    """

    part: str | None
    source: str
    loss: float


@dataclass(frozen=True, slots=True, repr=False)
class PairStudy(Card):
    """A pair in mesh.

    Parameters
    ----------
    design : Design
    exact : ExactMeshing
        Involute relations of the gears as designed.
    worn : WornGear
    contact : ContactResult
        The flanks as they are in rigid contact, the pinion driving.
    drive_side : int
        Flank that carries: +1 left, −1 right.
    cycle : str
        "revolution" or "hunting".
    shafts : TakeUp or None
        What taking up the wear by moving the shafts would need; None without wear.
    notes : tuple of str
        What is worth knowing, each a sentence.
    """

    design: Design
    exact: ExactMeshing
    worn: WornGear
    contact: ContactResult
    drive_side: int
    cycle: str
    shafts: TakeUp | None
    notes: tuple[str, ...]

    def headline(self) -> str:
        return f"{_pair(self)}; {self.worn.source}"

    def rows(self) -> list[Row]:
        path, contact = self.exact.path, self.contact
        low, high = contact.backlash_min.value, contact.backlash_max.value
        said = [
            ("design", f"contact ratio {path.contact_ratio:.4f}, normal backlash {number(self.exact.backlash.normal, 4)} mm"),
            (
                "worn" if self.worn.part else "in contact",
                f"transmission error {number(contact.peak_to_peak_um, 1)} µm peak to peak, normal backlash {number(low, 4)} … {number(high, 4)} mm",
            ),
        ]
        if self.shafts is not None:
            said.append(("shafts", take_up_words(take_up_record(self.shafts)).replace(SPACE, " ")))
        return said + [("note", sentence(note)) for note in self.notes]

    def to_dict(self) -> dict[str, Any]:
        """What ``meshing.json`` holds."""
        return study_record(self)


def write_study(folder: Path, study: PairStudy) -> list[str]:
    """Write ``meshing.json``, the tables over the rotation and along the path, and their pictures; the names."""
    files = ["meshing.json", "meshing.csv", "sliding.csv", "meshing.png", "path.png"]
    write_json(folder / files[0], {**study_record(study), "files": files})
    _write_curves(folder / files[1], study)
    _write_sliding(folder / files[2], study)
    _write_pictures(folder / files[3], folder / files[4], study)
    return files


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
        "exact": _exact(study),
        "worn": {"part": study.worn.part, "source": study.worn.source, "thickness_loss_mm": study.worn.loss},
        "contact": _contact(study),
        "notes": list(study.notes),
    }
    if study.shafts is not None:
        record["take_up"] = take_up_record(study.shafts)
    return record


def _exact(study: PairStudy) -> Json:
    exact, path = study.exact, study.exact.path
    pinion, gear = study.design.gears["pinion"], study.design.gears["gear"]
    return {
        "centre_distance_mm": exact.centre_distance,
        "working_pressure_angle_deg": math.degrees(exact.working_pressure_angle),
        "pitch_radius_pinion_mm": exact.pitch_radius_pinion,
        "pitch_radius_gear_mm": exact.pitch_radius_gear,
        "backlash": _backlash(exact.backlash),
        "zero_backlash_centre_distance_mm": zero_backlash_centre_distance(pinion, gear),
        "bottoming_centre_distance_mm": bottoming_centre_distance(pinion, gear),
        "interference_free_centre_distance_mm": interference_free_centre_distance(pinion, gear),
        "path_of_contact_mm": path.length,
        "approach_mm": path.approach,
        "recess_mm": path.recess,
        "base_pitch_mm": path.base_pitch,
        "contact_ratio": path.contact_ratio,
        "pinion": _profile(pinion, path.start_pinion, path.end_pinion, path.alone_pinion, path.limit_pinion),
        "gear": _profile(gear, path.start_gear, path.end_gear, path.alone_gear, path.limit_gear),
        "sliding": _sliding_rows(study, named_points(path)),
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


def _sliding_rows(study: PairStudy, rolls: dict[str, float]) -> list[Json]:
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
        "drive_flank": FLANK_NAME[study.drive_side],
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


def _write_curves(path: Path, study: PairStudy) -> None:
    contact = study.contact
    operating = math.cos(study.exact.working_pressure_angle)
    reference = math.cos(contact.driver.transverse_pressure_angle)
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(
            ["rotation_deg", "transmission_error_um", "backlash_normal_mm", "backlash_circumferential_mm",
             "backlash_circumferential_reference_mm", "angular_backlash_pinion_deg", "pinion_tooth", "gear_tooth", "z_mm",
             "pinion_radius_mm", "gear_radius_mm"]
        )  # fmt: skip
        columns = zip(
            np.degrees(contact.rotation - contact.rotation[0]), contact.transmission_error_um, contact.backlash,
            np.degrees(contact.angular_backlash_driver), contact.driver_tooth + 1, contact.driven_tooth + 1, contact.z,
            contact.driver_radius, contact.driven_radius, strict=True,
        )  # fmt: skip
        for turn, error, play, angle, one, two, z, r1, r2 in columns:
            writer.writerow(
                [f"{turn:.4f}", f"{error:.4f}", *(f"{play / by:.6f}" for by in (1.0, operating, reference)), f"{angle:.6f}", one, two,
                 f"{z:.3f}", f"{r1:.4f}", f"{r2:.4f}"]
            )  # fmt: skip


def _write_sliding(path: Path, study: PairStudy) -> None:
    where = study.exact.path
    rolls = named_points(where)
    between = np.linspace(where.start_pinion, where.end_pinion, SLIDING_PLACES)[1:-1]
    rows = _sliding_rows(study, {**rolls, **{f"{i}": float(roll) for i, roll in enumerate(between)}})
    rows.sort(key=lambda row: float(row["pinion_roll_mm"]))
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, list(rows[0]))
        writer.writeheader()
        for row in rows:
            numbers = {key: f"{value:.6f}" for key, value in row.items() if key != "point"}
            writer.writerow({"point": row["point"] if row["point"] in rolls else "", **numbers})


def _write_pictures(over_rotation: Path, along_path: Path, study: PairStudy) -> None:
    """Backlash and transmission error over the cycle; the pair in mesh and its sliding along the path."""
    from matplotlib import rc_context
    from matplotlib.figure import Figure

    from gearwear.report import figures

    contact, exact = study.contact, study.exact
    pinion, gear = study.design.gears["pinion"], study.design.gears["gear"]
    rotation = np.degrees(contact.rotation - contact.rotation[0])
    curves = MeshingCurves(
        rotation,
        contact.transmission_error_um,
        np.full(len(rotation), 1e3 * exact.backlash.circumferential),
        1e3 * contact.backlash / math.cos(exact.working_pressure_angle),
    )
    label = "worn" if study.worn.part else "in contact"
    with rc_context(figures.STYLE):
        figure = Figure(figsize=(9.0, 5.4))
        above, below = figure.subplots(2, 1, sharex=True)
        figure.subplots_adjust(left=0.105, right=0.985, top=0.9, bottom=0.09, hspace=0.32)
        figures.backlash(above, curves, label).set_xlabel("")
        figures.transmission_error(below, curves, label)
        figure.align_ylabels()
        figure.text(0.105, 0.965, f"{_pair(study)}; {study.worn.source}", fontsize=9, fontweight="bold")
        figure.savefig(over_rotation, dpi=DPI, metadata={"Software": None})

        figure = Figure(figsize=(11.0, 5.6))
        figures.pair_in_mesh(figure.add_axes((0.055, 0.09, 0.44, 0.78)), pinion, gear, exact)
        above, below = figure.add_axes((0.57, 0.53, 0.415, 0.34)), figure.add_axes((0.57, 0.09, 0.415, 0.34))
        figures.specific_sliding(above, pinion, gear, exact).set_xlabel("")
        figures.sliding_velocity(below, pinion, gear, exact)
        text = f"{_pair(study)}, as designed: path of contact {exact.path.length:.3f} mm, contact ratio {exact.path.contact_ratio:.3f}"
        figure.text(0.055, 0.955, text, fontsize=9, fontweight="bold")
        figure.savefig(along_path, dpi=DPI, metadata={"Software": None})


def _pair(study: PairStudy) -> str:
    one, two = study.design.gears["pinion"], study.design.gears["gear"]
    shifts = (one.spec.profile_shift, two.spec.profile_shift)
    shifted = f", x = {shifts[0]:g} / {shifts[1]:g}" if any(shifts) else ""
    centre = f"{study.exact.centre_distance:.4f}".rstrip("0").rstrip(".")
    return f"z = {one.teeth} / {two.teeth}, m = {one.spec.normal_module:g} mm{shifted}, a = {centre} mm"


def lines(study: PairStudy) -> list[tuple[str, str]]:
    """The study on one screen: at most 23 lines of at most 80 columns, each with its rich style."""
    exact, path, contact = study.exact, study.exact.path, study.contact
    pinion, gear = study.design.gears["pinion"], study.design.gears["gear"]
    play, record = exact.backlash, _exact(study)
    said = [(f"{_pair(study)}; pinion drives, {FLANK_NAME[study.drive_side]} flanks carry", "dim")]

    def row(name: str, text: str) -> None:
        said.append((f"  {name:<22}{text}", ""))

    said.append(("As designed, mm", "bold"))
    angle = math.degrees(exact.working_pressure_angle)
    row("working angle", f"{angle:.4f}°, pitch radii {exact.pitch_radius_pinion:.4f} and {exact.pitch_radius_gear:.4f}")
    lengths = (play.circumferential, play.normal, play.radial)
    row("backlash", "circumferential {}, normal {}, radial {}".format(*(number(v, 4) for v in lengths)))
    angles = (math.degrees(play.angular_pinion), math.degrees(play.angular_gear))
    row("", "pinion {}°, gear {}°".format(*(number(v, 4) for v in angles)))
    row("path of contact", f"{path.length:.3f}, contact ratio {path.contact_ratio:.4f}")
    for part in ("pinion", "gear"):
        active, alone = record[part], record[part]["single_contact_radius_mm"]
        alone = "never one pair alone" if alone is None else f"one pair alone {alone[0]:.3f} … {alone[1]:.3f}"
        row(f"{part}, radius", f"active {active['start_radius_mm']:.3f} … {active['end_radius_mm']:.3f}, {alone}")
    slid = sliding(pinion, gear, exact.centre_distance, [path.start_pinion, path.end_pinion])
    ends = (*slid.specific_pinion, *slid.specific_gear)
    row("specific sliding", "start to end: pinion {} … {}, gear {} … {}".format(*(number(float(v), 2) for v in ends)))
    speeds = "{} … {}".format(*(number(float(v), 2) for v in slid.velocity))
    row("sliding velocity", f"start to end: {speeds} mm/s at 1 rad/s of the pinion")
    row("tip clearance", f"pinion {exact.tip_clearance_pinion:.4f}, gear {exact.tip_clearance_gear:.4f}")

    said += [("", ""), (sentence(f"in contact: {study.worn.source}").rstrip("."), "bold")]
    lowest = 1e3 * contact.transmission_error_min.value
    row("transmission error", f"{number(contact.peak_to_peak_um, 1)} µm peak to peak, lowest {number(lowest, 1)} µm")
    least, most = (
        backlash_from_normal(pinion, gear, exact.centre_distance, one.value).circumferential
        for one in (contact.backlash_min, contact.backlash_max)
    )
    if most - least < ALIKE:
        row("backlash", f"circumferential {number(most, 4)} mm in every position")
    else:
        at = math.degrees(contact.backlash_max.rotation)
        row("backlash", f"circumferential {number(least, 4)} … {number(most, 4)} mm, greatest at {at:.1f}°")
    pairs = listed(f"{value:.3f} within {1e3 * t:g} µm" for t, value in contact.contact_ratio)
    row("contact ratio", f"{contact.contact_ratio_on(path):.3f}; pairs {pairs}")
    if study.shafts is not None:
        said += [(text, "") for text in _wrapped(take_up_words(take_up_record(study.shafts)), 4)]
    return said + [(text, "yellow") for text in _wrapped("! " + " ".join(map(sentence, study.notes)), 3) if study.notes]


def _wrapped(text: str, most: int) -> Sequence[str]:
    """At most so many lines; the JSON file has the whole."""
    return textwrap.wrap(text.replace(SPACE, "\u00a0"), 80, max_lines=most, placeholder=" …", break_on_hyphens=False)


def teeth_words(teeth: Sequence[int], count: int) -> str:
    """Which teeth, 0-based, in few words.

    >>> teeth_words([0, 1, 2], 3), teeth_words([4], 12), teeth_words([0, 2], 12)
    ('all 3 teeth', 'tooth 5', 'teeth 1 and 3')
    """
    if len(teeth) == count:
        return f"all {plural(count, 'tooth', 'teeth')}"
    return ("tooth " if len(teeth) == 1 else "teeth ") + listed(str(tooth + 1) for tooth in teeth)
