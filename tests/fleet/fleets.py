"""Small fleets as files: planar sections of a gear, which take a third of a second each, and stores made by hand."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from contextlib import contextmanager
from datetime import datetime
from functools import cache
from pathlib import Path
from typing import Any

from gearwear.fleet.manifest import ManifestRow
from gearwear.fleet.outcome import Outcome, State
from gearwear.fleet.store import Store
from gearwear.fleet.tables import rows_parquet
from tests.synthetic import Recipe, make_scan

DESIGN = "[gear]\nteeth = 12\nmodule = 6.35\nface_width = 15\nrack_tip_radius = 0.3\n"


@cache
def section(seed: int) -> str:
    """A planar section as text, two columns."""
    points = make_scan(Recipe(slices=1, ends="none", end_points=0, noise_um=5.0, pose="none"), seed).views[0]
    return "".join(f"{x:.5f} {y:.5f}\n" for x, y, _ in points)


def sections(folder: Path, number: int = 2) -> Path:
    """A manifest of so many sections and one scan that is no scan."""
    (folder / "design.toml").write_text(DESIGN)
    lines = ["gear_id,inspected,design,scans,site"]
    for i in range(number):
        (folder / f"s{i}.xyz").write_text(section(i))
        lines.append(f"G{i},2026-01-0{i + 1},design.toml,s{i}.xyz,hall 1")
    (folder / "bad.xyz").write_text("no points at all\n")
    lines.append("G9,2026-01-09,design.toml,bad.xyz,hall 2")
    (folder / "fleet.csv").write_text("\n".join(lines) + "\n")
    return folder / "fleet.csv"


def contents(store: Path) -> dict[str, bytes]:
    """What a store holds of its scans, by name."""
    return {
        path.name: path.read_bytes()
        for path in sorted(store.iterdir())
        if path.suffix in (".json", ".parquet", ".refused", ".failed")
    }


@contextmanager
def nobody(jobs: Sequence[Any]) -> Any:
    """A crew that must not be called."""
    raise AssertionError(f"{len(jobs)} scans were to be compared again")
    yield


def report(
    volume: tuple[float, float] = (1.0, 0.05),
    depth: tuple[float, float] = (50.0, 4.0),
    loss: tuple[float, float] = (0.05, 0.005),
    converged: bool = True,
) -> dict[str, Any]:
    """As much of a `report.json` as a fleet reads: value and standard deviation of volume (mm³), depth (µm) and loss (mm)."""
    region = {
        "tooth": 3,
        "flank": "left",
        "volume_mm3": dict(zip(("value", "std"), volume, strict=True)),
        "max_depth_um": depth[0],
        "max_depth_std_um": depth[1],
    }
    return {
        "design": {"part": "gear"},
        "registration": {"converged": converged},
        "wear": {"volume_mm3": dict(zip(("value", "std"), volume, strict=True)), "regions": [region], "flanks": [], "detection_limit_um": 20.0, "detection_area_mm2": 9.0},
        "thickness": [{"tooth": 1, "loss_max_mm": 0.001, "loss_max_std_mm": 0.002}, {"tooth": 3, "loss_max_mm": loss[0], "loss_max_std_mm": loss[1]}],
        "thinnest": None,
        "meshing": None,
        "inspection": None,
    }  # fmt: skip


def store_of(
    folder: Path, scans: Iterable[tuple[ManifestRow, Mapping[str, Any] | State]], limits: Mapping[str, float] | None = None
) -> Store:
    """A store that holds these reports; a state in place of a report is a scan that has none."""
    store, listed = Store(folder), []
    (folder / "manifests").mkdir(parents=True)
    for i, (row, found) in enumerate(scans):
        key = f"{row.gear_id}_{i:016x}"
        listed.append((row, key, dict(limits or {})))
        if isinstance(found, State):
            store.publish(Outcome(key, found, why=f"line {row.line}: not so"))
        else:
            store.publish(Outcome(key, State.DONE, b"{}", rows_parquet(key, row, found)))
    store.keep_manifest("fleet.csv", listed)
    return store


def row(
    gear_id: str, inspected: datetime | None = None, cycles: float | None = None, operator: str = "", repeat: str = ""
) -> ManifestRow:
    """A row of a manifest."""
    return ManifestRow(
        line=2,
        gear_id=gear_id,
        design="design.toml",
        scans=("s.ply",),
        inspected=inspected,
        cycles_run=cycles,
        operator=operator,
        repeat=repeat,
    )
