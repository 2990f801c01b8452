"""Time and memory of the deviation of many points, one process.

python -m benchmarks.speed.growth DESIGN.toml POINTS.npy COUNT

Prints a JSON line: seconds of wall and processor time, and MB needed beside the points and the result.
"""

from __future__ import annotations

import json
import resource
import sys
from dataclasses import fields

import numpy as np

from benchmarks.speed.timing import timed
from gearwear.compiled import parts_of
from gearwear.design.files.toml import read_design
from gearwear.design.surface import locate


def peak() -> float:
    """Largest resident memory so far, MB."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * (1.0 if sys.platform == "darwin" else 1024.0) / 1e6


def main(design: str, file: str, count: str) -> dict[str, float]:
    gear = read_design(design).gears["pinion"]
    some = np.load(file)
    points = np.empty((int(count), 3))
    for start in range(0, len(points), len(some)):
        points[start : start + len(some)] = some[: len(points) - start]
    with parts_of(len(points)):
        locate(points[:1000], gear)  # compiled loops are loaded at the first call that is worth them
    before = peak()
    found, cost = timed(lambda: locate(points, gear))
    result = sum(getattr(found, field.name).nbytes for field in fields(found)) / 1e6
    return {"wall": cost.wall, "cpu": cost.cpu, "beside_mb": peak() - before - result}


if __name__ == "__main__":
    print(json.dumps(main(*sys.argv[1:])))
