"""The main job: ``python -m gearwear.compare [DESIGN.toml SCAN [SCAN …]]``."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from importlib import resources
from pathlib import Path

from gearwear.errors import InputError

DESCRIPTION = """\
Compare the scan of a gear with its design: how much metal is gone and where, what that does to the meshing,
and what else the scan shows. Without arguments it runs the bundled example."""


def parser() -> argparse.ArgumentParser:
    """The command's arguments."""
    p = argparse.ArgumentParser(prog="gearwear compare", description=DESCRIPTION)
    p.add_argument("design", nargs="?", type=Path, metavar="DESIGN.toml", help="the design: one gear or a pair")
    p.add_argument("scan", nargs="*", type=Path, metavar="SCAN", help="the scan, or several views of one gear")
    p.add_argument(
        "--before", nargs="+", type=Path, default=[], metavar="SCAN", help="scan of the same gear before wear, or its views"
    )
    p.add_argument("--part", choices=["pinion", "gear"], help="which one was scanned (default: the one that fits)")
    p.add_argument("--units", default="mm", help="unit of the scan: mm, cm, m, um, in (default mm)")
    p.add_argument("--out", type=Path, default=Path("gearwear-out"), metavar="DIR", help="output folder (default gearwear-out)")
    p.add_argument("--no-loop", action="store_true", help="do not look for effects beyond registration")
    p.add_argument(
        "--sections",
        metavar="Z[,Z…]|all",
        help="also write section curves at these heights (mm) as CSV and DXF; all: every 0.2 mm",
    )
    p.add_argument(
        "--points", choices=["ply", "npz"], action="append", default=[], help="also write the deviation of every point"
    )
    p.add_argument("--quiet", action="store_true", help="print nothing but errors")
    p.add_argument("--verbose", action="store_true", help="print the time each station took")
    return p


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command; 0 done, 2 an input or argument is wrong."""
    arguments = parser().parse_args(argv)
    try:
        return _run(arguments)
    except InputError as error:
        print(f"gearwear: {error}", file=sys.stderr)  # noqa: T201
        return 2


def _run(arguments: argparse.Namespace) -> int:
    if arguments.design is not None and not arguments.scan:
        raise InputError(
            f"no scan is given beside {arguments.design}: DESIGN.toml SCAN [SCAN …], or nothing at all for the bundled example"
        )
    from gearwear.report.progress import stations
    from gearwear.report.summary import print_summary

    with (
        resources.as_file(resources.files("gearwear") / "example") as example,
        stations(arguments.quiet, arguments.verbose) as tell,
    ):
        design_file = arguments.design or example / "design.toml"
        scans = arguments.scan or [example / "scan.ply.gz"]
        from gearwear.design.reading import read_design

        design = read_design(design_file)
        heights = _heights(arguments.sections, design)
        from gearwear.pipeline import compare
        from gearwear.report.outputs import write_results

        results = compare(design, scans, arguments.part, arguments.before, arguments.units, not arguments.no_loop, progress=tell)
        tell("report")
        report = write_results(results, arguments.out, heights, frozenset(arguments.points))
    if not arguments.quiet:
        print_summary(report, arguments.out)
    return 0


def _heights(text: str | None, design: object) -> list[float] | None:
    """Heights of the sections asked for; an empty list stands for all."""
    if text is None:
        return None
    if text == "all":
        return []
    try:
        return [float(part) for part in text.split(",")]
    except ValueError:
        raise InputError(f"--sections {text}: heights in mm, such as 0,7.5,15, or all") from None


if __name__ == "__main__":
    raise SystemExit(main())
