"""A meshing study as files and on the terminal: JSON, tables over the rotation and the path, pictures, one screen of text."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from gearwear.design.quantity import listed, number, sentence, unbroken
from gearwear.loaded.study import LoadedStudy
from gearwear.meshing.shafts import ALIKE_BACKLASH, take_up_words
from gearwear.meshing.study import PairStudy, pair_words
from gearwear.report.figures.arrays import meshing_curves
from gearwear.report.files.writing import write_csv, write_json
from gearwear.report.records.meshing import sliding_records, study_record
from gearwear.report.words.clauses import wrapped
from gearwear.report.words.loaded import load_words, loaded_lines
from gearwear.report.words.wear_law import law_words
from gearwear.wear_law.study import WearStudy

SLIDING_PLACES = 41
"""Places on the path of contact in the table of sliding."""
DPI = 150
SCREEN, TAKE_UP_LINES = 22, 4
"""Lines of a terminal of 24 less two for the files; lines that what the shafts can take up has in any case, and more while the screen lasts."""


def write_study(folder: Path, study: PairStudy, loaded: LoadedStudy | None = None, law: WearStudy | None = None) -> list[str]:
    """Write ``meshing.json``, the tables over the rotation and along the path, and their pictures; the names."""
    files = ["meshing.json", "meshing.csv", "sliding.csv", "meshing.png", "path.png"]
    if loaded is not None:
        files.append("loaded.png")
        _write_loaded(folder / files[-1], study, loaded)
    write_json(folder / files[0], {**study_record(study, loaded, law), "files": files})
    _write_curves(folder / files[1], study)
    _write_sliding(folder / files[2], study)
    _write_pictures(folder / files[3], folder / files[4], study)
    return files


def _write_curves(path: Path, study: PairStudy) -> None:
    contact = study.contact
    lean = contact.driver.base_helix_cosine
    operating = math.cos(study.exact.working_pressure_angle) * lean
    reference = math.cos(contact.driver.transverse_pressure_angle) * lean
    head = (
        "rotation_deg", "transmission_error_um", "backlash_normal_mm", "backlash_circumferential_mm",
        "backlash_circumferential_reference_mm", "angular_backlash_pinion_deg", "pinion_tooth", "gear_tooth", "z_mm",
        "pinion_radius_mm", "gear_radius_mm",
    )  # fmt: skip
    positions = zip(
        np.degrees(contact.rotation - contact.rotation[0]), contact.transmission_error_um, contact.backlash,
        np.degrees(contact.angular_backlash_driver), contact.driver_tooth + 1, contact.driven_tooth + 1, study.heights,
        contact.driver_radius, contact.driven_radius, strict=True,
    )  # fmt: skip
    rows = (
        (f"{turn:.4f}", f"{error:z.4f}", *(f"{play / by:z.6f}" for by in (1.0, operating, reference)), f"{angle:z.6f}", pinion_tooth,
         gear_tooth, f"{z:z.3f}", f"{pinion_radius:.4f}", f"{gear_radius:.4f}")
        for turn, error, play, angle, pinion_tooth, gear_tooth, z, pinion_radius, gear_radius in positions
    )  # fmt: skip
    write_csv(path, head, rows)


def _write_sliding(path: Path, study: PairStudy) -> None:
    where = study.exact.path
    rolls = where.named_points
    between = np.linspace(where.start_pinion, where.end_pinion, SLIDING_PLACES)[1:-1]
    rows = sliding_records(study.sliding_rows({**rolls, **{f"{i}": float(roll) for i, roll in enumerate(between)}}))
    rows.sort(key=lambda row: float(row["pinion_roll_mm"]))
    cells = (
        [f"{value:z.6f}" if key != "point" else value if value in rolls else "" for key, value in row.items()] for row in rows
    )
    write_csv(path, rows[0], cells)


def _write_pictures(over_rotation: Path, along_path: Path, study: PairStudy) -> None:
    """Backlash and transmission error over the cycle; the pair in mesh and its sliding along the path."""
    from matplotlib import rc_context
    from matplotlib.figure import Figure

    from gearwear.report import figures

    contact, exact = study.contact, study.exact
    curves = meshing_curves(contact, exact)
    label = "worn" if study.worn.part else "in contact"
    with rc_context(figures.STYLE):
        figure = Figure(figsize=(9.0, 5.4))
        above, below = figure.subplots(2, 1, sharex=True)
        figure.subplots_adjust(left=0.105, right=0.985, top=0.9, bottom=0.09, hspace=0.32)
        figures.backlash(above, curves, label).set_xlabel("")
        figures.transmission_error(below, curves, label)
        figure.align_ylabels()
        figure.text(0.105, 0.965, f"{pair_words(study)}; {study.flank_words}", fontsize=9, fontweight="bold")
        figure.savefig(over_rotation, dpi=DPI, metadata={"Software": None})

        figure = Figure(figsize=(11.0, 5.6))
        figures.pair_in_mesh(figure.add_axes((0.055, 0.09, 0.44, 0.78)), study.pinion, study.gear, exact)
        above, below = figure.add_axes((0.57, 0.53, 0.415, 0.34)), figure.add_axes((0.57, 0.09, 0.415, 0.34))
        figures.specific_sliding(above, study.sliding, exact.path).set_xlabel("")
        figures.sliding_velocity(below, study.sliding, exact.path)
        text = f"{pair_words(study)}, as designed: path of contact {exact.path.length:.3f} mm, contact ratio {exact.path.total_contact_ratio:.3f}"
        figure.text(0.055, 0.955, text, fontsize=9, fontweight="bold")
        figure.savefig(along_path, dpi=DPI, metadata={"Software": None})


def _write_loaded(path: Path, study: PairStudy, loaded: LoadedStudy) -> None:
    """Transmission error under load, its spectrum, and the load over the flank."""
    from matplotlib import rc_context
    from matplotlib.figure import Figure

    from gearwear.report import figures

    with rc_context(figures.STYLE):
        figure = Figure(figsize=(9.0, 5.4))
        grid = figure.add_gridspec(2, 2, left=0.085, right=0.985, top=0.86, bottom=0.09, hspace=0.55, wspace=0.25)
        figures.loaded_transmission_error(figure.add_subplot(grid[0, :]), loaded)
        figures.mesh_spectrum(figure.add_subplot(grid[1, 0]), loaded)
        figures.load_map(figure.add_subplot(grid[1, 1]), loaded)
        said = f"{pair_words(study)}\n{study.flank_words}; {load_words(loaded)}"
        figure.text(0.085, 0.985, said, fontsize=9, fontweight="bold", va="top")
        figure.savefig(path, dpi=DPI, metadata={"Software": None})


def lines(study: PairStudy, loaded: LoadedStudy | None = None, law: WearStudy | None = None) -> list[tuple[str, str]]:
    """The study on one screen: at most 23 lines of at most 80 columns, each with its rich style; seven more under load."""
    exact, path, contact = study.exact, study.exact.path, study.contact
    play = exact.backlash
    hands = "" if study.pinion.twist == 0.0 else f"pinion {study.pinion.spec.hand} hand, gear {study.gear.spec.hand} hand; "
    carry = f"{study.drive_side} flanks carry"
    said = [(f"{pair_words(study)}; {carry}", "dim")] if not hands else [(pair_words(study), "dim"), (hands + carry, "dim")]

    def row(name: str, text: str) -> None:
        said.append((f"  {name:<22}{text}", ""))

    said.append(("As designed, mm", "bold"))
    angle = math.degrees(exact.working_pressure_angle)
    row("working angle", f"{angle:.4f}°, pitch radii {exact.pitch_radius_pinion:.4f} and {exact.pitch_radius_gear:.4f}")
    lengths = (play.circumferential, play.normal, play.radial)
    row("backlash", "circumferential {}, normal {}, radial {}".format(*(number(v, 4) for v in lengths)))
    angles = (math.degrees(play.angular_pinion), math.degrees(play.angular_gear))
    axial = "" if play.axial is None else f", axial {number(play.axial, 4)}"
    row("", "pinion {}°, gear {}°".format(*(number(v, 4) for v in angles)) + axial)
    row("path of contact", f"{path.length:.3f}, contact ratio {path.ratio_words()}")
    for part, active in study.active_profiles.items():
        alone = ", never one pair" if active.alone is None else ", one pair {:.3f} … {:.3f}".format(*(r for _, r in active.alone))
        shared = path.overlap_ratio > 0.0  # along the face: no matter of the radius
        row(f"{part}, radius", f"active {active.start[1]:.3f} … {active.end[1]:.3f}{'' if shared else alone}")
    slid = study.sliding_at(np.array([path.start_pinion, path.end_pinion]))
    ends = (*slid.specific_pinion, *slid.specific_gear)
    row("specific sliding", "start to end: pinion {} … {}, gear {} … {}".format(*(number(float(v), 2) for v in ends)))
    speeds = "{} … {}".format(*(number(float(v), 2) for v in slid.velocity))
    row("sliding velocity", f"start to end: {speeds} mm/s, pinion at 1 rad/s")
    row("tip clearance", f"pinion {exact.tip_clearance_pinion:z.4f}, gear {exact.tip_clearance_gear:z.4f}")

    said += [("", ""), *((text, "bold") for text in _contact_words(study))]
    lowest = 1e3 * contact.transmission_error_min.value
    row("transmission error", f"{number(contact.peak_to_peak_um, 1)} µm peak to peak, lowest {number(lowest, 1)} µm")
    least, most = study.least_backlash.circumferential, study.greatest_backlash.circumferential
    if most - least < ALIKE_BACKLASH:
        row("backlash", f"circumferential {number(most, 4)} mm in every position")
    else:
        at = math.degrees(contact.backlash_max.rotation)
        row("backlash", f"circumferential {number(least, 4)} … {number(most, 4)} mm, greatest at {at:.1f}°")
    pairs = listed(f"{value:z.3f} within {1e3 * t:g} µm" for t, value in contact.contact_ratio)
    row("contact ratio", f"{contact.contact_ratio_on(path):.3f}; pairs {pairs}")
    if loaded is not None:
        said.append((sentence(f"under load: {load_words(loaded)}").rstrip("."), "bold"))
        for name, text in loaded_lines(loaded):
            row(name, unbroken(text))
    notes = [(text, "yellow") for text in wrapped("! " + " ".join(map(sentence, study.notes)), 80, 3) if study.notes]
    if study.shafts is not None:
        room = max(SCREEN - len(said) - len(notes), TAKE_UP_LINES)
        said += [(text, "") for text in wrapped(take_up_words(study.shafts), 80, room)]
    if law is not None:
        said += [(text, "") for text in wrapped(law_words(law), 80, 6)]
    return said + notes


def _contact_words(study: PairStudy) -> list[str]:
    """What is in contact, a line for each gear that was measured."""
    said = [sentence(f"in contact: {study.worn.source}").rstrip(".")]
    return said if study.worn_mate is None else [*said, f"            {study.worn_mate.source}"]
