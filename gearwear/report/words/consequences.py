"""What taking the effects out changed: the table at the closed loop, the line on the terminal."""

from __future__ import annotations

from gearwear.comparison.consequences import Change
from gearwear.comparison.results import Results
from gearwear.design.quantity import MISSING, SPACE, decimals, listed, number, with_std
from gearwear.report.words.numbers import effect_title

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
NOTHING = {"worn_volume_mm3": "no wear found", "worn_area_mm2": "no wear found", "deepest_wear_um": ""}
"""What is said of 0: that none stood out of what was left in, and not that there is none."""
DIGITS = {"mm": 3, "um": 1, "mm3": 1, "mm2": 2}
HEAD = ("", "owing to", "as scanned", "effects taken out", "difference", "as made")
TEXT = (
    "As scanned: with everything left in that scanner, mounting and maker added, in the pose of registration alone. Backlash and"
    " transmission error are then those of the flanks as they were scanned, without the scatter of the points; a negative backlash means that"
    " the teeth would not go together. As made: the unworn gear with its errors of manufacture."
)


def said_changes(results: Results) -> tuple[Change, ...]:
    """The changes, where something was taken out: without that there is nothing that could have been left in."""
    taken_out = bool(results.effects) or (results.loop is not None and bool(results.loop.patterns))
    return results.changes if taken_out else ()


def change_rows(changes: tuple[Change, ...]) -> list[tuple[str, ...]]:
    """What the scan would have given with the effects left in, a row under `HEAD` for each number of the result."""
    rows = list[tuple[str, ...]]()
    for change in changes:
        digits = max(decimals(change.std), DIGITS[_unit(change)])
        causes = listed(effect_title(name) for name, _ in change.causes) if change.matters else "no change to be seen"
        rows.append(
            (
                LABELS[change.name], causes or MISSING, number(change.before, digits), number(change.after, digits),
                with_std(change.difference, change.std), number(change.as_made, digits),
            )
        )  # fmt: skip
    return rows


def change_line(changes: tuple[Change, ...], width: int) -> str:
    """The same on one line, as much of it as there is room for; "" where no difference can be seen."""
    by_name = {change.name: change for change in changes if change.matters}
    text = ""
    for name, words in SHORT.items():
        change = by_name.get(name)
        shown = MISSING if change is None else number(change.before, DIGITS[_unit(change)])
        if change is None or shown == MISSING:
            continue
        told = NOTHING.get(name, words.format(shown)) if change.before == 0.0 else words.format(shown)
        if not told:
            continue
        longer = f"{text[:-1]}, {told}." if text else f"If left in: {told}."
        if len(longer) > width:
            break
        text = longer
    return text


def _unit(change: Change) -> str:
    return change.name.rsplit("_", 1)[-1]
