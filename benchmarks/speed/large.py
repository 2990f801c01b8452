"""A scan of tens of millions of points, streamed: processor time and memory of the whole command, beside a scan that fits in memory.

python -m benchmarks.speed.large [--millions 5 50] [--folder DIR] [--held 5]

Files are made one after the other in a folder of their own and deleted behind; 50 million points take 600 MB there. Each line: points, how,
seconds of processor time, microseconds a point, MB at most, the worn volume with its standard deviation.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

from benchmarks.speed.workload import DESIGN
from tests.synthetic import make_scan
from tests.synthetic.make_example import RECIPE, SEED

AT_ONCE = 1_000_000
"""Points made at a time; each million is a scan of the same gear and the same texture, with noise, strays and spacing of its own."""


def write_large(path: Path, millions: int) -> int:
    """A binary PLY of about so many million points of the used, coated pinion; gives their number."""
    recipe = replace(RECIPE, texture_seed=7, jitter=1.0)
    recipe = replace(recipe, pose=make_scan(recipe.of_size(60_000), SEED).truth.poses[0])
    count = 0
    with path.open("wb") as file:
        file.write(_head(0))
        for part in range(millions):
            points = make_scan(recipe.of_size(AT_ONCE), 100 + part).points.astype("<f4")
            file.write(points.tobytes())
            count += len(points)
        file.seek(0)
        file.write(_head(count))
    return count


def _head(count: int) -> bytes:
    head = f"ply\nformat binary_little_endian 1.0\nelement vertex {count:12d}\n"
    return (head + "".join(f"property float {axis}\n" for axis in "xyz") + "end_header\n").encode()


COMMAND = """
import sys
from pathlib import Path
from gearwear.comparison.stations import compare
from gearwear.design.files.toml import read_design
from gearwear.report.write import write_results
design, scan, out = map(Path, sys.argv[1:4])
write_results(compare(read_design(design), [scan], stream=sys.argv[4] == "streamed"), out)
"""


def measured(scan: Path, folder: Path, how: str) -> str:
    """What `compare` with everything it writes by default costs, in a process of its own."""
    out = folder / how
    child = subprocess.Popen([sys.executable, "-c", COMMAND, str(DESIGN), str(scan), str(out), how])
    _, status, used = os.wait4(child.pid, 0)
    if status:
        raise SystemExit(f"the comparison ended with {os.waitstatus_to_exitcode(status)}")
    report = json.loads((out / "report.json").read_text())
    points, volume, seconds = report["scan"]["points"], report["wear"]["volume_mm3"], used.ru_utime + used.ru_stime
    peak = used.ru_maxrss * (1.0 if sys.platform == "darwin" else 1024.0) / 1e6
    return (
        f"{points:>12,} {how:>9} {seconds:8.1f} s {1e6 * seconds / points:7.2f} µs {peak:7.0f} MB"
        f"  {volume['value']:.4f} ± {volume['std']:.4f} mm³"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--millions", type=int, nargs="+", default=[5, 50], help="sizes that are streamed")
    parser.add_argument("--held", type=int, nargs="*", default=[5], help="sizes that are held in memory as well")
    parser.add_argument("--folder", type=Path, default=None, help="where to make the files")
    parser.add_argument("--write", nargs=2, metavar=("FILE", "MILLIONS"), help="make one file and end")
    arguments = parser.parse_args()
    if arguments.write:
        write_large(Path(arguments.write[0]), int(arguments.write[1]))
        return
    for millions in sorted({*arguments.millions, *arguments.held}):
        with tempfile.TemporaryDirectory(dir=arguments.folder) as name:
            scan = Path(name) / "scan.ply"
            # In a process of its own: the peak of a child begins with what its parent holds.
            subprocess.run([sys.executable, "-m", "benchmarks.speed.large", "--write", str(scan), str(millions)], check=True)
            for how, sizes in (("held", arguments.held), ("streamed", arguments.millions)):
                if millions in sizes:
                    print(measured(scan, Path(name), how), flush=True)


if __name__ == "__main__":
    main()
