"""Make a fleet: gears that wear as they run, scanned at some inspections, and a gauge study of others. Imports nothing of gearwear.

A gear wears by patches that deepen in proportion to its cycles, some gears by sliding besides; each has a rate of its own. In the gauge
study every operator scans every gear some times: poses and noise are drawn anew for each scan, a coat of spray for each operator.
"""

from __future__ import annotations

import csv
from collections.abc import Iterator
from dataclasses import dataclass
from datetime import date, timedelta
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.families.draws import frame
from benchmarks.families.fields import Field, Hollow, Sliding
from benchmarks.families.files import write_ply
from benchmarks.families.gear import GearNumbers, flank_point
from benchmarks.families.instrument import Coat
from benchmarks.families.part import Part
from benchmarks.families.rack import Tool
from benchmarks.families.scanner import Scanner, scan
from benchmarks.families.truth import layer_area, truth
from benchmarks.families.views import Views

GEAR = GearNumbers(16, 3.0, 10.0, thinning=0.06)
TOOL = Tool(1.25, 0.38)
DESIGN = """\
[pinion]
teeth = 16
module = 3.0
face_width = 10.0
rack_tip_radius = 0.38
thinning = 0.06

[gear]
teeth = 24
thinning = 0.06

[limits]
wear_depth_mm = 0.12
wear_volume_mm3 = 3.0
thickness_loss_mm = 0.14
backlash_mm = 0.16
"""
SECTION_DESIGN = f"[gear]\n{DESIGN.split('[gear]')[0].removeprefix('[pinion]').strip()}\n\n[limits]\nwear_depth_mm = 0.12\nthickness_loss_mm = 0.14\n"
START = date(2025, 1, 15)
COLUMNS = ("gear_id", "inspected", "design", "scans", "part", "cycles_run", "operator", "repeat", "site")
TRUE = ("wear_volume_mm3", "wear_depth_mm", "thickness_loss_mm")


@dataclass(frozen=True)
class Life:
    """How a gear wears.

    Parameters
    ----------
    patches : tuple of Hollow
        After a million cycles.
    sliding : Sliding or None
        The same.
    cycles_per_day : float
    """

    patches: tuple[Hollow, ...]
    sliding: Sliding | None
    cycles_per_day: float

    def part(self, cycles: float) -> Part:
        """The gear after so many cycles."""
        share = 1e-6 * cycles
        wear: list[Field] = [Hollow(p.tooth, p.side, share * p.depth, p.roll, p.z, p.half_roll, p.half_z) for p in self.patches]
        if self.sliding is not None:
            wear.append(Sliding(self.sliding.side, share * self.sliding.depth, self.sliding.factors))
        return Part(GEAR, (TOOL,), (), tuple(wear))


def drawn_life(rng: np.random.Generator) -> Life:
    """A gear's patches on three to six left flanks, 15 to 130 µm a million cycles at the deepest; every fifth gear slides besides."""
    f = frame(GEAR, (TOOL,))
    depth = float(np.exp(rng.uniform(np.log(0.015), np.log(0.13))))
    span, patches = f.tip - f.form, []
    for i, tooth in enumerate(rng.permutation(GEAR.teeth)[: int(rng.integers(3, 7))]):
        half_roll, half_z = float(rng.uniform(0.3, 0.4)) * span, float(rng.uniform(0.3, 0.45)) * f.width
        at, up = f.form + float(rng.uniform(0.42, 0.58)) * span, float(rng.uniform(0.45, 0.55)) * f.width
        factor = 1.0 if i == 0 else float(rng.uniform(0.3, 0.9))
        patches.append(Hollow(int(tooth), 1, factor * depth, at, up, half_roll, half_z))
    slides = rng.random() < 0.2
    sliding = Sliding(1, 0.4 * depth, tuple(rng.uniform(0.6, 1.4, GEAR.teeth).tolist())) if slides else None
    return Life(tuple(patches), sliding, float(rng.uniform(3e3, 8e3)))


def scanned(part: Part, coat: float, points: int, seed: int) -> np.ndarray[Any, np.dtype[np.float64]]:
    """Points of one scan."""
    scanner = Scanner(points=points, noise=0.004, views=Views(12, (-40.0, 0.0, 40.0)), shifts=(Coat(coat),), pose="mild")
    return scan(part, scanner, seed).files[0]


MIDDLE = 0.5 * GEAR.face_width
"""Height of planar sections, mm."""


def section(part: Part, coat: float, points: int, seed: int) -> np.ndarray[Any, np.dtype[np.float64]]:
    """Points of a planar section in the middle of the face, flanks alone, each point off along its normal."""
    rng, f = np.random.default_rng([seed, 2]), part.frame
    grid = np.meshgrid(
        np.arange(GEAR.teeth, dtype=float), [1.0, -1.0], np.linspace(f.form, f.tip, points // (2 * GEAR.teeth)), indexing="ij"
    )
    tooth, side, roll = (one.ravel() for one in grid)
    out = part.deviation(tooth, side, roll, np.full(len(roll), MIDDLE)) + coat + 0.004 * rng.standard_normal(len(roll))
    return flank_point(GEAR, tooth, side, roll, out)[0]


def true_section(part: Part) -> dict[str, float]:
    """What a perfect report would say of a section."""
    f, area, depth = part.frame, 0.0, 0.0
    roll = np.linspace(f.form, f.tip, 2001)
    for tooth in range(GEAR.teeth):
        for side in (1.0, -1.0):
            loss = part.loss(np.full(len(roll), float(tooth)), np.full(len(roll), side), roll, np.full(len(roll), MIDDLE))
            area += float(np.trapezoid(layer_area(part, roll, np.zeros(len(roll)), loss), roll))
            depth = max(depth, -float(loss.min()))
    tooth = np.arange(GEAR.teeth, dtype=float)
    z, lost = np.full(GEAR.teeth, MIDDLE), np.zeros(GEAR.teeth)
    for side in (1.0, -1.0):
        s = np.full(GEAR.teeth, side)
        foot = part.foot(tooth, s, np.full(GEAR.teeth, f.reference), z)
        lost -= GEAR.reference_radius * part.loss(tooth, s, foot, z) / GEAR.base_radius
    return {"wear_area_mm2": area, "wear_depth_mm": depth, "thickness_loss_mm": float(lost.max())}


def true_values(part: Part) -> dict[str, float]:
    """What a perfect report would say; the depth as a mean over half a millimetre is the peak of these smooth patches but for 1 %."""
    t = truth(part)
    loss = t.thickness["made"] - t.thickness["least_mean"]
    return {
        "wear_volume_mm3": t.volume,
        "wear_depth_mm": max((one["depth_mm"] for one in t.flanks), default=0.0),
        "thickness_loss_mm": float(np.max(loss)),
    }


def rows(
    gears: int, inspections: int, parts: int, operators: int, repeats: int, seed: int
) -> Iterator[tuple[dict[str, Any], Part, float, int]]:
    """Row of the manifest, the gear as it is, thickness of the coat (mm) and seed of each scan."""
    rng = np.random.default_rng(seed)
    number = 0
    for g in range(gears):
        life, site = drawn_life(rng), str(rng.choice(["north", "south"]))
        for i in range(inspections):
            days = 60 * (i + 1) + int(rng.integers(-5, 6))
            cycles = round(life.cycles_per_day * days)
            number += 1
            row = {
                "gear_id": f"G{g + 1:03d}", "inspected": (START + timedelta(days)).isoformat(), "cycles_run": cycles, "operator": "A",
                "repeat": 1, "site": site,
            }  # fmt: skip
            yield row, life.part(cycles), float(rng.uniform(0.005, 0.015)), 1000 * seed + number
    coats = [0.006 + 0.006 * o for o in range(operators)]
    for p in range(parts):
        life = drawn_life(rng)
        part = life.part(1.2e6)
        for o in range(operators):
            for r in range(repeats):
                number += 1
                row = {
                    "gear_id": f"R{p + 1:02d}", "inspected": START.isoformat(), "cycles_run": 1_200_000, "operator": "ABCDEFGH"[o],
                    "repeat": r + 1, "site": "laboratory",
                }  # fmt: skip
                yield row, part, coats[o], 1000 * seed + number


def make_fleet(
    folder: Path,
    gears: int = 30,
    inspections: int = 5,
    parts: int = 6,
    operators: int = 3,
    repeats: int = 3,
    points: int = 20_000,
    seed: int = 1,
    planar: bool = False,
) -> Path:
    """Write design, scans, manifest and truth.

    Parameters
    ----------
    folder : Path
    gears, inspections : int
        Gears that run, and how often each is scanned.
    parts, operators, repeats : int
        Of the gauge study.
    points : int
        Of a scan.
    seed : int
    planar : bool
        Whether the scans are planar sections; then of the pinion alone.

    Returns
    -------
    Path
        The manifest, ``fleet.csv``; ``truth.csv`` lies beside it.
    """
    (folder / "scans").mkdir(parents=True, exist_ok=True)
    (folder / "design.toml").write_text(SECTION_DESIGN if planar else DESIGN)
    manifest, true = [], []
    for row, part, coat, number in rows(gears, inspections, parts, operators, repeats, seed):
        name = f"scans/{row['gear_id']}_{row['inspected']}_{row['operator']}{row['repeat']}"
        if planar:
            name += ".xyz"
            np.savetxt(folder / name, section(part, coat, points, number), fmt="%.5f")
        else:
            name += ".ply"
            write_ply(folder / name, scanned(part, coat, points, number))
        manifest.append({**row, "design": "design.toml", "scans": name, "part": "" if planar else "pinion"})
        values = true_section(part) if planar else true_values(part)
        true.append({key: row[key] for key in ("gear_id", "inspected", "cycles_run", "operator", "repeat")} | values)
    for name, found in (("fleet.csv", manifest), ("truth.csv", true)):
        with (folder / name).open("w", newline="") as stream:
            writer = csv.DictWriter(stream, COLUMNS if name == "fleet.csv" else list(found[0]), lineterminator="\n")
            writer.writeheader()
            writer.writerows(found)
    return folder / "fleet.csv"
