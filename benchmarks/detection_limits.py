"""Whether wear of the depth and area told would have shown: ``python -m benchmarks.detection_limits run --scans 20 --out limits.jsonl``.

An unworn gear of the generator of `benchmarks.families` is scanned and compared; the program tells each flank's limit. Then the same gear is worn: an
even patch of just that depth and area anywhere on every sixth flank, scanned as before and compared anew, pose, loop and all; six times, so that every
flank has its turn. ``table limits.jsonl`` counts: patches found, by flanks' density, and scans with wear where none is.
"""

from __future__ import annotations

import argparse
import json
import math
import sys
import time
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from scipy.stats import beta

from benchmarks.families import draws
from benchmarks.families.fields import Frame
from benchmarks.families.gear import Array
from benchmarks.families.instrument import RoundGear
from benchmarks.families.part import Part
from benchmarks.families.run import read
from benchmarks.families.scanner import Scanner, scan
from benchmarks.families.scoring import Placement

ROUNDS = 6
"""Times a scan is worn; each flank once. With a third of all flanks worn at once, in a third of their area, the rest is no longer what limits were told of."""
UNEVEN = 0.3
"""Share of the scans whose density varies round the gear, four to ten times: their thin flanks have limits of their own."""


@dataclass(frozen=True)
class Even:
    """An even patch: metal missing `depth` deep between two roll lengths and two heights, with upright walls."""

    tooth: int
    side: int
    depth: float
    rolls: tuple[float, float]
    heights: tuple[float, float]

    def __call__(self, f: Frame, tooth: Array, side: Array, roll: Array, z: Array) -> Array:
        here = (tooth == self.tooth) & (side == self.side)
        here &= (roll >= self.rolls[0]) & (roll <= self.rolls[1]) & (z >= self.heights[0]) & (z <= self.heights[1])
        return np.where(here, -self.depth, 0.0)


def patch(rng: np.random.Generator, f: Frame, tooth: int, side: int, depth: float, area: float) -> Even:
    """A square of that area, or as wide as the flank is, anywhere on it."""
    reach = (f.tip**2 - f.form**2) / (2.0 * f.base)
    across = min(math.sqrt(area), reach)
    along = min(area / across, f.width)
    low, start = float(rng.uniform(0.0, reach - across)), float(rng.uniform(0.0, f.width - along))
    first, last = (math.sqrt(f.form**2 + 2.0 * f.base * arc) for arc in (low, low + across))
    return Even(tooth, side, depth, (first, last), (start, start + along))


def compared(design: Path, part: Part, scanner: Scanner, seed: int) -> tuple[Any, Placement]:
    """Wear that gearwear finds, and how its teeth lie to the true ones."""
    import gearwear as gw

    made = scan(part, scanner, seed)
    measured = gw.find_effects(gw.register(gw.read_design(design), gw.as_scan(made.files[0])))
    rotation, translation = made.poses[0]
    truth = {"poses": [{"R": rotation.tolist(), "t": translation.tolist()}], "gear": {"teeth": part.gear.teeth}}
    return gw.find_wear(measured), Placement.of({"rotation": measured.pose.rotation}, truth)


def one(number: int, seed: int, points: int, folder: Path) -> dict[str, Any]:
    """One gear: its limits, and what was found of patches of their depth."""
    rng = np.random.default_rng([seed, number])
    g, tools = draws.gear(rng), (draws.plain_tool(rng),)
    f = draws.frame(g, tools)
    weights = (RoundGear(float(rng.choice([4.0, 10.0])), float(rng.uniform(-math.pi, math.pi)), False),)
    scanner = draws.scanner(rng, g, points, weights=weights if rng.random() < UNEVEN else ())
    design = folder / f"{number}.toml"
    design.write_text(
        "\n".join(["[gear]", *(f"{key} = {value!r}" for key, value in draws.design_of(g, tools[0]).items())]) + "\n"
    )
    begun = time.process_time()
    plain, placement = compared(design, Part(g, tools), scanner, seed + number)
    told = {(one.tooth, int(one.side)): one for one in plain.flanks}
    flanks = [(tooth, side) for tooth in range(g.teeth) for side in (1, -1)]
    rows, false = [], []
    turn = rng.permutation(len(flanks))
    for round_ in range(ROUNDS):
        wear, where = [], {}
        for tooth, side in (flanks[i] for i in turn[round_::ROUNDS]):
            limit = told[placement.flank(tooth, side, g.teeth)]
            if limit.says:
                wear.append(patch(rng, f, tooth, side, limit.depth, limit.area))
                where[tooth, side] = limit
        seen, place = compared(design, Part(g, tools, (), tuple(wear)), replace(scanner), seed + number)
        found = {(one.tooth, int(one.side)) for one in seen.regions}
        there = {place.flank(tooth, side, g.teeth): limit for (tooth, side), limit in where.items()}
        rows += [{"depth_um": 1e3 * limit.depth, "area_mm2": limit.area, "found": at in found} for at, limit in there.items()]
        false.append(len(found - set(there)))
    depths = [1e3 * one.depth for one in plain.flanks if one.says]
    return {
        "number": number, "seed": seed, "points": points, "uneven": bool(scanner.weights), "teeth": g.teeth, "module": g.module,
        "false_unworn": len(plain.regions), "false_worn": false, "patches": rows, "silent": sum(not one.says for one in plain.flanks),
        "limit_um": [min(depths, default=math.nan), max(depths, default=math.nan)], "noise_um": 1e3 * scanner.noise,
        "seconds": round(time.process_time() - begun, 1),
    }  # fmt: skip


def table(lines: list[dict[str, Any]]) -> str:
    """What a study found, as a table."""
    rows = [
        "| scans | patches found | unworn scans with wear | worn scans with wear elsewhere | flanks that say nothing |",
        "|---|---|---|---|---|",
    ]
    for name, chosen in (
        ("all", lines),
        ("even density", [line for line in lines if not line["uneven"]]),
        ("uneven density", [line for line in lines if line["uneven"]]),
    ):
        patches = [row["found"] for line in chosen for row in line["patches"]]
        alone = [line["false_unworn"] > 0 for line in chosen]
        worn = [count > 0 for line in chosen for count in line["false_worn"]]
        flanks = sum(2 * line["teeth"] for line in chosen)
        silent = sum(line["silent"] for line in chosen)
        rows.append(f"| {name}: {len(chosen)} | {share(patches)} | {share(alone)} | {share(worn)} | {silent} of {flanks} |")
    return "\n".join(rows)


def share(values: list[bool]) -> str:
    """k of n with the exact 95 % interval (Clopper and Pearson)."""
    k, n = sum(values), len(values)
    if not n:
        return "–"
    low = float(beta.ppf(0.025, k, n - k + 1)) if k else 0.0
    high = float(beta.ppf(0.975, k + 1, n - k)) if k < n else 1.0
    return f"{100.0 * k / n:.1f} % ({k} of {n}; {100.0 * low:.1f} … {100.0 * high:.1f})"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    ways = parser.add_subparsers(dest="do", required=True)
    run = ways.add_parser("run", help="make and compare scans; one JSON line each, resumable")
    run.add_argument("--scans", type=int, default=20)
    run.add_argument("--seed", type=int, default=1)
    run.add_argument("--points", type=int, default=40_000)
    run.add_argument("--out", type=Path, required=True)
    ways.add_parser("table", help="what was found").add_argument("file", type=Path)
    options = parser.parse_args()
    if options.do == "table":
        print(table(list(read(options.file))))
        return
    have = {line["number"] for line in read(options.out)} if options.out.exists() else set()
    options.out.parent.mkdir(parents=True, exist_ok=True)
    with options.out.open("a") as file:
        for number in range(options.scans):
            if number not in have:
                line = one(number, options.seed, options.points, options.out.parent)
                file.write(json.dumps(line) + "\n")
                file.flush()
                hits = [row["found"] for row in line["patches"]]
                print(f"scan {number}: {sum(hits)} of {len(hits)} found, {line['seconds']} s", file=sys.stderr, flush=True)


if __name__ == "__main__":
    main()
