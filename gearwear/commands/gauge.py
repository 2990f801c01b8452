"""How far repeated scans scatter: ``gearwear gauge STORE``."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Sequence

from gearwear.commands.arguments import Parser, answer, store_parser

DESCRIPTION = """\
How far repeated scans of the same gears scatter, and how much of it comes from who scans:
crossed repeatability and reproducibility by analysis of variance (AIAG, Measurement
Systems Analysis) on worn volume, depth, thickness, backlash and the deviations of the
inspection, with 95 % intervals of each component; and whether the repeats contradict the
± that the reports state. STORE is what gearwear batch wrote; scans of the same gear at
the same inspection are told apart by the columns operator and repeat.

Writes gauge.html, gauge.csv and gauge.parquet."""


def parser() -> Parser:
    """The command's arguments."""
    return store_parser("gauge", DESCRIPTION)


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command; 0 done, 2 an argument is wrong."""
    return answer(parser(), _run, argv)


def _run(arguments: Namespace) -> None:
    from gearwear.fleet.pages import gauge_page
    from gearwear.fleet.reading import gauge_studies, read_fleet
    from gearwear.fleet.results import GAUGE_COLUMNS, gauge_rows
    from gearwear.fleet.store import Store
    from gearwear.fleet.tables import write_tables
    from gearwear.fleet.words import gauge_lines
    from gearwear.report.files.writing import check_folder, output_folder
    from gearwear.report.words.terminal import print_lines, written

    out = arguments.out or arguments.store / "gauge"
    store = Store(arguments.store)
    store.listed()  # said before a folder is made
    check_folder(out)
    studies, scans = gauge_studies(read_fleet(store))
    with output_folder(out) as stage:
        (stage / "gauge.html").write_bytes(gauge_page(studies, scans).encode())
        files = ["gauge.html", *write_tables(stage, "gauge", gauge_rows(studies), GAUGE_COLUMNS)]
    if not arguments.quiet:
        print_lines([*gauge_lines(studies), *written(out, files)])
