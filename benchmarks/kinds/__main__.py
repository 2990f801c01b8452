"""The study of other kinds of gears: helical, rings, double helical; scans with known truth and what was found.

python -m benchmarks.kinds run --scans 20 --seed 1 --out kinds.jsonl
python -m benchmarks.kinds page kinds.jsonl --out docs/kinds.md
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.families.compare_one import KEEP, _plain, _report
from benchmarks.families.run import read
from benchmarks.kinds.draws import FAMILIES, draw
from benchmarks.kinds.scoring import score
from benchmarks.kinds.table import page


def main(arguments: list[str] | None = None) -> None:
    options = _parser().parse_args(arguments)
    if options.do == "page":
        lines = list(read(options.file))
        text = page(lines)
        if options.out:
            options.out.write_text(text)
        else:
            print(text)
        return
    have = {line["label"] for line in read(options.out)} if options.out.exists() else set()
    for number in range(options.first, options.first + options.scans):
        for family in options.families.split(","):
            if f"{family} {number}" not in have:
                line = one(family, number, options.seed, options.points)
                with options.out.open("a") as file:
                    file.write(json.dumps(line) + "\n")
                print(line["label"], line["what"], line.get("failed") or f"{line['seconds']:.1f} s", file=sys.stderr, flush=True)


def one(family: str, number: int, seed: int, count: int) -> dict[str, Any]:
    """Make one scan, compare it, score it."""
    import gearwear
    from gearwear.api import compare
    from gearwear.design import parse_design

    drawn = draw(family, number, seed, count)
    line: dict[str, Any] = {
        key: drawn.truth[key] for key in ("label", "family", "what", "size_um", "order", "noise_um", "volume_mm3")
    }
    line |= {"study_seed": seed, "study_points": count, "version": gearwear.__version__, "design": drawn.design}
    begun = time.process_time()
    with tempfile.TemporaryDirectory(prefix="kinds-") as folder:
        file = Path(folder) / "scan.xyz"
        np.savetxt(file, drawn.points, fmt="%.6f")
        try:
            report = _report(compare(parse_design({"gear": drawn.design}), file, inspection=False))
            line["score"] = score(_plain({key: report[key] for key in KEEP if key in report}), drawn.truth)
        except Exception as error:  # one scan that breaks the fit is a result, not the end of the study
            line["failed"] = f"{type(error).__name__}: {error}".replace(str(file), "scan.xyz")
    return line | {"seconds": time.process_time() - begun}


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.kinds", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    ways = parser.add_subparsers(dest="do", required=True)
    run = ways.add_parser("run", help="make, compare and score; one JSON line each, resumable")
    run.add_argument("--families", default=",".join(FAMILIES), help="with commas")
    run.add_argument("--scans", type=int, default=20, help="of each family")
    run.add_argument("--first", type=int, default=0, help="number of the first scan")
    run.add_argument("--seed", type=int, default=1, help="of the study")
    run.add_argument("--points", type=int, default=40_000, help="of each scan, about")
    run.add_argument("--out", type=Path, required=True, help="JSON lines")
    table = ways.add_parser("page", help="the page of the docs")
    table.add_argument("file", type=Path)
    table.add_argument("--out", type=Path, help="left out: the terminal")
    return parser


if __name__ == "__main__":
    main()
