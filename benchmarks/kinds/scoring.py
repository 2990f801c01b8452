"""What a report says of a scan, held against its truth; plain data in, plain data out."""

from __future__ import annotations

from typing import Any

from benchmarks.families.scoring import Placement, interval, names, thinnest


def score(found: dict[str, Any], truth: dict[str, Any]) -> dict[str, Any]:
    """Names, worn flanks, volume and least thickness of one scan."""
    placement, teeth = Placement.of(found["registration"], truth), truth["gear"]["teeth"]
    told = found["wear"]["volume_mm3"]
    volume = told if isinstance(told, dict) else {"value": told, "std": None}
    regions = {(one["tooth"] - 1, 1 if one["flank"] == "left" else -1) for one in found["wear"]["regions"]}
    worn = {placement.flank(tooth, side, teeth) for tooth, side in truth["flanks"]}
    return {
        "names": names(found, truth, placement),
        "volume": interval(volume, truth["volume_mm3"]),
        "thinnest": thinnest(found["thickness"], found["thinnest"], truth, placement), "teeth": teeth,
        "worn": len(worn), "worn_found": len(worn & regions), "regions_false": len(regions - worn),
        "broken_false": sum(one["kind"] != "not seen" for one in found.get("broken") or ()),
    }  # fmt: skip
