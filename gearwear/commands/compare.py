"""The main job: ``python -m gearwear.compare [DESIGN.toml SCAN [SCAN …]]``."""

from __future__ import annotations

import math
from argparse import Namespace
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

from gearwear.commands.arguments import Parser, answer
from gearwear.commands.inputs import (
    add_output_arguments,
    add_report_arguments,
    add_scan_arguments,
    add_stream_argument,
    design_and_scans,
    with_details,
)
from gearwear.errors import InputError
from gearwear.processors import idle_processors

if TYPE_CHECKING:
    from gearwear.design.pair import Design
    from gearwear.wear_law.forecast import Quantity
    from gearwear.wear_law.study import Ahead

DESCRIPTION = """\
Compare the scan of a gear with its design: how much metal is gone and where, what
that does to the meshing, and what else the scan shows. Without arguments it runs
the bundled example. Several scans are views of one gear: each is registered to the
design by itself, and they are merged.

Writes report.html, report.json, worn_volume.stl, worn_volume.3mf, worn_gear.stl,
worn_profiles.npz and thickness.csv.

A forecast needs --cycles-run, a mate in the design, and wear on at least three
teeth to fit the wear law to; without a fit there is none, and the report says why."""


def parser() -> Parser:
    """The command's arguments."""
    p = Parser("compare", "[DESIGN.toml SCAN [SCAN …]]", DESCRIPTION)
    add_scan_arguments(p)
    add_stream_argument(p)
    p.add_argument(
        "--before", nargs="+", type=Path, default=[], metavar="SCAN", help="a scan of the same gear before wear, or its views"
    )
    add_output_arguments(p)
    add_report_arguments(p)
    p.add_argument("--no-page", action="store_true", help="write no report.html: numbers and solids alone")
    p.add_argument(
        "--no-loop", action="store_true", help="do not look for effects of measurement and manufacture beyond registration"
    )
    p.add_argument(
        "--sections", metavar="Z[,Z…]|all",
        help="also write section curves, worn and nominal, at these heights in mm, as CSV and DXF; all: every 0.2 mm",
    )  # fmt: skip
    p.add_argument(
        "--write", metavar="FORMAT[,FORMAT…]", default="",
        help="also write glb: worn gear and worn volume coloured by what is missing; parquet: every point with its deviation "
        "(needs pyarrow); topography: every flank as a grid, CSV; "
        "ply, npz: every point with its deviation, for CloudCompare and numpy",
    )  # fmt: skip
    p.add_argument("--cycles-run", type=float, metavar="N", help="mesh cycles of the gear so far: its own revolutions")
    p.add_argument(
        "--cycles", type=float, action="append", default=[], metavar="M",
        help="forecast the wear at so many cycles since new, from --cycles-run on; may be given more than once",
    )  # fmt: skip
    p.add_argument(
        "--limit-depth-um", type=float, metavar="D", help="cycles left until the mean worn flank has lost D µm at its deepest"
    )
    p.add_argument(
        "--limit-thickness-mm", type=float, metavar="T",
        help="cycles left until the teeth have lost T mm of arc at the reference circle",
    )  # fmt: skip
    p.add_argument("--limit-backlash-mm", type=float, metavar="J", help="cycles left until the normal backlash has grown by J mm")
    p.add_argument("--verbose", action="store_true", help="print the time each station took")
    return p


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command; 0 done, 2 an input or argument is wrong."""
    return answer(parser(), _run, argv)


def _run(arguments: Namespace) -> None:
    from gearwear.commands.progress import stations
    from gearwear.design.files.toml import read_design
    from gearwear.report.files.writing import check_folder

    with (
        design_and_scans(arguments) as (design_file, scans),
        stations(arguments.quiet, arguments.verbose) as tell,
        idle_processors(),
    ):
        design = with_details(read_design(design_file), arguments)
        heights, ahead, also = _heights(arguments.sections, design, arguments.part), _ahead(arguments), _also(arguments)
        check_folder(arguments.out)
        from gearwear.comparison.stations import compare
        from gearwear.report.write import write_results
        from gearwear.scan.streaming import check_held

        for name in sorted(also & {"ply", "npz"}):
            check_held(scans, arguments.stream, f"--write {name}")

        results = compare(
            design,
            scans,
            arguments.part,
            arguments.before,
            arguments.units,
            not arguments.no_loop,
            ahead=ahead,
            progress=tell,
            stream=arguments.stream,
        )
        tell("report")
        files = write_results(
            results, arguments.out, heights, also, page=not arguments.no_page, pdf=arguments.pdf, command=arguments.command
        )
    if not arguments.quiet:
        from gearwear.report.words.terminal import print_summary

        print_summary(results, files, arguments.out)


def _heights(text: str | None, design: Design, part: str | None) -> list[float] | None:
    """Heights of the sections asked for; an empty list stands for all. Which gear was scanned may not be known yet: the wider face has more."""
    from gearwear.report.files.writing import check_heights

    if text is None:
        return None
    if text == "all":
        return []
    known = [design.gears[part]] if part in design.gears else design.gears.values()
    try:
        heights = [float(one) for one in text.split(",")]
    except ValueError:
        heights = [math.nan]
    check_heights(f"--sections {text}", heights, max(gear.face_width for gear in known))
    return heights


def _also(arguments: Namespace) -> frozenset[str]:
    """What else to write."""
    from gearwear.report.files.extras import EXTRAS, NO_PYARROW

    asked = [name.strip() for name in arguments.write.split(",")] if arguments.write else []
    for name in asked:
        if name not in EXTRAS:
            raise InputError(f"--write {name}: one of {', '.join(EXTRAS)} would be right, or several with commas between")
    if "parquet" in asked and find_spec("pyarrow") is None:  # said before the work, not after it
        raise InputError(NO_PYARROW)
    return frozenset(asked)


def _ahead(arguments: Namespace) -> Ahead | None:
    """What to forecast."""
    from gearwear.wear_law.study import Ahead

    limits: list[tuple[Quantity, str, float | None, float]] = [
        ("depth", "--limit-depth-um", arguments.limit_depth_um, 1e-3),
        ("thickness", "--limit-thickness-mm", arguments.limit_thickness_mm, 1.0),
        ("backlash", "--limit-backlash-mm", arguments.limit_backlash_mm, 1.0),
    ]
    for _, option, value, _ in limits:
        if value is not None and not 0.0 < value < math.inf:
            raise InputError(f"{option} {value:g}: must be above 0")
    asked = [option for _, option, value, _ in limits if value is not None] + ["--cycles"] * bool(arguments.cycles)
    run = arguments.cycles_run
    if run is None:
        if asked:
            raise InputError(f"{asked[0]} needs --cycles-run N, the cycles in which the wear came about")
        return None
    if not 0.0 < run < math.inf:
        raise InputError(f"--cycles-run {run:g}: must be above 0")
    for cycles in arguments.cycles:
        if not run <= cycles < math.inf:
            raise InputError(f"--cycles {cycles:g}: counts from new, so it cannot be below --cycles-run {run:g}")
    return Ahead(
        run, tuple(arguments.cycles), tuple((name, factor * value) for name, _, value, factor in limits if value is not None)
    )
