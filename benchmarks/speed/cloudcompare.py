"""CloudCompare's cloud-to-mesh distance from its command line, timed by its own log."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

from benchmarks.speed.timing import command

PROGRAM = shutil.which("CloudCompare") or shutil.which("cloudcompare.CloudCompare")


def distances(cloud: Path, triangles: Path) -> tuple[float, float, float]:
    """Seconds CloudCompare takes for the distances alone, and with the rough distances it takes first to choose its octree level; and of the
    latter the processor time, over all threads: what the command takes more than one that only reads both files.

    Raises
    ------
    RuntimeError
        If it fails, or its log says no times.
    """
    reading = [str(PROGRAM), "-SILENT", "-AUTO_SAVE", "OFF", "-O", str(cloud), "-O", str(triangles)]
    _, without = command(reading, QT_QPA_PLATFORM="offscreen")
    log, cost = command([*reading, "-C2M_DIST"], QT_QPA_PLATFORM="offscreen")
    rough, exact = (re.search(rf"\[{step}\] Time: ([0-9.]+) s", log) for step in ("computeApproxDistances", "ComputeDistances"))
    if rough is None or exact is None:
        raise RuntimeError(f"CloudCompare's log says no times: {log[-1000:]}")
    return float(exact[1]), float(exact[1]) + float(rough[1]), cost.cpu - without.cpu
