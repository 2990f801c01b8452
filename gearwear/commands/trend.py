"""The same gears over their inspections: ``gearwear trend STORE``."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Sequence

from gearwear.commands.arguments import Parser, answer, store_parser

DESCRIPTION = """\
What changed on each gear of a fleet from inspection to inspection: worn volume, depth,
thickness, backlash, with their ± and what of it is significant, how fast, and in how
many cycles or when a limit is reached; the most urgent gears first. STORE is what
gearwear batch wrote.

Limits are those of the designs, [limits]; whether they are kept is decided by ISO
14253-1. Exit status: 0 all gears conform, or there are no limits; 1 one does not; 3 none
does not, and one is undecided (neither can be proven), or no scan of it gave a result;
2 an argument is wrong.

Writes trend.html, trend.csv (a row for each gear and quantity), inspections.csv (each
inspection too), teeth.csv (each tooth, under one number in every inspection), and all
as Parquet."""


def parser() -> Parser:
    """The command's arguments."""
    return store_parser("trend", DESCRIPTION)


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command; 0 all conform, 1 one does not, 3 one is undecided, 2 an argument is wrong."""
    return answer(parser(), _run, argv)


def _run(arguments: Namespace) -> int:
    from gearwear.design.conformity import Conformity, exit_status
    from gearwear.fleet.pages import trend_page
    from gearwear.fleet.reading import read_fleet, trends
    from gearwear.fleet.results import POINT_COLUMNS, TREND_COLUMNS, point_rows, trend_rows
    from gearwear.fleet.store import Store
    from gearwear.fleet.tables import write_tables
    from gearwear.fleet.teeth import TEETH_COLUMNS
    from gearwear.fleet.words import trend_lines
    from gearwear.report.files.writing import check_folder, output_folder
    from gearwear.report.words.terminal import print_lines, written

    out = arguments.out or arguments.store / "trend"
    store = Store(arguments.store)
    store.listed()  # said before a folder is made
    check_folder(out)
    fleet = read_fleet(store)
    gears = trends(fleet)
    with output_folder(out) as stage:
        files = ["trend.html"]
        (stage / "trend.html").write_bytes(trend_page(fleet, gears).encode())
        files += write_tables(stage, "trend", trend_rows(gears), TREND_COLUMNS)
        files += write_tables(stage, "inspections", point_rows(gears), POINT_COLUMNS)
        files += write_tables(stage, "teeth", fleet.teeth, TEETH_COLUMNS)
    if not arguments.quiet:
        print_lines([*trend_lines(fleet, gears), *written(out, files)])
    judged = (gear.conformity if gear.trends else gear.conformity or Conformity.NEITHER for gear in gears)
    return exit_status(state for state in judged if state is not None)
