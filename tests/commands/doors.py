"""What the tests of the front doors share: scans as files, and a command run as a user would, without starting a process."""

from __future__ import annotations

import contextlib
import io
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from gearwear.cli import main
from gearwear.design import Design, read_design
from gearwear.scan import read_one
from tests.scan.writers import ply
from tests.synthetic import Recipe, SyntheticScan, make_scan

ROOT = Path(__file__).resolve().parents[2]
EXAMPLE = ROOT / "gearwear" / "example"
PAIR = EXAMPLE / "design.toml"
ONE = "[gear]\nteeth = 12\nmodule = 6.35\nface_width = 15\nrack_tip_radius = 0.3\n"
"""The pair's pinion by itself."""
ALONE = Design({"pinion": read_design(PAIR).gears["pinion"]})
"""The same as read: a third of a comparison is the contact with the mate, which many tests do not look at."""


@dataclass(frozen=True)
class Said:
    """What a command left behind."""

    status: int
    out: str
    err: str


def run(*arguments: object) -> Said:
    """``gearwear …`` in this process; a traceback comes out as what it is."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            status = main([str(a) for a in arguments])
        except SystemExit as left:  # --help
            status = int(left.code or 0)
    return Said(status, out.getvalue(), err.getvalue())


def scan_file(folder: Path, name: str, recipe: Recipe, seed: int = 1) -> tuple[list[Path], SyntheticScan]:
    """A synthetic scan as one double-precision PLY per view."""
    scan = make_scan(recipe, seed)
    files = [folder / f"{name}_{i}.ply" for i in range(len(scan.views))]
    for file, points in zip(files, scan.views, strict=True):
        file.write_bytes(ply(points, kind="f8"))
    return files, scan


def thinner_example(folder: Path, every: int = 5) -> Path:
    """The bundled scan with every so manieth of its points, in a file of its own: as true, and compared several times as fast."""
    file = folder / f"every_{every}.ply"
    if not file.exists():
        file.write_bytes(ply(read_one(EXAMPLE / "scan.ply.gz").points[::every], kind="f8"))
    return file


def strict_json(path: Path) -> Any:
    """A JSON file; NaN and Infinity, which are no JSON, are errors."""

    def refuse(constant: str) -> None:
        raise AssertionError(f"{path.name} holds {constant}")

    return json.loads(path.read_text(encoding="utf-8"), parse_constant=refuse)
