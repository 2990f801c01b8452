"""How true volumes of pits, grooves and burrs are, and their ±: ``python -m benchmarks.local_damage run --scans 32 --out damage.jsonl``.

Gears of the generator of `benchmarks.families`, with damage of one kind whose size against the spacing of points and whose depth against their noise
differ from flank to flank: bowl-shaped pits, grooves along the profile, a burr along the tips of a worn side; and scans without any. Every scan is
compared as a user's is. ``table damage.jsonl …`` has truth beside value, with the error in stated standard deviations; several files side by side.
"""

from __future__ import annotations

import argparse
import json
import math
import sys
import time
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.families import draws
from benchmarks.families.fields import Burr, Field, Frame, Pits, Rows, Scores
from benchmarks.families.gear import Array
from benchmarks.families.part import Part
from benchmarks.families.run import read
from benchmarks.families.sampling import FLANK, sample
from benchmarks.families.scanner import Scanner, scan
from benchmarks.families.scoring import Placement
from benchmarks.families.truth import flank_volume

KINDS = ("pits", "grooves", "burr", "none")
WIDTHS = (0.5, 1.0, 2.0, 4.0)
"""Radius of pits and half width of grooves, in spacings of points."""
DEPTHS = (4.0, 8.0, 16.0, 32.0)
"""In standard deviations of a point."""
FINE = 0.006
"""Step of the integration of the truth, modules."""


def spacing(part: Part, points: int) -> float:
    """Square root of the area of flank that one point of a scan has, mm."""
    f, gear = part.frame, part.gear
    area = 2 * gear.teeth * gear.face_width * (f.tip**2 - f.form**2) / (2.0 * f.base)
    probe = sample(part, 20_000, np.random.default_rng(0))
    return math.sqrt(area / (points * float((probe.kind == FLANK).mean())))


def pits(rng: np.random.Generator, f: Frame, flank: tuple[int, int], radius: float, depth: float) -> Rows:
    """A cluster on one flank: fewer where they are large, on about a twelfth of a square of half the flank's size."""
    low, high = f.form + 1.5 * radius, f.tip - 1.5 * radius
    number = int(np.clip(0.02 * f.width * (f.tip - f.form) / radius**2, 5, 40))
    middle = float(rng.uniform(0.3, 0.7)) * f.width
    return tuple(
        (*map(float, flank), float(rng.uniform(low, high)), float(np.clip(rng.normal(middle, 0.15 * f.width), 1.5 * radius, f.width - 1.5 * radius)), radius, depth)
        for _ in range(number)
    )  # fmt: skip


def grooves(rng: np.random.Generator, f: Frame, flank: tuple[int, int], half: float, depth: float) -> Rows:
    """Grooves along the profile of one flank: fewer where they are wide."""
    number = int(np.clip(0.06 * f.width / half, 2, 12))
    return tuple(
        (*map(float, flank), float(rng.uniform(2.0 * half, f.width - 2.0 * half)), 2.0 * half, depth) for _ in range(number)
    )


def damaged(rng: np.random.Generator, kind: str, points: int) -> tuple[Part, Scanner, dict[tuple[int, int], tuple[float, float]]]:
    """A part, its scanner, and what each damaged flank has: width in spacings, depth in standard deviations of a point."""
    g, tools = draws.gear(rng), (draws.plain_tool(rng),)
    f, scanner = draws.frame(g, tools), draws.scanner(rng, g, points)
    apart = spacing(Part(g, tools), points)
    flanks = [(int(i) // 2, 1 if i % 2 else -1) for i in rng.permutation(2 * g.teeth)]
    sizes = [(w, d) for w, d in product(WIDTHS, DEPTHS) if d * scanner.noise < min(w * apart, 0.09 * g.module)]
    chosen = [sizes[i] for i in rng.permutation(len(sizes))[:8]]
    has = dict(zip(flanks, chosen, strict=False))
    made: tuple[Field, ...] = ()
    wear: tuple[Field, ...] = ()
    if kind in ("pits", "grooves"):
        one = pits if kind == "pits" else grooves
        rows = tuple(row for flank, (w, d) in has.items() for row in one(rng, f, flank, w * apart, d * scanner.noise))
        wear = (Pits(rows) if kind == "pits" else Scores(rows),)
    elif kind == "burr":
        side, depth = int(rng.choice([-1, 1])), draws.log_uniform(rng, 0.008, 0.03) * g.module
        wear = (draws.sliding(rng, f, side, depth, False),)
        height, width = depth * draws.log_uniform(rng, 0.3, 3.0), apart * draws.log_uniform(rng, 0.5, 2.0)
        made = (Burr(side, height, width, float(rng.uniform(0.0, 6.0))),)
        has = {(tooth, side): (width / apart, height / depth) for tooth in range(g.teeth)}
    else:
        has = {}
    return Part(g, tools, made, wear), scanner, has


def one(number: int, seed: int, points: int, folder: Path) -> dict[str, Any]:
    """One scan: what was put in, flank by flank, and what was found of it."""
    import gearwear as gw

    kind = KINDS[number % len(KINDS)]
    rng = np.random.default_rng([seed, number])
    part, scanner, has = damaged(rng, kind, points)
    g, begun = part.gear, time.process_time()
    made = scan(part, scanner, seed + number)
    design = folder / f"{number}.toml"
    design.write_text(
        "\n".join(["[gear]", *(f"{key} = {value!r}" for key, value in draws.design_of(g, part.tools[0]).items())]) + "\n"
    )
    points_file = folder / f"{number}.xyz"
    np.savetxt(points_file, made.files[0], fmt="%.6f")
    results = gw.compare(design, [points_file], inspection=False)
    wear = results.wear.found
    rotation, translation = made.poses[0]
    truth = {"poses": [{"R": rotation.tolist(), "t": translation.tolist()}], "gear": {"teeth": g.teeth}}
    place = Placement.of({"rotation": results.measured.pose.rotation}, truth)
    told = {(region.tooth, int(region.side)): region for region in wear.regions}
    limit = {(flank.tooth, int(flank.side)): flank for flank in wear.flanks}
    rows = []
    for flank, (width, depth) in has.items():
        at = place.flank(*flank, g.teeth)
        region, true = told.pop(at, None), flank_volume(part, *flank, FINE)[0]
        rows.append({
            "width": width, "depth": depth, "true": true, "value": None if region is None else region.volume,
            "std": None if region is None else region.volume_std, "limit_um": 1e3 * limit[at].depth if limit[at].says else None,
        })  # fmt: skip
    between = results.volume_range
    return {
        "number": number, "seed": seed, "points": points, "kind": kind, "noise_um": 1e3 * scanner.noise, "strays": scanner.strays,
        "true": sum(row["true"] for row in rows), "value": wear.volume, "std": results.wear.volume_std,
        "high": None if between is None else between[1], "low": None if between is None else between[0], "flanks": rows,
        "false": [[region.volume, region.volume_std] for region in told.values()], "burrs": [[b.volume, b.std] for b in wear.burrs],
        "effects": [effect.name for effect in results.effects], "seconds": round(time.process_time() - begun, 1),
    }  # fmt: skip


def table(files: dict[str, list[dict[str, Any]]]) -> str:
    """What studies found, side by side."""
    rows = ["| what | " + " | ".join(files) + " |", "|---|" + "---|" * len(files)]

    def row(what: str, of: Any) -> None:
        rows.append(f"| {what} | " + " | ".join(of(lines) for lines in files.values()) + " |")

    for kind in KINDS[:3]:
        row(f"**{kind}**: scans within 3 stated deviations, or the range", lambda lines, kind=kind: _scans(lines, kind))
        row(
            f"{kind}, flanks: found; of these volume over truth; error in deviations, RMS; within 3",
            lambda lines, kind=kind: _flanks(_of(lines, kind)),
        )
        if kind == "burr":
            continue
        for width in WIDTHS:
            row(f"{kind}, {width:g} spacings wide", lambda lines, kind=kind, width=width: _flanks(_of(lines, kind, width)))
        for depth in DEPTHS:
            row(
                f"{kind}, {depth:g} deviations deep", lambda lines, kind=kind, depth=depth: _flanks(_of(lines, kind, None, depth))
            )
    row("scans with wear on a flank that has none", lambda lines: f"{sum(bool(line['false']) for line in lines)} of {len(lines)}")
    row("scans without damage: wear found", lambda lines: "{} of {}".format(*_alarms(lines)))
    return "\n".join(rows)


def _of(lines: list[dict[str, Any]], kind: str, width: float | None = None, depth: float | None = None) -> list[dict[str, Any]]:
    return [
        row for line in lines if line["kind"] == kind for row in line["flanks"]
        if (width is None or row["width"] == width) and (depth is None or row["depth"] == depth)
    ]  # fmt: skip


def _scans(lines: list[dict[str, Any]], kind: str) -> str:
    own = [line for line in lines if line["kind"] == kind]
    held = [_low(line) <= line["true"] <= _high(line) for line in own]
    return f"{sum(held)} of {len(own)}"


def _low(line: dict[str, Any]) -> float:
    return float(min(line["value"] - 3.0 * line["std"], line["value"] if line["low"] is None else line["low"]))


def _high(line: dict[str, Any]) -> float:
    return float(max(line["value"] + 3.0 * line["std"], line["value"] if line["high"] is None else line["high"]))


def _flanks(rows: list[dict[str, Any]]) -> str:
    known = [row for row in rows if row["value"] is not None]
    if not known:
        return f"0 of {len(rows)}"
    pull: Array = np.array([(row["value"] - row["true"]) / row["std"] for row in known])
    ratio = sum(row["value"] for row in known) / sum(row["true"] for row in known)
    size = math.sqrt(float((pull**2).mean()))
    return f"{len(known)} of {len(rows)}; {ratio:.2f}; mean {pull.mean():+.1f}, RMS {size:.1f}; {int((np.abs(pull) < 3.0).sum())}"


def _alarms(lines: list[dict[str, Any]]) -> tuple[int, int]:
    own = [line for line in lines if line["kind"] == "none"]
    return sum(bool(line["false"]) for line in own), len(own)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    ways = parser.add_subparsers(dest="do", required=True)
    run = ways.add_parser("run", help="make and compare scans; one JSON line each, resumable")
    run.add_argument("--scans", type=int, default=32)
    run.add_argument("--seed", type=int, default=1)
    run.add_argument("--points", type=int, default=30_000)
    run.add_argument("--out", type=Path, required=True)
    ways.add_parser("table", help="what was found").add_argument("files", type=Path, nargs="+")
    options = parser.parse_args()
    if options.do == "table":
        print(table({file.stem: list(read(file)) for file in options.files if file.exists()}))
        return
    have = {line["number"] for line in read(options.out)} if options.out.exists() else set()
    options.out.parent.mkdir(parents=True, exist_ok=True)
    with options.out.open("a") as out:
        for number in range(options.scans):
            if number not in have:
                line = one(number, options.seed, options.points, options.out.parent)
                out.write(json.dumps(line) + "\n")
                out.flush()
                print(
                    f"{number} {line['kind']}: {line['true']:.3f} → {line['value']:.3f} ± {line['std']:.3f}, {line['seconds']} s",
                    file=sys.stderr,
                    flush=True,
                )


if __name__ == "__main__":
    main()
