"""``gearwear meshing [DESIGN.toml]``: a pair in mesh, as designed by the exact relations and worn in rigid contact."""

from __future__ import annotations

import math
from argparse import Namespace
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from gearwear.arguments import Parser, answer
from gearwear.errors import InputError
from gearwear.inputs import add_output_arguments, bundled_example

if TYPE_CHECKING:
    from gearwear.design.gear import Gear
    from gearwear.design.pair import Design
    from gearwear.design.profiles import ToothProfiles
    from gearwear.meshing.exact import ExactMeshing
    from gearwear.report.meshing import PairStudy, WornGear

DESCRIPTION = """\
What a pair does in mesh. As designed, by the exact involute relations: every kind of
backlash, the path of contact with its start and end on both profiles, single
contact, contact ratio, sliding, tip clearance, interference. In rigid contact over
a revolution or the whole hunting cycle: transmission error and backlash, with a gear
worn by a uniform loss (--loss) or as compare measured it (--wear); without either
both are as designed. Left out, the design is that of the bundled example.

Writes meshing.json, meshing.csv (over the rotation), sliding.csv and meshing.png."""

RADII, POSITIONS = 200, 34
"""Radii of a nominal profile; positions per pitch, as in compare."""


def parser() -> Parser:
    """The command's arguments."""
    p = Parser("meshing", "[DESIGN.toml]", DESCRIPTION)
    p.add_argument("design", nargs="?", type=Path, metavar="DESIGN.toml", help="the design: a pair")
    p.add_argument(
        "--wear", type=Path, metavar="DIR", help="a gear as it is: the folder that compare wrote to, or its worn_profiles.npz"
    )
    p.add_argument("--loss", type=float, metavar="MM", help="a uniform loss, normal to the flank, on the flanks that carry")
    p.add_argument("--teeth", metavar="TOOTH[,TOOTH…]|all", help="teeth with the loss, counted from 1; left out: all")
    p.add_argument("--part", choices=["pinion", "gear"], help="which one has the loss; left out: the pinion")
    p.add_argument("--centre-distance", type=float, metavar="MM", help="in place of the design's")
    p.add_argument(
        "--drive",
        choices=["left", "right"],
        help="flanks that carry, the pinion driving; left out: the more worn ones, else left",
    )
    p.add_argument(
        "--cycle", choices=["revolution", "hunting"], default="revolution",
        help="one revolution of the pinion (default), or until the same teeth meet again",
    )  # fmt: skip
    add_output_arguments(p)
    return p


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command; 0 done, 2 an input or argument is wrong."""
    return answer(parser(), _run, argv)


def _run(arguments: Namespace) -> None:
    from gearwear.design.reading import read_design
    from gearwear.report.writing import check_folder

    with bundled_example() as example:
        design = read_design(arguments.design or example / "design.toml")
    _check(arguments, design)
    check_folder(arguments.out)
    from gearwear.report.meshing import lines, write_study
    from gearwear.report.summary import print_lines, written
    from gearwear.report.writing import output_folder

    study = study_pair(design, arguments)
    with output_folder(arguments.out) as stage:
        files = write_study(stage, study)
    if not arguments.quiet:
        print_lines([*lines(study), *written(arguments.out, files)])


def _check(arguments: Namespace, design: Design) -> None:
    """Refuse what contradicts itself."""
    if design.pair is None:
        raise InputError(f"{design.source}: has one gear; meshing needs [pinion] and [gear]")
    if arguments.wear is not None and arguments.loss is not None:
        raise InputError("--wear and --loss are both given: one of them")
    for option in ("teeth", "part"):
        if getattr(arguments, option) is not None and arguments.loss is None:
            raise InputError(f"--{option} says what has the --loss, which is not given")
    for option, value in (("--loss", arguments.loss), ("--centre-distance", arguments.centre_distance)):
        if value is not None and not 0.0 < value < math.inf:
            raise InputError(f"{option} {value:g}: must be above 0 mm")


def study_pair(design: Design, arguments: Namespace) -> PairStudy:
    """Everything the command finds out."""
    import numpy as np

    from gearwear.design.profiles import LEFT, RIGHT, SIGN, nominal_profiles
    from gearwear.meshing.contact import mesh_contact
    from gearwear.meshing.exact import exact_meshing
    from gearwear.meshing.shafts import shaft_movement
    from gearwear.report.meshing import PairStudy

    centre = design.centre_distance if arguments.centre_distance is None else arguments.centre_distance
    pinion, gear = design.gears["pinion"], design.gears["gear"]
    exact = exact_meshing(pinion, gear, centre)
    flanks = {
        part: nominal_profiles(one, np.linspace(one.root_radius, one.flank_end_radius, RADII), np.array([0.5 * one.face_width]))
        for part, one in design.gears.items()
    }
    half = RIGHT if arguments.drive == "right" else LEFT
    worn, profiles = _worn(design, flanks, arguments, half)
    if profiles is not None and worn.part is not None:
        flanks[worn.part] = profiles
        if worn.part == "gear":  # the slices are those of the pinion, which drives
            flanks["pinion"] = nominal_profiles(pinion, flanks["pinion"].radius, profiles.z)
        if arguments.drive is None:
            lost = profiles.loss.mean(axis=(0, 2, 3))
            half = LEFT if lost[LEFT] >= lost[RIGHT] else RIGHT
    contact = mesh_contact(flanks["pinion"], flanks["gear"], centre, half, POSITIONS, arguments.cycle)
    shafts = shaft_movement(pinion, gear, centre, worn.loss) if worn.loss > 0.0 else None
    return PairStudy(design, exact, worn, contact, SIGN[half], arguments.cycle, shafts, _notes(design, exact))


def _worn(
    design: Design, flanks: dict[str, ToothProfiles], arguments: Namespace, half: int
) -> tuple[WornGear, ToothProfiles | None]:
    """What is worn, and its profiles."""
    import numpy as np

    from gearwear.report.meshing import WornGear, teeth_words
    from gearwear.report.profiles import read_profiles

    if arguments.wear is not None:
        part, profiles = read_profiles(arguments.wear, design)
        gear = profiles.gear
        lost = gear.tooth_thickness - profiles.thickness(gear.reference_radius)
        return WornGear(part, f"{part} as measured, {arguments.wear}", max(float(lost.max()), 0.0)), profiles
    if arguments.loss is None:
        return WornGear(None, "both gears as designed", 0.0), None
    part = arguments.part or "pinion"
    gear, loss = design.gears[part], arguments.loss
    teeth = _teeth(arguments.teeth, gear)
    nominal = flanks[part]
    half_angle = nominal.half_angle.copy()
    half_angle[teeth, half] -= loss / gear.base_radius
    if not (half_angle.sum(axis=1) > 0.0).all():
        land = gear.base_radius * float(nominal.half_angle.sum(axis=1).min())
        raise InputError(
            f"--loss {loss:g}: must be below {land:.4f} mm, what the tooth has to lose at its tip before it gets shorter"
        )
    thickness = loss * gear.reference_radius / gear.base_radius
    side = "left" if half == 0 else "right"
    words = f"{loss:g} mm off the {side} flank of {teeth_words(teeth, gear.teeth)} of the {part}"
    return WornGear(part, words, thickness), type(nominal)(gear, nominal.radius, nominal.z, np.asarray(half_angle))


def _teeth(text: str | None, gear: Gear) -> list[int]:
    if text is None or text == "all":
        return list(range(gear.teeth))
    try:
        teeth = sorted({int(part) - 1 for part in text.split(",")})
    except ValueError:
        teeth = [-1]
    if not all(0 <= tooth < gear.teeth for tooth in teeth):
        raise InputError(f"--teeth {text}: teeth from 1 to {gear.teeth}, such as 1,{gear.teeth}, or all")
    return teeth


def _notes(design: Design, exact: ExactMeshing) -> tuple[str, ...]:
    """What a reader must know of the design at this centre distance."""
    notes = []
    if exact.backlash.normal < -1e-9:
        notes.append(f"as designed the teeth would overlap by {-exact.backlash.normal:.4f} mm at this centre distance")
    if exact.path.contact_ratio < 1.0:
        notes.append(f"as designed the contact ratio is {exact.path.contact_ratio:.3f}: the drive is not continuous")
    for part, one in (("pinion", exact.interference_pinion), ("gear", exact.interference_gear)):
        if one.penetration > 0.0:
            notes.append(f"the mate's tip digs {one.penetration:.4f} mm into the {part}'s root")
        elif one.overrun > 0.0:
            root = "undercut root" if design.gears[part].undercut else "root"
            notes.append(
                f"the mate's tip passes the {part}'s interference point by {one.overrun:.3f} mm of roll; its {root} clears it"
            )
    return tuple(notes)


if __name__ == "__main__":
    raise SystemExit(main())
