"""``gearwear meshing [DESIGN.toml]``: a pair in mesh, as designed by the exact relations and worn in rigid contact."""

from __future__ import annotations

import math
from argparse import Namespace
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from gearwear.commands.arguments import Parser, answer
from gearwear.commands.inputs import add_memory_argument, add_output_arguments, design_alone
from gearwear.errors import InputError

if TYPE_CHECKING:
    from gearwear.loaded.study import LoadedStudy
    from gearwear.meshing.study import PairStudy
    from gearwear.wear_law.study import WearStudy

DESCRIPTION = """\
What a pair does in mesh. As designed, by the exact involute relations: every kind of
backlash, the path of contact with its start and end on both profiles, single
contact, contact ratio, sliding, tip clearance, interference. In rigid contact over
a revolution or the whole hunting cycle: transmission error and backlash, with a gear
worn by a uniform loss (--loss) or as compare measured it (--wear, for each gear),
and how far the shafts can close to take that up; without either both are as
designed. Left out, the design is that of the bundled example. With --torque, or a
[load] in the design, also under load, with elastic teeth: loaded transmission error,
mesh stiffness, load sharing and pressure.

Writes meshing.json; over the rotation meshing.csv and meshing.png, along the path of
contact sliding.csv and path.png; under load loaded.png."""


def parser() -> Parser:
    """The command's arguments."""
    p = Parser("meshing", "[DESIGN.toml]", DESCRIPTION)
    p.add_argument("design", nargs="?", type=Path, metavar="DESIGN.toml", help="the design: a pair")
    p.add_argument(
        "--wear",
        type=Path,
        action="append",
        metavar="DIR|CSV",
        help="a gear as it is: the folder that compare wrote to, its worn_profiles.npz, or traces of a measuring machine as CSV; given twice, both"
        " gears",
    )
    p.add_argument(
        "--mate-tooth",
        type=int,
        metavar="TOOTH",
        help="tooth of the gear, counted from 1, that meets tooth 1 of the pinion with its left flank; left out: tooth 1",
    )
    p.add_argument(
        "--torque", type=float, metavar="NM", help="also under load: torque of the pinion in N m, in place of the design's [load]"
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
        "--cycle", choices=["revolution", "driven", "hunting"],
        help="one revolution of the pinion or of the driven gear, or until the same teeth meet again; left out: one of the worn gear, of the one"
        " with more teeth where both are, else of the pinion",
    )  # fmt: skip
    add_memory_argument(p)
    add_output_arguments(p)
    return p


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command; 0 done, 2 an input or argument is wrong."""
    return answer(parser(), _run, argv)


def _run(arguments: Namespace) -> None:
    from gearwear.report.files.writing import check_folder

    design = design_alone(arguments)
    _check(arguments)
    check_folder(arguments.out)
    from gearwear.api import write
    from gearwear.loaded.study import load_left_out, not_modelled
    from gearwear.meshing.study import study_meshing
    from gearwear.report.files.meshing import lines
    from gearwear.report.words.terminal import print_lines, written

    if arguments.torque is not None and (why := not_modelled(design)):
        raise InputError(f"{design.source}: --torque {arguments.torque:g}: {why}; without --torque its contact is rigid")
    study = study_meshing(
        design, arguments.wear, loss=arguments.loss, teeth=_teeth(arguments.teeth), part=arguments.part,
        centre_distance=arguments.centre_distance, drive=arguments.drive, cycle=arguments.cycle,
        mate_tooth=arguments.mate_tooth,
    )  # fmt: skip
    loaded = _under_load(study, arguments.torque)
    if loaded is None:
        study = replace(study, notes=(*load_left_out(design), *study.notes))
    law = _law_of_traces(study, arguments.wear or ())
    files = write(study, arguments.out, loaded=loaded, law=law)["files"]
    if not arguments.quiet:
        print_lines([*lines(study, loaded, law), *written(arguments.out, files)])


def _law_of_traces(study: PairStudy, wear: Sequence[Path]) -> WearStudy | None:
    """The wear law on traces of a measuring machine, the first given; None where none were."""
    traced = next((at for at, path in enumerate(wear) if path.suffix.lower() == ".csv"), None)
    if traced is None:
        return None
    from gearwear.meshing.study import facing
    from gearwear.wear_law.from_traces import study_traces

    worn = study.worn if traced == 0 else study.worn_mate
    assert worn is not None
    mate = study.design.mate_of(str(worn.part))
    assert mate is not None
    profiles = study.measured[traced]
    return study_traces(profiles, mate, study.exact.centre_distance, facing(profiles.gear, study.drive_side))


def _under_load(study: PairStudy, torque: float | None) -> LoadedStudy | None:
    """The pair under the torque asked for, or the design's load; None where there is neither, or the gears are none that it is modelled for."""
    from gearwear.design.load import LoadSpec
    from gearwear.loaded.study import not_modelled, study_load

    load = study.design.load
    if torque is None and not_modelled(study.design):
        return None
    if torque is not None:
        load = LoadSpec(torque=1e3 * torque) if load is None else replace(load, torque=1e3 * torque, load_per_width=None)
    if load is None:
        return None
    return study_load(
        study.design, study.flanks, load, study.drive_side,
        centre_distance=study.exact.centre_distance, cycle=study.cycle, start_tooth=study.mate_tooth,
    )  # fmt: skip


def _check(arguments: Namespace) -> None:
    """Refuse what contradicts itself."""
    if arguments.wear is not None and arguments.loss is not None:
        raise InputError("--wear and --loss are both given: one of them")
    for option in ("teeth", "part"):
        if getattr(arguments, option) is not None and arguments.loss is None:
            raise InputError(f"--{option} says what has the --loss, which is not given")
    for option, value, unit in (
        ("--loss", arguments.loss, "mm"), ("--centre-distance", arguments.centre_distance, "mm"), ("--torque", arguments.torque, "N m")
    ):  # fmt: skip
        if value is not None and not 0.0 < value < math.inf:
            raise InputError(f"{option} {value:g}: must be above 0 {unit}")


def _teeth(text: str | None) -> list[int] | None:
    """Teeth counted from 1, as typed; None is all."""
    if text is None or text == "all":
        return None
    try:
        return [int(part) for part in text.split(",")]
    except ValueError:
        raise InputError(f"--teeth {text}: whole numbers, such as 1,3, or all would be right") from None
