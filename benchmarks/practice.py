"""The practice scans, one after the other: what `gearwear compare` says of each, for the last column of the table in docs/practice.md.

``python -m benchmarks.practice [--only NAME …] [--shared FOLDER] [--write]``; FOLDER is ``../shared``, where the scans lie. Without ``--write`` the
cells are printed. The page holds what each scan is, its truth, and what version 0.1.0 said; this holds how it is run, and nothing of its truth.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from gearwear import __version__
from gearwear.design.quantity import number, significant, with_std

HERE = Path(__file__).resolve().parents[1]
PAGE = HERE / "docs" / "practice.md"
HEAD = "| scan | truth or reference | version 0.1.0 |"
"""How the table's first line begins; its last column is the version that was run."""

PAIR = "[pinion]\nteeth = 12\nmodule = 6.35\nface_width = 15.0\n\n[gear]\nteeth = 24\nface_width = 15.0\n"
HARD = "[gear]\nteeth = 20\nmodule = 4.0\nface_width = 16.0\n"
RIGHT = "[gear]\nteeth = 12\nmodule = 3.0\nhelix_angle = 15.0\nface_width = 20.0\nrack_tip_radius = 0.25\n"
LEFT = "[gear]\nteeth = 23\nmodule = 2.5\nhelix_angle = -25.0\nface_width = 18.0\nprofile_shift = 0.2\nrack_tip_radius = 0.3\n"
RING = (
    "[gear]\nteeth = 48\nmodule = 2.5\nface_width = 15.0\ninternal = true\naddendum = 0.8\n"
    "cutter_teeth = 20\ncutter_tip_radius = 0.16\nrim_diameter = 144.0\n"
)
"""Designs, as the truth files have the drawing."""

Json = dict[str, Any]


@dataclass(frozen=True, slots=True)
class Practice:
    """How a scan is run: files below the folder, a design's text or its file, and more arguments."""

    files: tuple[str, ...]
    design: str
    before: tuple[str, ...] = ()


def scans() -> dict[str, Practice]:
    """Every practice scan by the name of its row."""
    paper = {
        "tooth_b": Practice(("scans/open_tooth_b.ply",), PAIR),
        "tooth_b_before": Practice(("scans/open_tooth_b.ply",), PAIR, ("scans/open_unworn.ply",)),
        "unworn": Practice(("scans/open_unworn.ply",), PAIR),
        "turntable": Practice(("scans/open_turntable.ply",), PAIR),
        "views": Practice(tuple(f"scans/open_views_{i}.ply" for i in range(1, 5)), PAIR),
        "triangles": Practice(("scans/open_triangles.stl",), PAIR),
        **{f"blind_{which}": Practice((f"scans/blind_{which}.ply",), PAIR) for which in "abc"},
    }
    hard = {
        name: Practice((f"scans/hard/{name}.ply",), HARD)
        for name in ("b13_density", "c04_broken_corner", "c05_missing_tooth", "c07_both_sides")
    }
    root = {"root_unknown": Practice(("scans/hard/root_unknown.ply",), "scans/hard/root_unknown.toml")}
    helical = {
        "open_r15_coated": Practice(("scans/helical/open_r15_coated.ply",), RIGHT),
        "open_l25_helix_slope": Practice(("scans/helical/open_l25_helix_slope.ply",), LEFT),
        "open_ring_turntable": Practice(("scans/helical/open_ring_turntable.ply",), RING),
    }
    flatbed = {f"flatbed_{i}": Practice((f"real/flatbed_gear_{i}.csv",), f"real/flatbed_gear_{i}.toml") for i in (1, 2, 3)}
    pinions = ("001", "002", "015", "033", "050", "077", "120", "142", "166", "180", "199")
    dental = {f"kw_{which}": Practice((f"real/dental/kw_{which}.xyz",), "real/dental/z13.toml") for which in pinions}
    dental |= {
        f"z19_{which}": Practice((f"real/dental/z19_{which}.xyz",), "real/dental/z19.toml")
        for which in ("01", "02", "05", "20", "41", "60")
    }
    return {"example": Practice((), "")} | paper | root | hard | helical | flatbed | dental


def report_of(practice: Practice, shared: Path) -> Json:
    """What `gearwear compare` writes of a scan."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        words = []
        if practice.files:
            design = shared / practice.design
            if "\n" in practice.design:
                design = folder / "design.toml"
                design.write_text(practice.design, encoding="utf-8")
            words = [str(design), *(str(shared / file) for file in practice.files)]
        if practice.before:
            words += ["--before", *(str(shared / file) for file in practice.before)]
        command = [sys.executable, "-m", "gearwear.compare", *words, "--no-page", "--out", str(folder / "out")]
        said = subprocess.run(command, check=True, cwd=HERE, stdin=subprocess.DEVNULL, capture_output=True, text=True).stdout
        result: Json = json.loads((folder / "out" / "report.json").read_text(encoding="utf-8"))
        return result | {"doubtful": "oubtful" in said}


def cell(report: Json) -> str:
    """A report in a line: doubt, wear, breakage, the thinnest tooth, effects, pattern and root."""
    words = ["**doubtful**"] if report["doubtful"] else []
    words += [_wear(report), *map(_broken, report["broken"]), *_thinnest(report["thinnest"]), _effects(report["closed_loop"])]
    unexplained = report["closed_loop"]["unexplained"]
    words += [f"unexplained {number(unexplained['rms_um'], 1)} µm RMS"] if unexplained["found"] else []
    root = report["root"] or {}
    if root.get("free"):
        words.append("root free")
    elif root.get("seen") and not root["fits_design"]:
        words.append(f"root found: rack tip radius {number(root['rack_tip_radius'], 2)}")
    return "; ".join(words)


def _wear(report: Json) -> str:
    wear = report["wear"]
    key, unit = ("volume_mm3", "mm³") if "volume_mm3" in wear else ("area_mm2", "mm²")
    lost, regions = wear[key], wear["regions"]
    reach = f" ({significant(lost['low'])} to {significant(lost['high'])})" if lost.get("high") else ""
    if not regions:
        limit = wear.get("detection_limit_um")
        shown = f" (deeper than {number(limit, 1)} µm would have shown)" if limit and not reach else ""
        return f"no wear stands out{reach}{shown}"
    sides = [(side, sum(region["flank"] == side for region in regions)) for side in ("left", "right")]
    flanks = " and ".join(f"{count} {side}" for side, count in sides if count)
    deepest = max(regions, key=lambda region: region["max_depth_um"])
    depth = with_std(deepest["max_depth_um"], deepest["max_depth_std_um"])
    lost_by = f"{with_std(lost['value'], lost['std'])} {unit}{reach}"
    return f"{lost_by} from {flanks} flank{'s' * (len(regions) > 1)}, {depth} µm"


def _broken(piece: Json) -> str:
    volume = piece["volume_mm3"]
    return f"{piece['kind'].replace('_', ' ')}, tooth {piece['tooth']}, {with_std(volume['value'], volume['std'])} mm³"


def _thinnest(thinnest: Json | None) -> list[str]:
    return [f"thinnest tooth {with_std(thinnest['value_mm'], thinnest['std_mm'])} mm"] if thinnest else []


def _effects(loop: Json) -> str:
    return ", ".join(map(_effect, loop["effects"])) or "no effect"


def _effect(effect: Json) -> str:
    sizes = [
        f"{with_std(item['value'], item['std'])} {UNIT.get(item['unit'], item['unit'])}".strip()
        for item in effect["parameters"].values()
        if not isinstance(item["value"], list) and item["unit"] in UNIT
    ]
    others = effect["alternatives"]
    shown = (
        f" (or {', '.join(f'`{name}`' for name in others)})"
        if 0 < len(others) < 4
        else f" (or one of {len(others)} others)"
        if others
        else ""
    )
    return f"`{effect['name']}`" + (f" {', '.join(sizes[:2])}" if sizes else "") + shown


UNIT = {"um": "µm", "ppm": "ppm", "deg": "°"}


def in_place(page: str, cells: dict[str, str]) -> str:
    """The page with the last column of these rows, and its head, as they are now."""
    lines = page.split("\n")
    for i, line in enumerate(lines):
        if line.startswith(HEAD):
            lines[i] = f"{HEAD} version {__version__} |"
        for name, text in cells.items():
            if line.startswith(f"| `{name}`"):
                lines[i] = "|".join(line.split("|")[:4]) + f"| {text} |"
    return "\n".join(lines)


def main() -> None:
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--only", nargs="+", default=None, metavar="NAME")
    p.add_argument("--shared", type=Path, default=HERE.parent / "shared")
    p.add_argument("--write", action="store_true", help="put the cells into docs/practice.md")
    chosen = p.parse_args()
    for name, practice in scans().items():
        if chosen.only and name not in chosen.only:
            continue
        text = cell(report_of(practice, chosen.shared.resolve()))
        print(f"{name}: {text}", flush=True)
        if chosen.write:
            PAGE.write_text(in_place(PAGE.read_text(encoding="utf-8"), {name: text}), encoding="utf-8")


if __name__ == "__main__":
    main()
