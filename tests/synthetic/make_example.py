"""Write the bundled example: a used pinion of the paper's pair, scanned with all that goes with it, and its truth.

python -m tests.synthetic.make_example [FOLDER]
"""

from __future__ import annotations

import gzip
import json
import sys
from pathlib import Path

from tests.synthetic import Effect, Hole, Patch, Recipe, SlidingWear, SyntheticScan, Texture, make_scan
from tests.synthetic.outline import Floats

SEED = 20140814
RECIPE = Recipe(
    noise_um=10.0,
    texture=Texture(2.0, 1.0),
    outliers=0.0005,
    lost=0.02,
    holes=(Hole(7, -1, 40.0, 11.0, 2.0),),
    jitter=1.0,
    wear=(
        # drive flanks, as deep as the specific sliding; each tooth a little different
        SlidingWear(75.0, 1, (1.05, 0.93, 1.12, 0.85, 1.00, 1.08, 0.90, 1.15, 0.97, 0.82, 1.03, 1.10), "archard"),
        Patch(1, 1, 600.0, (36.1, 44.6), (-4.0, 10.0)),
    ),
    effects=(
        Effect("coating", {"thickness_um": 18.0}),
        Effect("turntable_angle", {"order": 2, "amplitude_deg": 0.02, "phase_deg": 40.0}),
    ),
).of_size(153_500)


def ply_bytes(points: Floats) -> bytes:
    """ASCII PLY rounded to 1 µm: float32 would not hold that, and gzip makes it no longer."""
    head = (
        f"ply\nformat ascii 1.0\nelement vertex {len(points)}\nproperty float x\nproperty float y\nproperty float z\nend_header\n"
    )
    rows = "\n".join(f"{x:.3f} {y:.3f} {z:.3f}" for x, y, z in points.tolist())
    return (head + rows + "\n").encode()


def main(folder: Path) -> SyntheticScan:
    scan = make_scan(RECIPE, SEED)
    (folder / "scan.ply.gz").write_bytes(gzip.compress(ply_bytes(scan.points), 9, mtime=0))
    truth = {"note": "simulated; tooth counts from 0, side +1 is left; scan = R · design + t"} | scan.truth.as_dict()
    (folder / "truth.json").write_text(json.dumps(truth, indent=1) + "\n")
    return scan


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parents[2] / "gearwear" / "example")
