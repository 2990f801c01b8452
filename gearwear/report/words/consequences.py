"""What taking the effects out changed: the report's record of it, the table at the closed loop, the line on the terminal."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from gearwear.design.quantity import MISSING, SPACE, decimals, listed, number, with_std
from gearwear.report.figures.arrays import Report
from gearwear.report.page.parts import heading, paragraph, table
from gearwear.report.words.numbers import effect_title

if TYPE_CHECKING:
    from gearwear.comparison.consequences import Change

LABELS = {
    "worn_volume_mm3": "worn volume, mm³",
    "worn_area_mm2": "worn area, mm²",
    "deepest_wear_um": "deepest wear, µm",
    "tooth_thickness_mean_mm": "tooth thickness, mean, mm",
    "tooth_thickness_least_mm": "tooth thickness, least, mm",
    "backlash_mean_mm": "backlash, mean, mm",
    "backlash_greatest_mm": "backlash, greatest, mm",
    "transmission_error_um": "transmission error, peak to peak, µm",
}
SHORT = {
    "worn_volume_mm3": f"{{}}{SPACE}mm³ lost",
    "worn_area_mm2": f"{{}}{SPACE}mm² lost",
    "backlash_greatest_mm": f"backlash {{}}{SPACE}mm",
    "transmission_error_um": f"transmission error {{}}{SPACE}µm",
    "tooth_thickness_least_mm": f"thinnest tooth {{}}{SPACE}mm",
    "deepest_wear_um": f"deepest wear {{}}{SPACE}µm",
}
"""What is said on the terminal, the most telling first."""
DIGITS = {"mm": 3, "um": 1, "mm3": 1, "mm2": 2}


def change_records(changes: Iterable[Change]) -> dict[str, Any]:
    """`closed_loop` → `changes`."""
    return {
        change.name: {
            "before": change.before,
            "after": change.after,
            "difference": {"value": change.difference, "std": change.std},
            "matters": change.matters,
            "as_made": change.as_made,
            "causes": [{"name": name, "change": size} for name, size in change.causes],
        }
        for change in changes
    }


def change_table(loop: Report) -> str:
    """What the scan would have given with the effects left in; "" where nothing was taken out."""
    changes = loop.get("changes") or {}
    if not changes:
        return ""
    rows = []
    for name, change in changes.items():
        difference = change["difference"]
        digits = max(decimals(difference.get("std")), DIGITS[name.rsplit("_", 1)[-1]])
        causes = (
            listed(effect_title(str(cause["name"])) for cause in change["causes"])
            if change["matters"]
            else "no change to be seen"
        )
        rows.append(
            (
                LABELS[name], causes or MISSING, *(number(change.get(key), digits) for key in ("before", "after")),
                with_std(difference["value"], difference.get("std")), number(change.get("as_made"), digits),
            )
        )  # fmt: skip
    text = (
        "As scanned: with everything left in that scanner, mounting and maker added, in the pose of registration alone. Backlash and"
        " transmission error are then those of the flanks as they were scanned, without the scatter of the points; a negative backlash means that the teeth"
        " would not go together. As made: the unworn gear with its errors of manufacture."
    )
    head = ("", "owing to", "as scanned", "effects taken out", "difference", "as made")
    return heading("What leaving them in would have cost") + paragraph(text) + table(head, rows, words=2)


def change_line(loop: Report, width: int) -> str:
    """The same on one line, as much of it as there is room for; "" where no difference can be seen."""
    changes = loop.get("changes") or {}
    text = ""
    for name, words in SHORT.items():
        change = changes.get(name)
        if change is None or not change["matters"] or change["before"] is None:
            continue
        said = words.format(number(change["before"], DIGITS[name.rsplit("_", 1)[-1]]))
        longer = f"{text[:-1]}, {said}." if text else f"If left in: {said}."
        if len(longer) > width:
            break
        text = longer
    return text
