"""Growth with the gear: time of the loop, processor time of the whole command, and memory, over sizes of gears.

python -m benchmarks.speed.gears [--folder FOLDER] [--commands]

Scans of 500,000 points are simulated once and kept in FOLDER. Each gear is measured in a process of its own; times are of the processor and told as
ratios to the smallest gear (the loop), or with `--commands` to the bundled example (the whole command), all in this run. What numba has not compiled yet
is compiled before anything is measured: ten seconds and 280 MB of the first command after an installation, and of none after it.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from tests.synthetic import PINION, SlidingWear, make_scan
from tests.synthetic.make_example import RECIPE

POINTS = 500_000
SPREAD = 0.15
"""How much more or less than the mean a tooth is worn, at most."""


@dataclass(frozen=True, slots=True)
class Size:
    """A gear and how many points are scanned of it; mm."""

    teeth: int
    module: float
    width: float
    points: int = POINTS

    @property
    def design(self) -> str:
        return f"[gear]\nteeth = {self.teeth}\nmodule = {self.module}\nface_width = {self.width}\nrack_tip_radius = 0.3\n"

    def scan(self, folder: Path) -> Path:
        """A coated, worn gear on a turntable whose angle is off, kept in a folder."""
        file = folder / f"{self.teeth}_{self.module:g}_{self.width:g}_{self.points}.npy"
        if not file.exists():
            shares = np.random.default_rng(self.teeth).uniform(1.0 - SPREAD, 1.0 + SPREAD, self.teeth)
            recipe = replace(
                RECIPE, gear=replace(PINION, teeth=self.teeth, module=self.module, face_width=self.width), holes=(),
                wear=(SlidingWear(75.0, 1, tuple(shares.tolist()), "archard"),),
            )  # fmt: skip
            np.save(file, make_scan(recipe.of_size(round(self.points / (1.0 - recipe.lost))), 7).points.astype("f4"))
        return file


SIZES = (Size(12, 6.35, 15.0), Size(25, 3.0, 30.0), Size(50, 3.0, 40.0), Size(80, 3.0, 60.0), Size(150, 3.0, 100.0))
WHOLE = (Size(80, 3.0, 60.0), Size(25, 3.0, 30.0, 780_000))
LOOP = """
import json, resource, sys, time
import numpy as np
from gearwear.comparison.closing import find_effects
from gearwear.comparison.measured_gear import register
from gearwear.design import read_design
from gearwear.scan.types import Scan
points = np.load(sys.argv[2]).astype(float)
placed = register(read_design(sys.argv[1]), Scan(points, None, None, "cloud", (), {}, np.zeros(len(points), np.int8)))
begun = time.process_time()
loop = find_effects(placed).loop
effects = {one.name: [[p.value, p.std] for p in one.parameters.values() if p.std] for one in loop.effects}
print(json.dumps({"cells": placed.first.grid.count, "loop": time.process_time() - begun, "effects": effects,
                  "peak": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * (1 if sys.platform == "darwin" else 1024) / 1e6}))
"""

COMPILED = """
import numpy as np
from gearwear import compiled
from gearwear.design import read_design
from gearwear.design.surface import locate
from gearwear.commands.inputs import bundled_example
from gearwear.placing.cells import CellGrid, bin_points
with bundled_example() as folder:
    gear = read_design(folder / "design.toml").gears["pinion"]
points = np.random.default_rng(0).uniform(-gear.tip_radius, gear.tip_radius, (compiled.LEAST, 3))
bin_points(locate(points, gear), CellGrid.for_scan(gear, compiled.LEAST))
"""


def measured_loop(size: Size, folder: Path) -> dict[str, object]:
    """Cells, seconds, MB and what was found."""
    (folder / "design.toml").write_text(size.design)
    told = subprocess.run(
        [sys.executable, "-c", LOOP, str(folder / "design.toml"), str(size.scan(folder))],
        capture_output=True,
        text=True,
        check=True,
    )
    found: dict[str, object] = json.loads(told.stdout)
    return found


def compile_loops() -> None:
    """Have numba compile and keep what large scans need, in a process of its own."""
    subprocess.run([sys.executable, "-c", COMPILED], check=True)


def measured_command(arguments: list[str], out: Path) -> tuple[float, float]:
    """Processor seconds and peak MB of a comparison."""
    child = subprocess.Popen([sys.executable, "-m", "gearwear.compare", *arguments, "--out", str(out), "--quiet"])
    _, status, used = os.wait4(child.pid, 0)
    if status:
        raise SystemExit(f"compare {' '.join(arguments)} failed")
    return used.ru_utime + used.ru_stime, used.ru_maxrss * (1 if sys.platform == "darwin" else 1024) / 1e6


def main() -> None:
    p = argparse.ArgumentParser(description=__doc__)
    p.add_argument("--folder", type=Path, default=Path(tempfile.gettempdir()) / "gears")
    p.add_argument("--commands", action="store_true")
    p.add_argument("--teeth", type=int, nargs="*", help="these sizes alone")
    chosen = p.parse_args()
    folder: Path = chosen.folder
    folder.mkdir(parents=True, exist_ok=True)
    compile_loops()
    if chosen.commands:
        from benchmarks.speed.workload import write_ply

        base, peak = measured_command([], folder / "out")
        print(f"| the bundled example | 1.00 ({base:.1f} s) | {peak:.0f} |")
        for size in WHOLE:
            (folder / "design.toml").write_text(size.design)
            scan = write_ply(folder / "scan.ply", np.load(size.scan(folder)))
            used, peak = measured_command([str(folder / "design.toml"), str(scan)], folder / "out")
            print(
                f"| {size.teeth} teeth, {size.width:g} mm, {size.points:,} points | {used / base:.2f} | {peak:.0f} |", flush=True
            )
        return
    first = None
    for size in SIZES:
        if chosen.teeth and size.teeth not in chosen.teeth:
            continue
        found = measured_loop(size, folder)
        seconds, peak = float(str(found["loop"])), float(str(found["peak"]))
        first = first or seconds
        print(
            f"| {size.teeth} | {size.module:g} | {size.width:g} | {found['cells']:,} | {seconds / first:.2f} ({seconds:.1f} s) | {peak:.0f} | {found['effects']} |",
            flush=True,
        )


if __name__ == "__main__":
    main()
