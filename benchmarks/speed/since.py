"""The whole command with the loop against an older version of the program: both in turn, in one run.

python -m benchmarks.speed.since OLD [OLD …] [--rounds 3] [--stages]

OLD is a folder with that version's files, as `git archive COMMIT | tar x -C OLD` puts them there; what it needs must be installed (0.1.0: plotly). The
coated scan of the speed measurements is read and everything written that each writes by default; ratios are medians over the rounds, to the first OLD.
`--stages` tells the processor seconds of each stage, those of helpers in the stage in which they end.
"""

from __future__ import annotations

import argparse
import compileall
import os
import re
import statistics
import subprocess
import sys
import tempfile
from functools import partial
from pathlib import Path

from benchmarks.speed.timing import command, in_turn, median, ratio
from benchmarks.speed.workload import DESIGN, coated_pinion, write_ply

HERE = Path(__file__).resolve().parents[2]
BY_PROCESSOR = """
import os, runpy, sys, time
time.perf_counter = lambda: sum(os.times()[:4])
try:
    runpy.run_module("gearwear.compare", run_name="__main__")
finally:
    print(f"all  {sum(os.times()[:4])} s", file=sys.stderr)
"""
"""Starts a version with the clock of its stations replaced by processor time, its helpers' too."""


def version_at(folder: Path) -> dict[str, str]:
    """Environment in which `python -m gearwear…` runs that folder's version: without the working folder, which comes first otherwise."""
    environment = {"PYTHONPATH": str(folder), "PYTHONSAFEPATH": "1"}
    asked = [sys.executable, "-c", "import gearwear; print(gearwear.__file__)"]
    file = subprocess.run(asked, env=os.environ | environment, capture_output=True, text=True, check=True).stdout.strip()
    if not Path(file).is_relative_to(folder):
        raise SystemExit(f"{file} would be measured, not the version in {folder}")
    # As pip does with what it installs: where no bytecode is to be written, every start would compile anew, the longer the larger the version.
    compileall.compile_dir(folder / "gearwear", quiet=1)
    return environment


def stages(start: list[str], version: dict[str, str]) -> dict[str, float]:
    """Processor seconds by stage of one run, `all` with what comes before the first."""
    told, _ = command([sys.executable, "-c", BY_PROCESSOR, *start], **version)
    lines = (re.fullmatch(r"(\S.*?) +([0-9.]+) s", line) for line in told.splitlines())
    return {line[1]: float(line[2]) for line in lines if line is not None}


def main() -> None:
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("old", type=Path, nargs="+")
    p.add_argument("--rounds", type=int, default=3)
    p.add_argument("--stages", action="store_true")
    chosen = p.parse_args()
    versions = {str(old): version_at(old.resolve()) for old in chosen.old} | {"now": version_at(HERE)}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        scan = write_ply(folder / "scan.ply", coated_pinion().points)
        files = [str(DESIGN), str(scan), "--out", str(folder / "out")]
        if chosen.stages:
            calls = {what: partial(stages, [*files, "--verbose"], version) for what, version in versions.items()}
            print(by_stage(in_turn(chosen.rounds, calls)))
            return
        whole = [sys.executable, "-m", "gearwear.compare", *files, "--quiet"]
        runs = {what: partial(command, whole, **version) for what, version in versions.items()}
        runs["now, --no-page"] = partial(command, [*whole, "--no-page"], **versions["now"])
        costs = {what: [cost for _, cost in told] for what, told in in_turn(chosen.rounds, runs).items()}
        page = (folder / "out" / "report.html").stat().st_size
    print("| version | wall | processor | ratio of wall | ratio of processor | MB |\n|---|---|---|---|---|---|")
    for what, own in costs.items():
        cost, (wall, cpu) = median(own), ratio(own, costs[str(chosen.old[0])])
        print(f"| {what} | {cost.wall:.1f} s | {cost.cpu:.1f} s | {wall:.2f} | {cpu:.2f} | {cost.peak:.0f} |")
    print(f"page: {page / 1e6:.1f} MB")


def by_stage(rounds: dict[str, list[dict[str, float]]]) -> str:
    """The table: a row a stage, a column a version, means over the rounds."""
    names = dict.fromkeys(stage for runs in rounds.values() for stage in runs[0])
    rows = [["stage", *rounds], ["---"] * (1 + len(rounds))]
    for stage in names:
        seconds = ([run.get(stage) for run in runs] for runs in rounds.values())
        rows.append([stage, *("" if one[0] is None else f"{statistics.mean(one):.2f}" for one in seconds)])
    return "\n".join(f"| {' | '.join(row)} |" for row in rows)


if __name__ == "__main__":
    main()
