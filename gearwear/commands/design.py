"""``gearwear design [SCAN]``: a design file from a few dimensions, or from the scan itself."""

from __future__ import annotations

import math
import sys
from argparse import Namespace
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from gearwear.commands.arguments import Parser, answer
from gearwear.commands.inputs import add_memory_argument
from gearwear.errors import InputError

if TYPE_CHECKING:
    from gearwear.design.gear import Gear
    from gearwear.design.spec import GearSpec
    from gearwear.identify.candidates import CandidateGear, SurfaceLeft
    from gearwear.identify.gauges import Gauge, Helix
    from gearwear.identify.proposal import Proposal
    from gearwear.identify.survey import Survey

DESCRIPTION = """\
Write a design file: from the tooth count and what a workshop measures (two
diameters, a span, a dimension over pins), or from the scan itself. Standard modules,
pressure angles and tooth depths are tried with profile shift and thinning; the best
is written as TOML, with what remains of every dimension and what else was near.
Check it against the drawing."""
NEAR = 10.0
"""Others are called near up to this cost above the best."""
NOTE = "Note: "
"""How a doubt begins in the head of the file."""
USUAL = (8.0, 2000.0)
"""Tip diameters, mm, beyond which the unit of a scan is asked after."""
TOLERANCE = 0.05
"""Standard deviation of a measured dimension, mm, where --tolerance says nothing."""

CLEAR = 10.0
"""Robust scatters of the points on the tips by which they must lie off the tip diameter first seen to say so."""
UNLIKE = 0.05
"""Modules of tip diameter up to which nothing is said of it: a coat, a chamfer, a tolerance."""


def parser() -> Parser:
    """The command's arguments."""
    p = Parser("design", "[SCAN]", DESCRIPTION)
    p.add_argument("scan", nargs="?", type=Path, metavar="SCAN", help="the scan; left out: the dimensions below")
    p.add_argument("--teeth", type=int, metavar="Z", help="tooth count")
    p.add_argument("--tip-diameter", type=float, metavar="D", help="over the tips")
    p.add_argument("--root-diameter", type=float, metavar="D", help="at the root")
    p.add_argument(
        "--span",
        nargs=2,
        action="append",
        default=[],
        metavar=("K", "W"),
        help="base tangent length W over K teeth; may be given twice",
    )
    p.add_argument(
        "--over-pins", nargs=2, action="append", default=[], metavar=("D", "M"), help="dimension M over pins of diameter D"
    )
    p.add_argument("--face-width", type=float, metavar="B", help="face width (of a scan: as seen)")
    p.add_argument("--bore", type=float, metavar="D", help="bore diameter (of a scan: as seen)")
    p.add_argument("--module", type=float, metavar="M", help="(normal) module in mm, where it is known")
    p.add_argument("--pressure-angle", type=float, metavar="DEG", help="pressure angle in degrees, where it is known")
    p.add_argument(
        "--helix-angle",
        type=float,
        metavar="DEG",
        help="helix angle in degrees, + right hand (of a scan: as seen); 0 is a spur gear",
    )
    p.add_argument("--tolerance", type=float, metavar="T", help=f"how well the dimensions are known (default {TOLERANCE} mm)")
    p.add_argument("--part", choices=["pinion", "gear"], default="gear", help="section of the file, default %(default)s")
    p.add_argument(
        "--units",
        choices=["mm", "cm", "m", "um", "in"],
        default="mm",
        help="unit of the scan or the dimensions, default %(default)s",
    )
    add_memory_argument(p)
    p.add_argument("--out", type=Path, metavar="FILE", help="write the design there; left out: print it")
    return p


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command; 0 done, 2 an input or argument is wrong."""
    return answer(parser(), _run, argv)


def _run(arguments: Namespace) -> None:
    from gearwear.identify.proposal import check_known

    check_known(arguments.module, _angle(arguments))
    text, headline = _from_scan(arguments) if arguments.scan is not None else _from_numbers(arguments)
    if arguments.out is None:
        sys.stdout.write(text)
    else:
        _write(arguments.out, text)
        sys.stdout.write(f"{headline}\n{arguments.out}\n")


def _write(file: Path, text: str) -> None:
    from gearwear.report.files.writing import write_file

    try:
        write_file(file, text)
    except (OSError, ValueError) as error:  # the latter of a NUL in its name
        why = getattr(error, "strerror", None) or error
        raise InputError(f"--out {file}: cannot be written to ({why}); the path of a file is needed") from None


def _angle(arguments: Namespace) -> float | None:
    if arguments.pressure_angle is None:
        return None
    if not 5.0 <= arguments.pressure_angle <= 45.0:
        raise InputError(f"--pressure-angle {arguments.pressure_angle:g}: from 5 to 45 degrees would be right")
    return math.radians(arguments.pressure_angle)


def _helix(arguments: Namespace) -> Helix | None:
    from gearwear.design.spec import MOST_HELIX_DEGREES
    from gearwear.identify.gauges import Helix

    if arguments.helix_angle is None:
        return None
    if not -MOST_HELIX_DEGREES <= arguments.helix_angle <= MOST_HELIX_DEGREES:
        raise InputError(
            f"--helix-angle {arguments.helix_angle:g}: from -{MOST_HELIX_DEGREES:g} to {MOST_HELIX_DEGREES:g} degrees would be right"
        )
    return Helix(math.radians(arguments.helix_angle))


def _from_numbers(arguments: Namespace) -> tuple[str, str]:
    """TOML and one line on it, from dimensions."""
    from gearwear.design.files.writing import design_text
    from gearwear.design.gear import Gear
    from gearwear.identify.gauges import SPUR, Gauge, Measured
    from gearwear.identify.proposal import propose, spec_of, tells_angle, tells_thickness
    from gearwear.scan.units import factor

    if arguments.teeth is None:
        raise InputError("--teeth is missing: the tooth count with at least one dimension, or a scan, is needed")
    tip, root = arguments.tip_diameter, arguments.root_diameter
    if tip is not None and root is not None and root >= tip:
        raise InputError(f"--root-diameter {root:g} is not below --tip-diameter {tip:g}: the other way round would be right")
    unit = factor(arguments.units)
    doubt = TOLERANCE if arguments.tolerance is None else arguments.tolerance * unit
    gauges = [
        Gauge(kind, Measured(value * unit, doubt))
        for kind, value in (("tip_diameter", arguments.tip_diameter), ("root_diameter", arguments.root_diameter))
        if value is not None
    ]
    gauges += [Gauge("span", Measured(_number("--span", w) * unit, doubt), _number("--span", k)) for k, w in arguments.span]
    gauges += [
        Gauge("over_pins", Measured(_number("--over-pins", m) * unit, doubt), _number("--over-pins", d) * unit)
        for d, m in arguments.over_pins
    ]
    width, bore = (None if value is None else round(value * unit, 9) for value in (arguments.face_width, arguments.bore))
    remarks = {}
    if width is None:
        width = 10.0
        remarks["face_width"] = "not given: put yours here"
    proposals = propose(arguments.teeth, gauges, arguments.module, _angle(arguments), helix=_helix(arguments) or SPUR)
    sound, reason = [], None
    for proposal in proposals:
        try:
            spec = spec_of(proposal, width, bore or 0.0, arguments.part)
            Gear.from_spec(spec)
        except InputError as error:
            reason = reason or error
            continue
        sound.append((proposal, spec))
    if not sound:
        raise InputError(f"no gear of these dimensions can be cut: {reason}")
    best, spec = sound[0]
    if not tells_angle(gauges) and arguments.pressure_angle is None:
        remarks["pressure_angle"] = "assumed: no dimension given depends on it; a span or a dimension over pins would tell"
    if not tells_thickness(gauges):
        remarks["thinning"] = "not known without a span or a dimension over pins"
    header = ["Proposed by gearwear design from measured dimensions: check it against the drawing.", best.name, ""]
    header += _remains(gauges, best) + _others(best, [proposal for proposal, _ in sound[1:]])
    header += _measured_thinning(spec)
    return design_text(spec, header, remarks), best.name


def _measured_thinning(spec: GearSpec) -> list[str]:
    """What to do about a thinning that was measured on the gear itself."""
    if not spec.thinning_measured:
        return []
    return [
        f"{NOTE}thinning is as the gear was measured, and an even loss of all its flanks looks the same: thinning_from says so, and what the",
        "teeth may have lost to be so thin is in the range that compare tells. If the drawing has it, or a tooth that never ran is measured:",
        "put that value there and leave thinning_from out.",
    ]


def _number(option: str, text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise InputError(f"{option} {text}: two numbers would be right") from None


def _remains(gauges: Sequence[Gauge], proposal: Proposal) -> list[str]:
    lines = ["What remains (measured − proposed):"]
    for gauge, residual in zip(gauges, proposal.residuals, strict=True):
        lines.append(f"  {gauge.name:<40}{gauge.length.value:>11.4f} mm{1e3 * residual:>+z9.0f} µm")
    return lines


def _others(best: Proposal, others: Sequence[Proposal]) -> list[str]:
    near = [proposal for proposal in others if proposal.cost < best.cost + NEAR]
    if not near:
        return ["Nothing else in use comes near."]
    lines = ["Also near; the number says how much less likely, of which 6 is strong evidence:"]
    if any(proposal.cost < best.cost for proposal in near):
        lines[0] = f"{lines[0][:-1]}; below 0 by the dimensions alone, the scan fits worse:"
    for proposal in near:
        residuals = ", ".join(f"{1e3 * residual:+z.0f}" for residual in proposal.residuals)
        lines.append(f"  {proposal.cost - best.cost:+5.1f}  {proposal.name}; remains {residuals} µm")
    return lines


def _told(proposal: Proposal, seen: Survey) -> list[str]:
    """What the scan tells of module, angle and shift, and what it does not."""
    from gearwear.identify.candidates import base_pitch_doubt
    from gearwear.identify.survey import PROFILE_SLOPE

    base_cosine = math.cos(math.asin(math.sin(proposal.helix_angle) * math.cos(proposal.pressure_angle)))
    pitch = math.pi * proposal.module.mm * math.cos(proposal.pressure_angle) / base_cosine
    return [
        f"Base pitch seen {seen.base_pitch:.4f} ± {base_pitch_doubt(seen):.4f} mm, proposed {pitch:.4f} mm: a profile slope of "
        f"{1e3 * PROFILE_SLOPE:.0f} µm over the {seen.flank.roll:.2f} mm of roll",
        "that were seen looks like another base circle. The base pitch fixes module · cos(pressure angle) alone; what tells the two",
        "apart is which are in use, and tip, root and thickness. The profile shift is known to "
        f"± {proposal.shift_std:.2g} by them; a round one is preferred.",
    ]


def _tips(gear: Gear, first: float, left: Sequence[SurfaceLeft]) -> list[str]:
    """A doubt where the tips as they lie on the proposed gear are not those that the survey took for them, at diameter `first`, mm.

    A deviation is outwards from the metal: of a ring, whose tips point inwards, it makes the tip diameter smaller.
    """
    for tip in (surface for surface in left if surface.surface == "tip"):
        located = 2.0 * (gear.tip_radius + gear.orientation * tip.median)
        if abs(located - first) > max(CLEAR * tip.scatter, UNLIKE * gear.normal_module):
            better = gear.spec.addendum + tip.median / gear.normal_module
            return [
                f"{NOTE}points on the tips lie at diameter {located:.3f} mm on this gear, not at {first:.3f} mm as first seen; addendum = {better:.3f}",
                "would reach them: check the tip diameter on the part.",
            ]
    return []


def _from_scan(arguments: Namespace) -> tuple[str, str]:
    """TOML and one line on it, from a scan."""
    dimensions = ("tip_diameter", "root_diameter", "span", "over_pins", "tolerance")
    for name in dimensions:
        if getattr(arguments, name) not in (None, []):  # 0 was given too
            raise InputError(
                f"--{name.replace('_', '-')} beside a scan: the scan is measured itself; one of the two would be right"
            )
    from gearwear.design.files.writing import design_text
    from gearwear.identify.candidates import find_candidates
    from gearwear.scan.reading import read_one
    from gearwear.scan.units import factor

    scan = read_one(arguments.scan, arguments.units)
    unit = factor(arguments.units)
    planar = scan.planar
    try:
        candidates = find_candidates(
            scan.points, scan.normals, planar, arguments.module, _angle(arguments), arguments.teeth,
            None if arguments.face_width is None else arguments.face_width * unit, arguments.part, _helix(arguments),
            None if arguments.bore is None else arguments.bore * unit,
        )  # fmt: skip
    except InputError as error:
        raise InputError(f"{arguments.scan}: {error}") from None
    best, seen = candidates.ranked[0], candidates.survey
    header = [f"Proposed by gearwear design from {arguments.scan.name}: check it against the drawing.", best.proposal.name, ""]
    header += _remains(candidates.gauges, best.proposal)
    header += _told(best.proposal, seen)
    header += ["Left on the scan, fitted to it (median and scatter of the deviations):"]
    header += [f"  {surface.surface:<40}{1e3 * surface.median:>+z9.1f} ± {1e3 * surface.scatter:.1f} µm" for surface in best.left]
    tips, doubts = _tips(best.gear, 2.0 * seen.tip_radius, best.left), _doubts(seen, best)
    header += tips
    header += _others(best.proposal, [candidate.proposal for candidate in candidates.ranked[1:]])
    header += doubts
    header += _measured_thinning(best.gear.spec)
    text = design_text(best.gear.spec, header, _remarks(arguments, seen, best))
    return text, "\n".join([f"{seen.teeth} teeth, {best.proposal.name}", *_warned([*tips, *doubts])])


def _warned(notes: Sequence[str]) -> list[str]:
    """Notes of the file, of which each begins with `NOTE`, as warnings for the terminal."""
    from gearwear.design.quantity import sentence
    from gearwear.report.words.clauses import wrapped

    return [line for note in " ".join(notes).split(NOTE)[1:] for line in wrapped(f"! {sentence(note.strip())}", 80, 9)]


def _remarks(arguments: Namespace, seen: Survey, best: CandidateGear) -> dict[str, str]:
    """What stands behind the values of the file: what was seen in place of what is written."""
    from gearwear.design.standards import diametral_pitch, inch_words
    from gearwear.identify.candidates import UNKNOWN_WIDTH

    remarks = {"rack_tip_radius": "of those in use, the one whose root fits best", "teeth": ""}
    if len(seen.halves) > 1:
        remarks |= {"helix_angle": "of the half at z = 0", "gap": f"{seen.gap:.3f} mm seen"}
    if arguments.face_width is None:
        if math.isfinite(seen.face_width):
            inches = inch_words(best.gear.face_width) if diametral_pitch(best.gear.normal_module) is not None else None
            width_words = f"{seen.face_width:.3f} mm seen" + ("" if seen.faces == 2 else ", without both end faces")
            remarks["face_width"] = "; ".join(filter(None, [inches, width_words]))
        else:
            remarks["face_width"] = f"a section does not show it; {UNKNOWN_WIDTH:g} stands for any"
    if best.gear.spec.bore_diameter and arguments.bore is None:
        remarks["bore_diameter"] = f"{seen.bore_diameter:.3f} mm seen"
    if best.proposal.thinning:
        remarks["thinning"] = "wear of all flanks would look the same"
    return remarks


def _doubts(seen: Survey, best: CandidateGear) -> list[str]:
    """What the reader must know of the scan before he believes the file."""
    from gearwear.identify.survey import DOUBTFUL

    said = [f"{NOTE}{note}." for note in seen.notes]
    pitch = 2.0 * math.pi * seen.tip_radius / seen.teeth
    if best.scatter > DOUBTFUL * pitch:
        said += [
            f"{NOTE}the flanks scatter by {1e3 * best.scatter:.0f} µm about the best of these, {100 * best.scatter / pitch:.1f} % of the pitch:",
            "all teeth are worn, or another axis, tooth count or helix angle is the right one.",
        ]
    if seen.internal:
        said += [
            f"{NOTE}a scan does not tell the cutter. None is written, and fillets and roots are no datum; cutter_teeth with",
            "cutter_tip_radius, or fillet_radius, of the drawing make them one.",
        ]
        if not seen.rim_diameter:
            said.append(f"{NOTE}the outside was not seen: rim_diameter, which a comparison needs, gives the ring a volume.")
    if not USUAL[0] < 2.0 * seen.tip_radius < USUAL[1]:
        said.append(f"{NOTE}{2.0 * seen.tip_radius:.3g} mm over the tips is unusual: --units says what the scan is in.")
    return said
