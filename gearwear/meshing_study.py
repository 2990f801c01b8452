"""``gearwear meshing [DESIGN.toml]``: a pair in mesh, as designed by the exact relations and worn in rigid contact."""

from __future__ import annotations

import math
from argparse import Namespace
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from gearwear.arguments import Parser, answer
from gearwear.errors import InputError
from gearwear.inputs import add_output_arguments, bundled_example

if TYPE_CHECKING:
    from gearwear.design.pair import Design
    from gearwear.design.profiles import ToothProfiles
    from gearwear.meshing.exact import ExactMeshing
    from gearwear.report.pair_study import PairStudy, WornGear

DESCRIPTION = """\
What a pair does in mesh. As designed, by the exact involute relations: every kind of
backlash, the path of contact with its start and end on both profiles, single
contact, contact ratio, sliding, tip clearance, interference. In rigid contact over
a revolution or the whole hunting cycle: transmission error and backlash, with a gear
worn by a uniform loss (--loss) or as compare measured it (--wear), and how far the
shafts can close to take that up; without either both are as designed. Left out, the
design is that of the bundled example.

Writes meshing.json; over the rotation meshing.csv and meshing.png, along the path of
contact sliding.csv and path.png."""

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
    _check(arguments)
    check_folder(arguments.out)
    from gearwear.report.meshing import lines
    from gearwear.report.summary import print_lines, written

    study = study_meshing(
        design, arguments.wear, loss=arguments.loss, teeth=_teeth(arguments.teeth), part=arguments.part,
        centre_distance=arguments.centre_distance, drive=arguments.drive, cycle=arguments.cycle,
    )  # fmt: skip
    files = study.write(arguments.out)
    if not arguments.quiet:
        print_lines([*lines(study), *written(arguments.out, files)])


def _check(arguments: Namespace) -> None:
    """Refuse what contradicts itself."""
    if arguments.wear is not None and arguments.loss is not None:
        raise InputError("--wear and --loss are both given: one of them")
    for option in ("teeth", "part"):
        if getattr(arguments, option) is not None and arguments.loss is None:
            raise InputError(f"--{option} says what has the --loss, which is not given")
    for option, value in (("--loss", arguments.loss), ("--centre-distance", arguments.centre_distance)):
        if value is not None and not 0.0 < value < math.inf:
            raise InputError(f"{option} {value:g}: must be above 0 mm")


def _teeth(text: str | None) -> list[int] | None:
    """Teeth counted from 1, as typed; None is all."""
    if text is None or text == "all":
        return None
    try:
        return [int(part) for part in text.split(",")]
    except ValueError:
        raise InputError(f"--teeth {text}: whole numbers, such as 1,3, or all would be right") from None


def study_meshing(
    design: Design,
    wear: Path | str | ToothProfiles | None = None,
    *,
    loss: float | None = None,
    teeth: Sequence[int] | None = None,
    part: str | None = None,
    centre_distance: float | None = None,
    drive: str | None = None,
    cycle: Literal["revolution", "hunting"] = "revolution",
) -> PairStudy:
    """A pair in mesh: the exact relations as designed, the flanks as they are in rigid contact, and what moving the shafts would do.

    Parameters
    ----------
    design : Design
        A pair.
    wear : path or ToothProfiles or None
        One gear as it is: the folder that `compare` wrote to, its ``worn_profiles.npz``, or profiles of either gear.
    loss : float or None
        In place of `wear`, a uniform loss, mm along the normal, on flanks that carry.
    teeth : sequence of int or None
        Teeth with the loss, **counted from 1**; None: all.
    part : {"pinion", "gear"} or None
        Which one has the loss; None: the pinion.
    centre_distance : float or None
        mm, in place of the design's.
    drive : {"left", "right"} or None
        Flanks that carry, the pinion driving; None: the more worn ones, else left.
    cycle : {"revolution", "hunting"}
        One revolution of the pinion, or until the same teeth meet again.

    Returns
    -------
    PairStudy

    Raises
    ------
    InputError
        If the design has one gear only, the gears do not mesh at this distance, the loss is more than a tooth has, or what is asked
        for contradicts itself.

    Examples
    --------
    >>> import gearwear as gw
    >>> study = gw.study_meshing(gw.read_design(gw.example("design.toml")), loss=0.1, centre_distance=114.5)
    >>> study
    PairStudy: z = 12 / 24, m = 6.35 mm, a = 114.5 mm; 0.1 mm off the left flank of all 12 teeth of the pinion
      design  contact ratio 1.2544, normal backlash 0.1377 mm
      worn    transmission error 0.0 µm peak to peak, normal backlash 0.2377 … 0.2377 mm
      shafts  The wear is taken up with the shafts 0.145 mm closer, at 114.355 mm.
      note    The gear's tip passes the pinion's interference point by 1.403 mm of roll; its undercut root clears it.
    """
    import numpy as np

    from gearwear.design.profiles import LEFT, RIGHT, SIGN, nominal_profiles
    from gearwear.meshing.contact import mesh_contact
    from gearwear.meshing.exact import exact_meshing
    from gearwear.meshing.shafts import take_up
    from gearwear.report.pair_study import PairStudy

    if design.pair is None:
        raise InputError(f"{design.source or 'the design'}: has one gear; meshing needs [pinion] and [gear]")
    for name, value, allowed in (
        ("part", part, ("pinion", "gear")), ("drive", drive, ("left", "right")), ("cycle", cycle, ("revolution", "hunting"))
    ):  # fmt: skip
        if value is not None and value not in allowed:
            raise InputError(f"{name} {value!r}: {' or '.join(allowed)} would be right")
    if wear is not None and loss is not None:
        raise InputError("wear and loss are both given: one of them")
    if loss is None and (teeth is not None or part is not None):
        raise InputError(f"{'part' if teeth is None else 'teeth'} says what has the loss, which is not given")
    centre = design.centre_distance if centre_distance is None else centre_distance
    pinion, gear = design.gears["pinion"], design.gears["gear"]
    exact = exact_meshing(pinion, gear, centre)
    flanks = {
        name: nominal_profiles(one, np.linspace(one.root_radius, one.flank_end_radius, RADII), np.array([0.5 * one.face_width]))
        for name, one in design.gears.items()
    }
    half = RIGHT if drive == "right" else LEFT
    worn, profiles = _as_it_is(design, wear)
    if loss is not None:
        worn, profiles = _uniform(flanks[part or "pinion"], part or "pinion", loss, teeth, half)
    if profiles is not None and worn.part is not None:
        flanks[worn.part] = profiles
        if worn.part == "gear":  # the slices are those of the pinion, which drives
            flanks["pinion"] = nominal_profiles(pinion, flanks["pinion"].radius, profiles.z)
        if drive is None:
            lost = profiles.loss.mean(axis=(0, 2, 3))
            half = LEFT if lost[LEFT] >= lost[RIGHT] else RIGHT
    contact = mesh_contact(flanks["pinion"], flanks["gear"], centre, half, POSITIONS, cycle)
    play = contact.backlash_min.value, contact.backlash_max.value
    shafts = take_up(pinion, gear, centre, play, worn.loss) if worn.loss > 0.0 else None
    return PairStudy(design, exact, worn, contact, SIGN[half], cycle, shafts, _notes(design, exact))


def _as_it_is(design: Design, wear: Path | str | ToothProfiles | None) -> tuple[WornGear, ToothProfiles | None]:
    """A measured gear, or none, and its profiles."""
    import numpy as np

    from gearwear.design.profiles import ToothProfiles
    from gearwear.report.pair_study import WornGear
    from gearwear.report.profiles import read_profiles

    if wear is None:
        return WornGear(None, "both gears as designed", 0.0), None
    if isinstance(wear, ToothProfiles):
        named = [name for name, one in design.gears.items() if one == wear.gear]
        if not named:
            raise InputError(f"the profiles are of a gear of {wear.gear.teeth} teeth that the design does not have")
        part, profiles, source = named[0], wear, "profiles given"
    else:
        part, profiles = read_profiles(Path(wear), design)
        source = str(wear)
    gear = profiles.gear
    lost = gear.tooth_thickness - profiles.thickness(gear.reference_radius)
    words, greatest = f"{part} as measured, {source}", float(lost.max())
    if greatest <= 0.0:
        return WornGear(part, words, 0.0), profiles
    tooth, slice_ = np.unravel_index(int(lost.argmax()), lost.shape)
    return WornGear(part, words, greatest, int(tooth), float(profiles.z[slice_])), profiles


def _uniform(
    nominal: ToothProfiles, part: str, loss: float, teeth: Sequence[int] | None, half: int
) -> tuple[WornGear, ToothProfiles]:
    """A uniform loss on some teeth, counted from 1, and the profiles with it."""
    from gearwear.report.pair_study import WornGear, teeth_words

    gear = nominal.gear
    if not 0.0 < loss < math.inf:
        raise InputError(f"loss {loss:g} mm: must be above 0")
    chosen = sorted({tooth - 1 for tooth in teeth or range(1, gear.teeth + 1)})
    if not all(0 <= tooth < gear.teeth for tooth in chosen):
        raise InputError(f"teeth {', '.join(str(t + 1) for t in chosen)}: the {part} has teeth from 1 to {gear.teeth}")
    half_angle = nominal.half_angle.copy()
    half_angle[chosen, half] -= loss / gear.base_radius
    if not (half_angle.sum(axis=1) > 0.0).all():
        land = gear.base_radius * float(nominal.half_angle.sum(axis=1).min())
        raise InputError(
            f"loss {loss:g} mm: must be below {land:.4f} mm, what the tooth has to lose at its tip before it gets shorter"
        )
    side = "left" if half == 0 else "right"
    words = f"{loss:g} mm off the {side} flank of {teeth_words(chosen, gear.teeth)} of the {part}"
    return WornGear(part, words, loss * gear.reference_radius / gear.base_radius), replace(nominal, half_angle=half_angle)


def _notes(design: Design, exact: ExactMeshing) -> tuple[str, ...]:
    """What a reader must know of the design at this centre distance."""
    notes = []
    if exact.backlash.normal < -1e-9:
        notes.append(f"as designed the teeth would overlap by {-exact.backlash.normal:.4f} mm at this centre distance")
    if exact.path.contact_ratio < 1.0:
        notes.append(f"as designed the contact ratio is {exact.path.contact_ratio:.3f}: the drive is not continuous")
    for part, other, one in (("pinion", "gear", exact.interference_pinion), ("gear", "pinion", exact.interference_gear)):
        if one.penetration > 0.0:
            notes.append(f"the {other}'s tip digs {one.penetration:.4f} mm into the {part}'s fillet: interference wear")
        elif one.overrun > 0.0:
            root = "undercut root" if design.gears[part].undercut else "root"
            notes.append(
                f"the {other}'s tip passes the {part}'s interference point by {one.overrun:.3f} mm of roll; its {root} clears it"
            )
        elif one.below_form > 1e-9:
            notes.append(
                f"the {other}'s tip reaches {one.below_form:.3f} mm of roll below the {part}'s form circle: no involute is there"
            )
    return tuple(notes)


if __name__ == "__main__":
    raise SystemExit(main())
