"""The whole command with the loop against an older version of the program: both in turn, in one run.

python -m benchmarks.speed.since OLD [--rounds 3]

OLD is a folder with that version's files, as `git archive COMMIT | tar x -C OLD` puts them there. The coated scan of the speed measurements is read
and everything written that each writes by default; ratios are medians over the rounds.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path

from benchmarks.speed.timing import command, in_turn, median, ratio
from benchmarks.speed.workload import DESIGN, coated_pinion, write_ply

HERE = Path(__file__).resolve().parents[2]


def main() -> None:
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("old", type=Path)
    p.add_argument("--rounds", type=int, default=3)
    chosen = p.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        scan = write_ply(folder / "scan.ply", coated_pinion().points)
        start = [sys.executable, "-m", "gearwear.compare", str(DESIGN), str(scan), "--quiet", "--out", str(folder / "out")]
        runs = {"old": (chosen.old.resolve(), []), "now": (HERE, []), "now, --no-page": (HERE, ["--no-page"])}
        calls = {
            what: (lambda where=where, more=more: command([*start, *more], PYTHONPATH=str(where))[1])
            for what, (where, more) in runs.items()
        }
        costs = in_turn(chosen.rounds, calls)
        page = (folder / "out" / "report.html").stat().st_size
    print("| version | wall | processor | ratio of wall | ratio of processor | MB |\n|---|---|---|---|---|---|")
    for what, own in costs.items():
        cost, (wall, cpu) = median(own), ratio(own, costs["old"])
        print(f"| {what} | {cost.wall:.1f} s | {cost.cpu:.1f} s | {wall:.2f} | {cpu:.2f} | {cost.peak:.0f} |")
    print(f"page: {page / 1e6:.1f} MB")


if __name__ == "__main__":
    main()
