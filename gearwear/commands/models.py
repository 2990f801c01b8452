"""``gearwear models [DESIGN.toml]``: the nominal gears of a design as exact STEP models."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from gearwear.commands.arguments import Parser, answer
from gearwear.commands.inputs import design_alone
from gearwear.design import Design
from gearwear.errors import InputError
from gearwear.report.files.writing import check_folder, output_folder

if TYPE_CHECKING:
    from argparse import Namespace


def parser() -> Parser:
    """The command's arguments."""
    p = Parser(
        "models",
        "[DESIGN.toml]",
        """\
Write the nominal solids of a design as exact STEP files: pinion.step, gear.step
and pair.step, in mesh at the design's centre distance; of a design with one
gear, that one. Left out, the design is that of the bundled example.""",
    )
    p.add_argument("design", nargs="?", metavar="DESIGN.toml", help="the design; left out: the bundled example")
    p.add_argument(
        "--out", type=Path, default=Path("gearwear-out"), metavar="DIR", help="folder to write to, default %(default)s"
    )
    p.add_argument("--rexs", action="store_true", help="write the design as a REXS model too: design.rexs")
    return p


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command; 0 done, 2 an input or argument is wrong."""
    return answer(parser(), _run, argv)


def _run(arguments: Namespace) -> None:
    design = design_alone(arguments)
    for path, description in write_models(design, arguments.out, arguments.rexs):
        sys.stdout.write(f"{path}  {path.stat().st_size / 1000:,.0f} kB  {description}\n")
    for warning in design.warnings:
        sys.stderr.write(f"note: {warning}\n")


def write_models(design: Design, folder: Path, rexs: bool = False) -> list[tuple[Path, str]]:
    """Make every solid of a design, then write their STEP files.

    Parameters
    ----------
    design : Design
        One gear or a pair.
    folder : Path
        Made if it is not there. Nothing is written if a solid cannot be made.
    rexs : bool
        Whether to write the design as a REXS model too.

    Returns
    -------
    list of (Path, str)
        Each file, and what it is.

    Raises
    ------
    InputError
        If a solid or a REXS model cannot be made, or the folder cannot be written to.
    """
    check_folder(folder)
    from gearwear.design.files.rexs_writing import rexs_text

    model = rexs_text(design) if rexs else ""
    from gearwear.brep.pair import gear_pair
    from gearwear.brep.solid import gear_solid
    from gearwear.brep.step import write_step

    try:
        solids = {part: gear_solid(gear) for part, gear in design.gears.items()}
    except InputError as error:
        raise InputError(f"{design.source}: {error}" if design.source else str(error)) from None
    pair = gear_pair(design, solids["pinion"], solids["gear"]) if design.pair is not None else None
    written = []
    with output_folder(folder) as stage:
        for part, gear in design.gears.items():
            write_step(solids[part], stage / f"{part}.step")
            written.append((folder / f"{part}.step", gear.headline()))
        if pair is not None:
            write_step(pair, stage / "pair.step")
            written.append((folder / "pair.step", f"pinion and gear in mesh, centre distance {design.centre_distance:g} mm"))
        if model:
            (stage / "design.rexs").write_text(model, encoding="utf-8", newline="\n")
            written.append((folder / "design.rexs", "the design as a REXS model"))
    return written
