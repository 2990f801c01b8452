"""``gearwear inspect [DESIGN.toml SCAN [SCAN …]]``: a scanned gear by ISO 1328-1, worn or new."""

from __future__ import annotations

import math
from argparse import ArgumentTypeError, Namespace
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from gearwear.commands.arguments import Parser, answer
from gearwear.commands.inputs import (
    add_output_arguments,
    add_report_arguments,
    add_scan_arguments,
    design_and_scans,
    with_details,
)
from gearwear.errors import InputError

if TYPE_CHECKING:
    from gearwear.comparison.measured_gear import MeasuredGear
    from gearwear.design.gear import Gear
    from gearwear.design.pair import Design
    from gearwear.diagnose.found import Loop
    from gearwear.inspection import Settings
    from gearwear.inspection.halves import Half
    from gearwear.inspection.inspection import Inspection
    from gearwear.inspection.tolerances import Edition

DESCRIPTION = """\
Inspect a scanned gear by ISO 1328-1, worn or new: profile and helix deviations of
every flank, single and cumulative pitch, runout, tooth thickness, span, dimension
over pins; each with its uncertainty U (k = 2), the tolerance and the class, and
"not resolvable" where U is over 30 % of the tolerance. What the scanner added is
found by the closed loop and taken out first; what the maker left is measured.
Without arguments it inspects the bundled example.

Beside what is graded: traces along lines, every flank as a surface with its twist,
waves over all teeth, and rolling with a master gear.

Writes inspection.json, inspection.csv (the worst of every deviation),
inspection_flanks.csv (all flanks), inspection_teeth.csv (thickness, span, over pins
of every tooth), inspection_traces.csv (every point of every trace), and the charts:
inspection.pdf, and chart_profile.png, chart_helix.png, the same _middle (along lines),
chart_surfaces.png, chart_pitch.png, chart_topography.png.

Tolerances agree with independent implementations of the standard; the JSON file
says what is unconfirmed."""


def parser() -> Parser:
    """The command's arguments."""
    p = Parser("inspect", "[DESIGN.toml SCAN [SCAN …]]", DESCRIPTION)
    add_scan_arguments(p)
    p.add_argument(
        "--class", dest="required", type=int, metavar="N", help="class that the drawing asks for; left out: the class is found"
    )
    p.add_argument("--edition", choices=["2013", "1995"], default="2013", help="edition of ISO 1328-1, default %(default)s")
    p.add_argument(
        "--control-diameter",
        type=float,
        metavar="MM",
        help="profile control diameter d_Cf, where the profile evaluation begins; left out: the form diameter",
    )
    _add_range_arguments(p)
    p.add_argument(
        "--k-band",
        metavar="FILE.toml|class",
        help="limits that profiles and helices must run between: [profile] and [helix] with diameter_mm, roll_mm or roll_angle_deg "
        "(z_mm), lower_um and upper_um; or class: as wide as the total tolerances of --class",
    )
    p.add_argument("--pin-diameter", type=float, metavar="MM", help="of the pins or balls; left out: 1.728 modules, if that fits")
    p.add_argument(
        "--span-teeth", type=int, metavar="K", help="teeth to span; left out: those that touch nearest the reference circle"
    )
    p.add_argument(
        "--topography", metavar="TOOTH[,TOOTH…]|all", default="worst",
        help="teeth, counted from 1, whose topography is drawn in the PDF; left out: the worst",
    )  # fmt: skip
    p.add_argument(
        "--axis",
        choices=["teeth", "bore", "bands", "ends"],
        help="what pitch and runout are about (bore: of a ring its outside); left out: what [datum] says, else teeth",
    )
    p.add_argument(
        "--half",
        choices=["lower", "upper"],
        help="of a double helical gear, which is inspected half by half; left out: the lower",
    )
    p.add_argument("--no-loop", action="store_true", help="do not look for what the scanner added, take the scan as it is")
    add_output_arguments(p)
    add_report_arguments(p)
    p.add_argument("--verbose", action="store_true", help="print the time each station took")
    return p


def _add_range_arguments(p: Parser) -> None:
    """What the user of a gear measuring machine chooses: ranges, sections, filters, circles."""

    def length(name: str, words: str) -> None:
        p.add_argument(name, type=float, metavar="MM", help=words)

    def interval(name: str, words: str) -> None:
        p.add_argument(name, type=_interval, metavar="MM,MM", help=words)

    interval("--profile-roll-mm", "profile evaluation range in mm of roll length, first and last")
    interval("--profile-diameters-mm", "the same as diameters")
    length("--slope-length-mm", "roll length that f_Hα is stated over; left out: the evaluation range")
    length(
        "--profile-z-mm",
        "z in the design's frame, of a half in its own, of the section in which profiles are taken; left out: mean over the helix evaluation range",
    )
    length("--profile-half-width-mm", "half the width of that section, default 5 %% of the face width")
    length("--profile-cutoff-mm", "cut-off wavelength of the profile's filter")
    interval("--helix-z-mm", "helix evaluation range, z to z in the design's frame, of a half in its own")
    length("--helix-diameter-mm", "diameter at which helices are taken; left out: mean over the profile evaluation range")
    length(
        "--helix-half-width-mm",
        "half the width, in mm of roll length, of the band at that diameter, default 5 %% of the involute",
    )
    length("--helix-cutoff-mm", "cut-off wavelength of the helix's filter")
    length("--stylus-radius-mm", "profiles and helices as a stylus ball of this radius feels them (morphological closing)")
    length("--pitch-diameter-mm", "diameter at which pitch is measured; left out: tip diameter less two modules")
    interval("--pitch-z-mm", "z to z averaged for pitch, runout and thickness; left out: the helix evaluation range")


def _interval(text: str) -> tuple[float, float]:
    """Two numbers with a comma between, the smaller one first."""
    try:
        low, high = (float(part) for part in text.split(","))
    except ValueError:
        low, high = math.nan, math.nan
    if not -math.inf < low < high < math.inf:
        raise ArgumentTypeError(
            f"{text}: two numbers in mm with a comma between, the smaller one first, such as 1.5,12 would be right"
        )
    return low, high


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command; 0 done, 2 an input or argument is wrong."""
    return answer(parser(), _run, argv)


def _run(arguments: Namespace) -> None:
    from gearwear.commands.progress import stations
    from gearwear.design.files.toml import read_design
    from gearwear.report.files.writing import check_folder, output_folder
    from gearwear.report.words.terminal import print_lines, written

    with design_and_scans(arguments) as (design_file, scans), stations(arguments.quiet, arguments.verbose) as tell:
        design = with_details(read_design(design_file), arguments)
        edition = _edition(arguments)
        check_folder(arguments.out)
        _check_settings(arguments, design, edition)
        from gearwear.comparison.closing import measure
        from gearwear.placing.refusal import seen_radii
        from gearwear.report.files.inspection import dimension_lines, inspection_record, lines, worst_tooth, write_inspection
        from gearwear.report.words.other_design import other_angles, wrong_design
        from gearwear.report.words.verdict import subject

        measured = measure(design, scans, arguments.part, arguments.units, not arguments.no_loop, progress=tell)
        gear = measured.gear
        teeth = _teeth(arguments.topography, gear.teeth)
        tell("inspection")
        half = _half(arguments, gear)
        inspection, about_teeth = _inspected(arguments, measured, half, edition)
        tell("charts")
        seen, effects = seen_radii(measured.placed, gear), () if measured.loop is None else measured.loop.effects
        doubt = wrong_design(gear, seen, scale=measured.scale, drawn=design.gears[measured.part])
        angles = other_angles(gear, seen, effects, measured.scale)
        which = f"the {half} half of a double helical gear" if half is not None else ""
        left = (_taken_out(measured.loop), _unexplained(measured.loop, gear))
        notes = [*filter(None, [which, doubt, *angles, *left]), *measured.notes]
        registration, command = measured.placed.registration, arguments.command
        record = inspection_record(
            design, measured.part, measured.scans, registration, measured.loop, notes, command, about_teeth
        )

        def report(path: Path, files: Sequence[str]) -> None:
            from gearwear.report.page.inspection_view import inspection_view
            from gearwear.report.pdf import write_pdf

            about, dimensions = subject(measured.part, gear, measured.scans), dimension_lines(inspection)
            write_pdf(path, inspection_view(design, measured.scans, inspection, about, notes, dimensions, files, command))

        drawn = [worst_tooth(inspection)] if teeth is None else teeth
        with output_folder(arguments.out) as stage:
            files = write_inspection(stage, record, inspection, drawn, report if arguments.pdf else None)
    if not arguments.quiet:
        said = lines(inspection, subject(measured.part, gear, measured.scans, 80), [*notes, *inspection.foremost])
        print_lines([*said, *written(arguments.out, files)])


def _inspected(
    arguments: Namespace, measured: MeasuredGear, half: Half | None, edition: Edition
) -> tuple[Inspection, Inspection | None]:
    """The inspection that is asked for; and where it is about another axis than that of the teeth, the one about that."""
    from gearwear.comparison.bore import filled_in
    from gearwear.inspection.halves import half_gear, inspect_half

    nominal = measured.gear if half is None else half_gear(measured.gear, half)
    asked = _settings(arguments, nominal, edition)
    flanks, settings = filled_in(measured, asked)
    about_teeth = None
    if settings.axis != "teeth":
        on_teeth, beside = filled_in(measured, replace(asked, axis="teeth", laboratory=False))
        about_teeth = inspect_half(on_teeth, measured.gear, half, beside)
    return inspect_half(flanks, measured.gear, half, settings), about_teeth


def _half(arguments: Namespace, gear: Gear) -> Half | None:
    """The half that is inspected; None of a gear of one helix."""
    from gearwear.inspection.halves import Half, half_gear

    if arguments.half is None and gear.spec.gap == 0.0:
        return None
    half = Half(arguments.half or Half.LOWER)
    half_gear(gear, half)  # refuses a gear without
    return half


def _edition(arguments: Namespace) -> Edition:
    """The edition, and whether it has the class that is asked for."""
    from gearwear.inspection.tolerances import CLASSES, Edition

    edition = Edition.ISO_2013 if arguments.edition == "2013" else Edition.ISO_1995
    classes = CLASSES[edition]
    if arguments.required is not None and arguments.required not in classes:
        raise InputError(f"--class {arguments.required}: {edition} has classes {classes[0]} to {classes[-1]}")
    return edition


def _check_settings(arguments: Namespace, design: Design, edition: Edition) -> None:
    """Refuse, before a scan is read, what suits neither gear of the design."""
    from gearwear.inspection.halves import half_gear

    gears = [design.gears[arguments.part]] if arguments.part in design.gears else list(design.gears.values())
    wrong = []
    for gear in gears:
        try:
            _teeth(arguments.topography, gear.teeth)
            half = _half(arguments, gear)
            _settings(arguments, gear if half is None else half_gear(gear, half), edition)
        except InputError as error:
            wrong.append(error)
    if len(wrong) == len(gears):
        raise wrong[0]


def _ranges(arguments: Namespace, gear: Gear) -> Settings:
    """The ranges, sections and circles, each checked against the gear."""
    from gearwear.inspection import Settings
    from gearwear.inspection.stylus import check_ball

    check_ball(arguments.stylus_radius_mm, gear)
    first, last = _profile_range(arguments, gear)
    band, strip = _section_band(arguments, gear), _circle_strip(arguments, gear)
    return Settings(
        control_roll=first,
        profile_end=last,
        slope_length=_length("--slope-length-mm", arguments.slope_length_mm),
        helix_between=_on_face("--helix-z-mm", arguments.helix_z_mm, gear),
        profile_cutoff=_length("--profile-cutoff-mm", arguments.profile_cutoff_mm),
        helix_cutoff=_length("--helix-cutoff-mm", arguments.helix_cutoff_mm),
        stylus_radius=arguments.stylus_radius_mm,
        profile_band=band,
        helix_band=strip,
        pitch_roll=_roll_at("--pitch-diameter-mm", arguments.pitch_diameter_mm, gear),
        pitch_band=_on_face("--pitch-z-mm", arguments.pitch_z_mm, gear),
    )


def _length(name: str, value: float | None) -> float | None:
    """What is given must be a length."""
    from gearwear.design.quantity import as_given
    from gearwear.inspection.settings import LONGEST

    if value is not None and not 0.0 < value <= LONGEST:
        raise InputError(f"{name} {as_given(value)}: a length above 0 mm and at most {LONGEST:g} mm would be right")
    return value


def _roll_at(name: str, diameter: float | None, gear: Gear) -> float | None:
    """L of a circle on the involute, mm."""
    from gearwear.design.quantity import as_given, at_least, at_most

    if diameter is None:
        return None
    first, last = sorted(2.0 * math.hypot(gear.base_radius, value) for value in (gear.form_roll, gear.tip_roll))
    if not first <= diameter <= last:
        raise InputError(f"{name} {as_given(diameter)}: the involute goes from {at_least(first, 3)} to {at_most(last, 3)} mm")
    return math.sqrt(max(0.25 * diameter**2 - gear.base_radius**2, 0.0))


def _on_face(name: str, between: tuple[float, float] | None, gear: Gear) -> tuple[float, float] | None:
    """Two heights of the face."""
    from gearwear.design.quantity import as_given

    if between is not None and not 0.0 <= between[0] < between[1] <= gear.face_width:
        raise InputError(
            f"{name} {as_given(between[0])},{as_given(between[1])}: the face goes from 0 to {as_given(gear.face_width)} mm"
        )
    return between


def _profile_range(arguments: Namespace, gear: Gear) -> tuple[float | None, float | None]:
    """L where the profile evaluation begins and ends, from the root on, mm; None: not said."""
    from gearwear.design.quantity import as_given, at_least, at_most

    between, (low, high) = arguments.profile_roll_mm, sorted((gear.form_roll, gear.tip_roll))
    if between is not None and not (low <= between[0] and between[1] <= high):
        raise InputError(
            f"--profile-roll-mm {as_given(between[0])},{as_given(between[1])}: the involute goes from {at_least(low, 3)} to {at_most(high, 3)} mm of roll"
        )
    if arguments.profile_diameters_mm is not None:
        if between is not None:
            raise InputError("--profile-roll-mm and --profile-diameters-mm say the same: give one of them")
        between = [_roll_at("--profile-diameters-mm", diameter, gear) for diameter in arguments.profile_diameters_mm]
    first, last = (None, None) if between is None else between
    return (last, first) if gear.spec.internal else (first, last)


def _section_band(arguments: Namespace, gear: Gear) -> tuple[float, float] | None:
    """From z to z of the section in which profiles are taken, mm."""
    from gearwear.design.quantity import as_given

    section = arguments.profile_z_mm
    if section is None:
        if arguments.profile_half_width_mm is not None:
            raise InputError("--profile-half-width-mm needs the place of the section, as --profile-z-mm MM")
        return None
    half = _length("--profile-half-width-mm", arguments.profile_half_width_mm) or 0.05 * gear.face_width
    if not 0.0 <= section <= gear.face_width:
        raise InputError(f"--profile-z-mm {as_given(section)}: the face goes from 0 to {as_given(gear.face_width)} mm")
    return section - half, section + half


def _circle_strip(arguments: Namespace, gear: Gear) -> tuple[float, float] | None:
    """From L to L of the band in which helices are taken, mm."""
    circle = _roll_at("--helix-diameter-mm", arguments.helix_diameter_mm, gear)
    if circle is None:
        if arguments.helix_half_width_mm is not None:
            raise InputError("--helix-half-width-mm needs the place of the band, as --helix-diameter-mm MM")
        return None
    length = 0.05 * abs(gear.tip_roll - gear.form_roll)
    half = _length("--helix-half-width-mm", arguments.helix_half_width_mm) or length
    return circle - half, circle + half


def _settings(arguments: Namespace, gear: Gear, edition: Edition) -> Settings:
    """What the options say, each checked against the gear."""
    from gearwear.design.quantity import as_given, at_least, at_most
    from gearwear.inspection import class_k_bands, read_k_bands
    from gearwear.inspection.prepared import check_settings

    start = None
    if arguments.control_diameter is not None:
        low, high = sorted((2.0 * gear.form_radius, 2.0 * math.hypot(gear.base_radius, gear.tip_roll)))
        if not low <= arguments.control_diameter <= high:
            raise InputError(
                f"--control-diameter {as_given(arguments.control_diameter)}: the involute goes from {at_least(low, 3)} to {at_most(high, 3)} mm"
            )
        start = math.sqrt((0.5 * arguments.control_diameter) ** 2 - gear.base_radius**2)
    bands = None
    if arguments.k_band == "class" and arguments.required is None:
        raise InputError("--k-band class needs the class, as --class N")
    if arguments.k_band not in (None, "class"):
        bands = read_k_bands(arguments.k_band, gear)
    chosen = _ranges(arguments, gear)
    if start is not None and chosen.control_roll is not None:
        raise InputError("--control-diameter and a profile evaluation range both say where the profile begins: give one of them")
    settings = replace(
        chosen,
        edition=edition,
        required_class=arguments.required,
        control_roll=chosen.control_roll if start is None else start,
        span_teeth=arguments.span_teeth,
        pin_diameter=arguments.pin_diameter,
        k_bands=bands,
        laboratory=True,
        axis=arguments.axis,
    )
    check_settings(settings, gear)
    if arguments.k_band != "class":
        return settings
    where = (settings.control_roll, settings.profile_end, settings.helix_between)
    return replace(settings, k_bands=class_k_bands(gear, arguments.required, edition, *where))


def _teeth(text: str, count: int) -> list[int] | None:
    """0-based teeth whose topography is drawn; None for the worst."""
    if text == "worst":
        return None
    if text == "all":
        return list(range(count))
    try:
        teeth = [int(part) - 1 for part in text.split(",")]
    except ValueError:
        teeth = [-1]
    if not all(0 <= tooth < count for tooth in teeth):
        raise InputError(f"--topography {text}: teeth from 1 to {count}, such as 1,{count}, or all")
    return teeth


def _taken_out(loop: Loop | None) -> str:
    """What was taken out of the deviations as measurement's, with what it cannot be told from."""
    from gearwear.design.quantity import listed
    from gearwear.diagnose.effects.base import MEASURED
    from gearwear.report.words.effects import effect_words
    from gearwear.report.words.numbers import or_words

    effects = [effect for effect in (() if loop is None else loop.effects) if effect.kind in MEASURED]
    said = [effect_words(effect.name, effect.parameters) + or_words(effect.alternatives) for effect in effects]
    return f"taken out as the scanner's or the mounting's: {listed(said)}; --no-loop leaves it in" if said else ""


def _unexplained(loop: Loop | None, gear: Gear) -> str:
    """What no effect describes may be the scanner's or the maker's: it is not taken out."""
    if loop is None or not loop.patterns:
        return ""
    return f"left in is a pattern without a name: {'; '.join(pattern.describe(gear.face_width) for pattern in loop.patterns)}"
