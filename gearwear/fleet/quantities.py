"""From a report to rows of numbers: what of a scan is worth a place in a table. Plain data in and out."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from gearwear.design.side import Side
from gearwear.fleet.line import own_range

Json = Mapping[str, Any]

HIDDEN = 2.0
"""Where no wear was found, how much may be there over what an even patch at the detection limit has: a hollow is twice as deep as on
average, and two patches may hide."""

NOT_SEEN = 0.25
"""Share of a flank below which it was not seen, where it says nothing of its wear."""
SILENT = 0.1
"""Share of the flanks that may say nothing of their wear although more of them was seen: beyond, a part of the gear was not looked at. A few thin
flanks are in every scan, and low places on them in the range of the volume."""

GEAR, TOOTH, PATTERN, MARK, DOUBT = "gear", "tooth", "pattern", "mark", "doubt"
"""Scope of a row: a number of the whole gear, its worst as a rule, or of one tooth or flank; what the teeth can be known again by; or what
puts the whole scan in question."""
DOUBTFUL, UNSEEN = "doubtful: ", "unseen: "
"""What the names of such rows begin with: before the words of a doubt, or before how many flanks say nothing."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Quantity:
    """A number of a scan.

    Parameters
    ----------
    name : str
        With its unit, such as ``wear_depth_mm``.
    scope : {"gear", "tooth", "pattern", "mark", "doubt"}
    value : float
    std : float
        Stated standard deviation; nan where none is stated.
    tooth : int or None
        Counted from 1 as in the report; of a number of the whole gear, where it is found.
    flank : str
        "left" or "right" where each side has a number of its own; else "".
    low, high : float
        Within what limits it lies where more than scatter is open, as where no wear was found and some may be; else nan.
    """

    name: str
    scope: str
    value: float
    std: float = math.nan
    tooth: int | None = None
    flank: str = ""
    low: float = math.nan
    high: float = math.nan


def quantities(report: Json) -> list[Quantity]:
    """The rows of a scan.

    Parameters
    ----------
    report : mapping
        As `report.json`; a part that is missing or null gives no rows.
    """
    rows = [
        *_wear(report),
        *_thickness(report),
        *_meshing(report.get("meshing") or {}),
        *_inspection(report.get("inspection")),
        *(
            row
            for half, record in (report.get("inspection_halves") or {}).items()
            for row in _inspection(record, f"{half}_half_")
        ),
        *_patterns(report.get("scan") or {}),
        *_mark((report.get("scan") or {}).get("mark")),
        *_doubts(report),
    ]
    return [row for row in rows if math.isfinite(row.value)]


def _doubts(report: Json) -> Iterator[Quantity]:
    """What makes the whole result doubtful, a row each, and how many flanks say nothing of their wear where that leaves a part of the gear open.

    A flank of a tooth that is broken off is gone, and not unseen; one with wear on it was seen.
    """
    for text in report.get("doubtful") or []:
        yield Quantity(name=f"{DOUBTFUL}{text}", scope=DOUBT, value=1.0)
    wear: Json = report.get("wear") or {}
    worn = {(region["tooth"], region["flank"]) for region in wear.get("regions") or []}
    gone = {piece["tooth"] for piece in report.get("broken") or [] if piece.get("seen", True)}
    flanks = [flank for flank in wear.get("flanks") or [] if flank["tooth"] not in gone]
    seen = [
        _number(flank.get("seen"))
        for flank in flanks
        if not math.isfinite(_number(flank.get("detection_limit_um"))) and (flank["tooth"], flank["flank"]) not in worn
    ]
    unseen = sum(share < NOT_SEEN for share in seen)
    if len(seen) > max(unseen, SILENT * len(flanks)):
        yield Quantity(
            name=f"{UNSEEN}{len(seen)} of {len(flanks)} flanks say nothing of their wear", scope=DOUBT, value=float(len(seen))
        )
    elif unseen:
        yield Quantity(name=f"{UNSEEN}{unseen} of {len(flanks)} flanks were not seen", scope=DOUBT, value=float(unseen))


def _number(value: object) -> float:
    return float(value) if isinstance(value, int | float) else math.nan


def _estimate(name: str, scope: str, record: Json | None, factor: float = 1.0, **where: Any) -> Iterator[Quantity]:
    """``{"value", "std"}``, with ``low`` and ``high`` where they are there."""
    if record is None:
        return
    value, std, low, high = (factor * _number(record.get(key)) for key in ("value", "std", "low", "high"))
    yield Quantity(name=name, scope=scope, value=value, std=std, low=low, high=high, **where)


def _wear(report: Json) -> Iterator[Quantity]:
    wear: Json = report.get("wear") or {}
    regions, size = wear.get("regions") or [], "volume_mm3" if "volume_mm3" in wear else "area_mm2"
    depths = [_depth(region) for region in regions]
    open_ = _even_open(report)
    extent = "detection_area_mm2" if size == "volume_mm3" else "detection_length_mm"
    depth, patch = HIDDEN * 1e-3 * _number(wear.get("detection_limit_um")), _number(wear.get(extent))
    if regions:
        yield from _estimate(f"wear_{size}", GEAR, wear.get(size))
        yield _deepest(depths)
    elif size in wear and math.isfinite(depth):  # nothing was found: what might be there all the same
        high = float(np.fmax(depth * patch, _number(wear[size].get("high"))))
        yield Quantity(name=f"wear_{size}", scope=GEAR, value=0.0, low=0.0, high=high)
        yield Quantity(name="wear_depth_mm", scope=GEAR, value=0.0, low=0.0, high=max(depth, HIDDEN * open_[1]))
    if regions or math.isfinite(depth):  # where no flank could have shown any, how much is gone is not known, and not nothing
        yield from _estimate("lost_volume_mm3", GEAR, wear.get("lost_volume_mm3"))
    seen = {(region["tooth"], region["flank"]) for region in regions}
    for region, depth_there in zip(regions, depths, strict=True):
        yield from _estimate(f"wear_{size}", TOOTH, region.get(size), tooth=int(region["tooth"]), flank=str(region["flank"]))
        yield depth_there
    for flank in wear.get("flanks") or []:
        own = HIDDEN * 1e-3 * _number(flank.get("detection_limit_um"))
        if (flank["tooth"], flank["flank"]) not in seen and math.isfinite(own):
            high = max(own, HIDDEN * open_[1])
            yield Quantity(
                name="wear_depth_mm",
                scope=TOOTH,
                value=0.0,
                low=0.0,
                high=high,
                tooth=int(flank["tooth"]),
                flank=str(flank["flank"]),
            )


def _even_open(report: Json) -> tuple[float, float]:
    """What the range of the worn volume comes to below and above it evenly over all flanks of one side, mm; 0 where it is no wider than the ±."""
    evenly: Json = (report.get("wear") or {}).get("evenly_um") or {}
    below, above = (float(np.nan_to_num(1e-3 * _number(evenly.get(end)))) for end in ("below", "above"))
    return below, above


def _ends(value: float, down: float, up: float) -> tuple[float, float]:
    """Limits that far below and above a value; nan where it is no further."""
    return value - down if down > 0.0 else math.nan, value + up if up > 0.0 else math.nan


def _depth(region: Json) -> Quantity:
    """The deepest place of a flank, and within what limits it lies."""
    value, std, low, high = (1e-3 * _number(region.get(f"max_depth_{key}um")) for key in ("", "std_", "low_", "high_"))
    tooth, flank = int(region["tooth"]), str(region["flank"])
    return Quantity(name="wear_depth_mm", scope=TOOTH, value=value, std=std, tooth=tooth, flank=flank, low=low, high=high)


def _deepest(depths: Sequence[Quantity]) -> Quantity:
    """That of the gear: as deep at least as each of its flanks is at least, and no deeper than one of them may be."""
    deepest = max(depths, key=lambda depth: depth.value)
    low = high = math.nan
    if any(math.isfinite(depth.high) for depth in depths):
        low, high = map(max, zip(*(own_range(depth.value, depth.std, depth.low, depth.high) for depth in depths), strict=True))
    return replace(deepest, scope=GEAR, flank="", low=low, high=high)


def _thickness(report: Json) -> Iterator[Quantity]:
    teeth = [tooth for tooth in report.get("thickness") or [] if math.isfinite(_number(tooth.get("loss_max_mm")))]
    design: Json = report.get("design") or {}
    radius = design.get("thickness_radius_mm", design.get("reference_radius_mm"))  # reports of older versions have none
    lever = _number(design.get("base_radius_mm")) * math.cos(math.radians(float(design.get("base_helix_angle_deg", 0.0))))
    arc = _number(radius) / lever  # of a loss along the normal
    open_ = [arc * far if far > 0.0 else 0.0 for far in _even_open(report)]
    losses = [
        Quantity(
            name="thickness_loss_mm",
            scope=TOOTH,
            value=_number(tooth["loss_max_mm"]),
            std=_number(tooth.get("loss_max_std_mm")),
            tooth=int(tooth["tooth"]),
        )
        for tooth in teeth
    ]
    if losses:
        worst = max(losses, key=lambda row: row.value)
        most = report.get("most_lost")  # without the bias of looking for the greatest; reports of older versions have none
        if most is not None:
            worst = replace(worst, value=_number(most["value_mm"]), std=_number(most.get("std_mm")), tooth=int(most["tooth"]))
        low, high = _ends(worst.value, *open_)
        yield replace(worst, scope=GEAR, low=low, high=high)
    least: Json | None = report.get("thinnest")
    if least is not None:
        yield Quantity(
            name="thickness_min_mm",
            scope=GEAR,
            value=_number(least.get("value_mm")),
            std=_number(least.get("std_mm")),
            tooth=int(least["tooth"]),
            low=_number(least.get("low_mm")),
            high=_number(least.get("high_mm")),
        )
    yield from losses


def _meshing(meshing: Json) -> Iterator[Quantity]:
    worn: Json = meshing.get("worn") or {}
    play: Json = worn.get("backlash") or {}
    for name, record, key in (
        ("backlash_mm", play, "circumferential_mm"),
        ("transmission_error_um", worn, "transmission_error_um"),
    ):
        value, std, low, high = (_number(record.get(f"{key}{end}")) for end in ("", "_std", "_low", "_high"))
        yield Quantity(name=name, scope=GEAR, value=value, std=std, low=low, high=high)
    law: Json = meshing.get("wear_law") or {}
    sliding: Json | None = (law.get("terms") or {}).get("sliding")
    if sliding is not None:
        yield from _estimate("law_sliding_depth_um", GEAR, sliding.get("greatest_depth_um"))


def _inspection(inspection: Json | None, half: str = "") -> Iterator[Quantity]:
    """The worst of every deviation, and the mean thickness of the teeth; U (k = 2) halved. `half` stands before the names where there are two."""
    if inspection is None:
        return
    factor = _number(inspection.get("coverage_factor")) or 2.0
    for finding in inspection.get("findings") or []:
        yield Quantity(
            name=f"{half}{finding['quantity']}_um",
            scope=GEAR,
            value=abs(_number(finding.get("value_um"))),
            std=_number(finding.get("expanded_um")) / factor,
            tooth=finding.get("tooth"),
            flank=str(finding.get("flank") or ""),
        )
    teeth = ((inspection.get("dimensions") or {}).get("tooth_thickness") or {}).get("teeth") or []
    for tooth in teeth:
        seen = tooth["thickness_mm"]
        if seen is None:  # the tooth was not seen, or is broken off
            continue
        yield Quantity(
            name=f"{half}tooth_thickness_mm",
            scope=TOOTH,
            value=_number(seen.get("value")),
            std=_number(seen.get("expanded")) / factor,
            tooth=int(tooth["tooth"]),
        )


def _mark(mark: Json | None) -> Iterator[Quantity]:
    """What told tooth 1, where the design states a mark and says where it stands."""
    if mark is None or "angle_deg" not in mark:
        return
    off = mark["off_deg"]
    yield Quantity(name="angle_deg", scope=MARK, value=_number(mark["angle_deg"]))
    yield Quantity(name="off_deg", scope=MARK, value=_number(off["value"]), std=_number(off["std"]))
    yield Quantity(name="end_told", scope=MARK, value=float(bool(mark["end_told"])))


def _patterns(scan: Json) -> Iterator[Quantity]:
    """The patterns of the teeth, a row each value: ``NAME/row/column``."""
    for pattern in scan.get("teeth_patterns") or []:
        for tooth, sides in enumerate(pattern["values"]):
            for flank, rows in zip(map(str, Side), sides, strict=True):
                for i, columns in enumerate(rows):
                    for j, value in enumerate(columns):
                        yield Quantity(
                            name=f"{pattern['name']}/{i}/{j}", scope=PATTERN, value=_number(value), tooth=tooth + 1, flank=flank
                        )
