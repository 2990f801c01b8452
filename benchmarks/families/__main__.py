"""Families of hard scans: make them, run a checkout over them, tell what it got right.

python -m benchmarks.families run --families a,b --scans 6 --seed 1 --out new.jsonl
python -m benchmarks.families run --families a,b --scans 6 --seed 1 --checkout ../base --out base.jsonl
python -m benchmarks.families table base.jsonl new.jsonl
python -m benchmarks.families write a3 --seed 1 --out folder
python -m benchmarks.families show new.jsonl a3
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path

from benchmarks.families.families import FAMILIES, POINTS, case


def main(arguments: list[str] | None = None) -> None:
    options = _parser().parse_args(arguments)
    if options.do == "run":
        from benchmarks.families.run import run

        families = list(FAMILIES) if options.families == "all" else options.families.split(",")
        unknown = [letter for letter in families if letter not in FAMILIES]
        if unknown:
            raise SystemExit(f"--families {options.families}: no family {unknown[0]!r}; there are {', '.join(FAMILIES)}")
        labels = [(letter, number) for number in range(options.first, options.first + options.scans) for letter in families]
        run(labels, options.seed, options.points, options.out, options.checkout.resolve(), options.jobs, options.limit)
    elif options.do == "table":
        from benchmarks.families.run import read
        from benchmarks.families.table import page

        print(page([(path.stem, list(read(path))) for path in options.files], options.kinds))
    elif options.do == "write":
        from benchmarks.families.files import write_case

        for path in write_case(case(options.label[0], int(options.label[1:]), options.seed, options.points), options.out)[1]:
            print(path)
    else:
        from benchmarks.families.run import read
        from benchmarks.families.scoring import score

        for line in read(options.file):
            if line["label"] == options.label:
                print(json.dumps(score(line), indent=1))


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.families", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    ways = parser.add_subparsers(dest="do", required=True)
    make = argparse.ArgumentParser(add_help=False)
    make.add_argument("--seed", type=int, default=1, help="of the study")
    make.add_argument("--points", type=int, default=POINTS, help="of each scan, about")
    run = ways.add_parser("run", parents=[make], help="compare scans; one JSON line each, resumable")
    run.add_argument("--families", default="all", help="letters, with commas")
    run.add_argument("--scans", type=int, default=6, help="of each family")
    run.add_argument("--first", type=int, default=0, help="number of the first scan")
    run.add_argument("--jobs", type=int, default=1, help="processes at a time")
    run.add_argument(
        "--checkout", type=Path, default=Path(__file__).resolve().parents[2], help="folder of the version to be judged"
    )
    run.add_argument("--limit", type=float, default=300.0, help="seconds for one comparison")
    run.add_argument("--out", type=Path, required=True, help="JSON lines")
    table = ways.add_parser("table", help="what was found, by family; several files side by side")
    table.add_argument("files", type=Path, nargs="+")
    table.add_argument("--kinds", action="store_true", help="also by the kinds within a family")
    write = ways.add_parser("write", parents=[make], help="one scan, its design and its truth as files")
    write.add_argument("label", help="family and number, such as a3")
    write.add_argument("--out", type=Path, required=True, help="folder")
    show = ways.add_parser("show", help="the score of one scan")
    show.add_argument("file", type=Path)
    show.add_argument("label")
    return parser


if __name__ == "__main__":
    main()
