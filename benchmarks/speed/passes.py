"""What a pass over a streamed scan costs, by numpy and compiled.

python -m benchmarks.speed.passes [--rounds 20]

Prints nanoseconds of processor time a point on one thread, least and median over the rounds, both ways measured in turn: of a whole pass (moved,
located, strays told, added to cells, those for sections picked), of its three steps by separate calls, of `locate`, and of the deviation alone.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from contextlib import AbstractContextManager
from unittest.mock import patch

import numpy as np

from benchmarks.speed.timing import Cost, in_turn, timed
from benchmarks.speed.workload import DESIGN, used_pinion
from gearwear import compiled
from gearwear.arrays import Floats
from gearwear.comparison.collecting import Cut, collected
from gearwear.comparison.on_design import OnDesign
from gearwear.comparison.passes import PassLimits
from gearwear.design.files.toml import read_design
from gearwear.design.gear import Gear
from gearwear.design.surface import Bands, deviations, locate
from gearwear.placing.cells import CellGrid
from gearwear.placing.pose import small_motion
from gearwear.placing.sums import CellSums
from gearwear.wear.section_sums import SectionBand

CHUNK = 1 << 18
"""Points of a chunk by numpy, as a streamed scan has them; compiled they come in parts."""
CLIP = 0.05
"""mm; how far a point may lie from the centre of its cell."""
WAYS = (("numpy", False), ("compiled", True))
MOTION = small_motion(np.array([1e-3, -1e-3, 1e-3, 1e-6, 1e-6, -1e-6]))


def cost(points: Floats, gear: Gear, fast: bool) -> Cost:
    """Of one pass; what it is judged by is made before."""
    with _way(fast):
        put, grid = OnDesign(gear, Bands.wide(gear), 0.01, 0.0, MOTION), CellGrid.for_scan(gear, 10 * len(points))
        by = PassLimits.of_sample(put.located(points[::4]), grid, CLIP)
        cut, chunks = Cut(SectionBand.of(gear)), _chunks(points, fast)
        return timed(lambda: collected(chunks, put, grid, by, cut))[1]


def steps_cost(points: Floats, gear: Gear, fast: bool) -> Cost:
    """Of pose, locate and bin, each by a call of its own."""
    with _way(fast):
        grid, chunks = CellGrid.for_scan(gear, 10 * len(points)), _chunks(points, fast)

        def steps() -> None:
            sums = CellSums.empty(grid.count)
            for chunk in chunks:
                located = locate(MOTION.apply(chunk), gear, workers=1)
                sums.add(located, grid.index(located))

        return timed(steps)[1]


def distance_cost(points: Floats, gear: Gear, fast: bool) -> Cost:
    """Of the deviation of every point and nothing else, on all processors."""
    with _way(fast):
        return timed(lambda: deviations(points, gear))[1]


def alone_cost(points: Floats, gear: Gear, fast: bool) -> Cost:
    """The same on one thread."""
    with _way(fast):
        return timed(lambda: deviations(points, gear, workers=1))[1]


def deviation_cost(points: Floats, gear: Gear, fast: bool) -> Cost:
    """Of the deviation of every point with its foot, normal, tooth and surface."""
    with _way(fast):
        return timed(lambda: locate(points, gear, workers=1))[1]


def _way(fast: bool) -> AbstractContextManager[object]:
    return patch.object(compiled, "LEAST", 0 if fast else 1 << 60)


def _chunks(points: Floats, fast: bool) -> list[Floats]:
    size = compiled.PART if fast else CHUNK
    return [points[start : start + size] for start in range(0, len(points), size)]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=20)
    rounds = parser.parse_args().rounds
    gear, scan = read_design(DESIGN).gears["pinion"], used_pinion()
    points = scan.truth.pose.inverse().apply(scan.points)
    measures: dict[str, Callable[[Floats, Gear, bool], Cost]] = {
        "a pass": cost, "pose, locate, bin": steps_cost, "locate": deviation_cost, "deviation alone": alone_cost
    }  # fmt: skip
    for name, measure in measures.items():
        got = in_turn(rounds, {way: lambda fast=fast, measure=measure: measure(points, gear, fast) for way, fast in WAYS})
        for way, costs in got.items():
            each = 1e9 * np.array([one.cpu for one in costs]) / len(points)
            print(f"{name:>18} {way:>9} {each.min():6.1f} ns, median {np.median(each):6.1f}")


if __name__ == "__main__":
    main()
