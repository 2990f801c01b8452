"""Files of a scan: binary PLY, the design, the truth."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.families.case import Case
from benchmarks.families.gear import Array
from benchmarks.families.scanner import scan


def write_case(case: Case, folder: Path) -> tuple[Path, list[Path], dict[str, Any]]:
    """Write design, points and truth of a case.

    Parameters
    ----------
    case : Case
    folder : Path
        Made where it is missing.

    Returns
    -------
    design : Path
    scans : list of Path
    truth : dict
        As in the file beside them.
    """
    folder.mkdir(parents=True, exist_ok=True)
    made = scan(case.part, case.scanner, case.seed)
    design = folder / f"{case.label}.toml"
    design.write_text(case.toml())
    scans = []
    for i, points in enumerate(made.files):
        scans.append(folder / (f"{case.label}.ply" if len(made.files) == 1 else f"{case.label}_{i + 1}.ply"))
        write_ply(scans[-1], points)
    truth = case.record() | {
        "files": [path.name for path in scans],
        "points": int(sum(len(points) for points in made.files)),
        "strays": int((made.surface == -1).sum()),
        "spread_mm": made.spread,
        "poses": [{"R": rotation.tolist(), "t": translation.tolist()} for rotation, translation in made.poses],
    }
    (folder / f"{case.label}.truth.json").write_text(json.dumps(truth, indent=1))
    return design, scans, truth


def write_ply(path: Path, points: Array) -> None:
    """Points as binary PLY, float32."""
    head = (
        f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\n"
        "property float x\nproperty float y\nproperty float z\nend_header\n"
    )
    path.write_bytes(head.encode() + np.ascontiguousarray(points, dtype="<f4").tobytes())
