"""``python -m gearwear.inspect [DESIGN.toml SCAN [SCAN …]]``: a scanned gear by ISO 1328-1, worn or new."""

from __future__ import annotations

import math
from argparse import Namespace
from collections.abc import Sequence
from typing import TYPE_CHECKING

from gearwear.commands.arguments import Parser, answer
from gearwear.commands.inputs import add_output_arguments, add_scan_arguments, design_and_scans
from gearwear.errors import InputError

if TYPE_CHECKING:
    from gearwear.design.gear import Gear
    from gearwear.diagnose.found import Loop
    from gearwear.inspection import Settings
    from gearwear.inspection.inspection import Inspection
    from gearwear.inspection.tolerances import Edition

DESCRIPTION = """\
Inspect a scanned gear by ISO 1328-1, worn or new: profile and helix deviations of
every flank, single and cumulative pitch, runout, tooth thickness, span, dimension
over pins; each with its uncertainty U (k = 2), the tolerance and the class, and
"not resolvable" where U is over 30 % of the tolerance. What the scanner added is
found by the closed loop and taken out first; what the maker left is measured.
Without arguments it inspects the bundled example.

Writes inspection.json, inspection.csv (the worst of every deviation),
inspection_flanks.csv (all flanks), inspection_teeth.csv (thickness, span, over pins
of every tooth), and the charts: inspection.pdf, and chart_profile.png,
chart_helix.png, chart_pitch.png, chart_topography.png.

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
    p.add_argument("--no-loop", action="store_true", help="do not look for what the scanner added, take the scan as it is")
    add_output_arguments(p)
    p.add_argument("--verbose", action="store_true", help="print the time each station took")
    return p


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command; 0 done, 2 an input or argument is wrong."""
    return answer(parser(), _run, argv)


def _run(arguments: Namespace) -> None:
    from gearwear.commands.progress import stations
    from gearwear.design.files.toml import read_design
    from gearwear.report.files.writing import check_folder, output_folder
    from gearwear.report.words.terminal import print_lines, written

    with design_and_scans(arguments) as (design_file, scans), stations(arguments.quiet, arguments.verbose) as tell:
        design = read_design(design_file)
        edition = _edition(arguments)
        check_folder(arguments.out)
        from gearwear.comparison.measured_gear import measure
        from gearwear.inspection import inspect
        from gearwear.report.files.inspection import inspection_record, lines, worst_tooth, write_inspection
        from gearwear.report.files.writing import finite
        from gearwear.report.records.comparison import seen_radii
        from gearwear.report.words.verdict import subject, wrong_design

        measured = measure(design, scans, arguments.part, arguments.units, not arguments.no_loop, progress=tell)
        teeth = _teeth(arguments.topography, measured.gear.teeth)
        tell("inspection")
        settings = _settings(arguments, measured.gear, edition, measured.noise)
        found = inspect(measured.flanks, measured.gear, settings)
        tell("charts")
        with output_folder(arguments.out) as stage:
            registration = measured.placed.registration
            gear = measured.gear
            drawn = {
                "base_radius_mm": gear.base_radius, "tip_radius_mm": gear.tip_radius, "root_radius_mm": gear.root_radius,
                "module_mm": gear.spec.normal_module,
            }  # fmt: skip
            doubt = wrong_design({"design": drawn, "registration": finite(seen_radii(measured.placed, gear))})
            notes = [*filter(None, [doubt, _unexplained(measured.loop, gear)]), *measured.notes]
            record = inspection_record(design, measured.part, measured.scans, registration, measured.loop, notes)
            files = write_inspection(stage, record, found, [worst_tooth(found)] if teeth is None else teeth)
    if not arguments.quiet:
        print_lines([*lines(found, subject(record), [*notes, *_not_seen(found)]), *written(arguments.out, files)])


def _edition(arguments: Namespace) -> Edition:
    """The edition, and whether it has the class that is asked for."""
    from gearwear.inspection.tolerances import CLASSES, Edition

    edition = Edition.ISO_2013 if arguments.edition == "2013" else Edition.ISO_1995
    classes = CLASSES[edition]
    if arguments.required is not None and arguments.required not in classes:
        raise InputError(f"--class {arguments.required}: {edition} has classes {classes[0]} to {classes[-1]}")
    return edition


def _settings(arguments: Namespace, gear: Gear, edition: Edition, noise: float) -> Settings:
    """What the options say, each checked against the gear."""
    from gearwear.inspection import Settings, class_k_bands, read_k_bands

    start = None
    if arguments.control_diameter is not None:
        low, high = 2.0 * gear.form_radius, 2.0 * math.hypot(gear.base_radius, gear.tip_roll)
        if not low <= arguments.control_diameter < high:
            raise InputError(
                f"--control-diameter {arguments.control_diameter:g}: the involute goes from {low:.3f} to {high:.3f} mm"
            )
        start = math.sqrt((0.5 * arguments.control_diameter) ** 2 - gear.base_radius**2)
    bands = None
    if arguments.k_band == "class":
        if arguments.required is None:
            raise InputError("--k-band class needs the class, as --class N")
        bands = class_k_bands(gear, arguments.required, edition, start)
    elif arguments.k_band is not None:
        bands = read_k_bands(arguments.k_band, gear)
    return Settings(
        edition,
        arguments.required,
        noise,
        control_roll=start,
        span_teeth=arguments.span_teeth,
        pin_diameter=arguments.pin_diameter,
        k_bands=bands,
    )


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


def _unexplained(loop: Loop | None, gear: Gear) -> str:
    """What no effect describes may be the scanner's or the maker's: it is not taken out."""
    if loop is None or not loop.patterns:
        return ""
    return f"left in is a pattern without a name: {'; '.join(one.describe(gear.face_width) for one in loop.patterns)}"


def _not_seen(found: Inspection) -> list[str]:
    return [note for note in found.notes if note.startswith(("Not seen", "The scan is too thin"))]
