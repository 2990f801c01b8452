"""The result in words an engineer would use, hedged where it is doubtful."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from gearwear.design.quantity import SPACE, listed, number, plural, sentence, significant, with_std
from gearwear.report.figures.arrays import Report
from gearwear.report.words.effects import effect_words
from gearwear.report.words.numbers import ask, effect_title, quantity, said, which_flanks

LITTLE_SEEN, NOT_SEEN = 0.5, 0.05
"""Share of the flanks below which a result is doubtful; share of one side's below which that side was not seen."""
RIM_OFF_MODULES, RIM_OFF_MM = {"tip": 0.08, "root": 0.12}, 0.05
"""Distance of tips and roots from the design's, in modules and mm together, at which the design's tip or root diameter is not the gear's."""
BASE_OFF = 0.01
"""Relative difference of the flanks' base circle from the design's, beyond what makers and scanners leave: neighbours among modules and pressure
angles in use differ by 1.6 % and more."""
FAR_OFF_UM, FAR_OFF_MODULES = 100.0, 0.02
"""RMS outside the wear, all that was found taken out, above both of which a scan is more likely of another gear."""
ABOVE_NOISE = 2.0
"""RMS of what is left, over the scan's own noise, above which that is not "nothing", pattern or not."""

LEAST_STD_MM = 1e-4
"""A standard deviation of contact below this is that of a gear on which nothing is worn: nothing."""


def verdict(report: Report) -> str:
    """What became of the gear, in one sentence.

    Parameters
    ----------
    report : mapping
        As `report.json`.

    Returns
    -------
    str
    """
    regions = ask(report, "wear", "regions") or []
    grave = grave_doubts(report)
    text = _wear_found(report, regions) if regions else _no_wear(report)
    if grave:
        held = (
            f"As it stands, {text}."
            if wrong_design(report) is None
            else "What is said of wear holds only if the design is right."
        )
        return f"{sentence(f'doubtful, because {listed(grave)}')} {held}"
    return sentence(text)


def _wear_found(report: Report, regions: list[Any]) -> str:
    volume, area = ask(report, "wear", "volume_mm3"), ask(report, "wear", "area_mm2")
    lost = quantity(volume, "mm³") + " of metal" if volume else quantity(area, "mm²") + " of the section"
    worst = max(regions, key=lambda region: region.get("max_depth_um") or 0.0)
    place, depth = which_flanks([worst]), _depth(worst.get("max_depth_um"))
    text = f"{lost} is gone from {which_flanks(regions, ask(report, 'design', 'teeth'))}"
    text += f", up to {depth} deep" if len(regions) == 1 else f"; deepest, by {depth}, on {place}"
    row = thinnest(report)
    loss = 0.0 if row is None else row["nominal_mm"] - row["min_mm"]
    if row is not None and loss > 0.0:
        which = "that tooth" if row["tooth"] == worst["tooth"] else f"tooth {row['tooth']}"
        text += (
            f"; {which} is {number(loss, 2 if loss >= 0.1 else 3)}{SPACE}mm ({significant(100.0 * loss / row['nominal_mm'], 2)}{SPACE}%)"
            " thinner than designed at the reference circle"
        )
    return text


def _no_wear(report: Report) -> str:
    noise = ask(report, "closed_loop", "noise_um")
    text = "no wear was found: nothing on the flanks stands out of the scan's scatter"
    text += f" of {significant(noise, 2)}{SPACE}µm" if noise else ""
    limit = ask(report, "wear", "detection_limit_um")
    return text + (f"; wear deeper than about {significant(limit, 2)}{SPACE}µm would have shown" if limit else "")


def _depth(depth_um: object) -> str:
    if isinstance(depth_um, (int, float)) and depth_um >= 1000.0:
        return f"{number(1e-3 * depth_um, 2)}{SPACE}mm"
    return f"{number(depth_um, 0)}{SPACE}µm"


def thinnest(report: Report) -> Mapping[str, Any] | None:
    """The row of `thickness` with the least, None without any."""
    return min(_seen_rows(report, "min_mm"), key=lambda row: float(row["min_mm"]), default=None)


def lost_most(report: Report) -> Mapping[str, Any] | None:
    """The row of `thickness` that lost most against the as-made gear, None without any."""
    return max(_seen_rows(report, "loss_max_mm"), key=lambda row: float(row["loss_max_mm"]), default=None)


def _seen_rows(report: Report, key: str) -> list[Any]:
    rows = [row for row in report.get("thickness") or [] if isinstance(row.get(key), (int, float))]
    return [row for row in rows if math.isfinite(row[key]) and row.get("nominal_mm")]


def loop_words(report: Report) -> str:
    """What the closed loop found, named or not, and what it did to the error; one to four sentences."""
    loop = report.get("closed_loop") or {}
    effects = loop.get("effects") or []
    if not sought(report):
        return "No effect of measurement or manufacture was looked for: whatever differs from the design counts as it stands."
    found = []
    if effects:
        found.append(f"besides wear the scan shows {listed(effect_words(effect) for effect in effects)}")
        unsure = [effect for effect in effects if effect.get("alternatives")]
        for effect in unsure:
            others = listed((effect_title(str(name)) for name in effect["alternatives"]), "or")
            found.append(f"the data cannot tell {effect_title(effect['name'])} from {others}")
        before, after = ask(loop, "before", "rms_um"), ask(loop, "after", "rms_um")
        held = ask(loop, "before", "heldout_rms_um"), ask(loop, "after", "heldout_rms_um")
        noise = loop.get("noise_um")
        text = f"taking {'it' if len(effects) == 1 else 'them'} out brings the RMS outside wear from {significant(before)} to {significant(after)}{SPACE}µm"
        if held[0] is not None and held[1] is not None:
            text += f" ({significant(held[0])} to {significant(held[1])}{SPACE}µm on data the fit never saw)"
        found.append(text + (f"; the scan's own noise is {significant(noise)}{SPACE}µm" if noise else ""))
    else:
        more = "known effect" if ask(loop, "unexplained", "found") else "effect"
        found.append(f"besides wear no {more} of measurement or manufacture stands out")
    found.append(unexplained_words(report))
    return " ".join(sentence(text) for text in found if text)


def unexplained_words(report: Report) -> str:
    """What no effect of the catalogue explains; "" where nothing is known of it."""
    left = ask(report, "closed_loop", "unexplained")
    if not isinstance(left, Mapping):
        return ""
    if not left.get("found"):
        after, noise = ask(report, "closed_loop", "after", "rms_um"), ask(report, "closed_loop", "noise_um")
        if after and noise and after > ABOVE_NOISE * noise:
            much = f"{significant(after)}{SPACE}µm RMS against the scan's own noise of {significant(noise)}{SPACE}µm"
            return f"what is left, {much}, has no pattern that stands out"
        return "nothing significant is left unexplained"
    pattern = said(left.get("pattern"))
    return f"unexplained: a pattern of {significant(left.get('rms_um'))}{SPACE}µm RMS that no known effect describes" + (
        f" ({pattern})" if pattern else ""
    )


def sought(report: Report) -> bool:
    """Whether effects were looked for: the report says so, or has an `after`."""
    said = ask(report, "closed_loop", "sought")
    return bool(said) if said is not None else ask(report, "closed_loop", "after", "rms_um") is not None


def doubts(report: Report) -> list[str]:
    """Everything a reader must know before trusting the numbers, as sentences; [] where all is well."""
    found = [f"doubtful: {text}" for text in grave_doubts(report)]
    volume = ask(report, "wear", "volume_mm3") or ask(report, "wear", "area_mm2") or {}
    value, std = volume.get("value"), volume.get("std")
    if value and std and std > 0.3 * abs(value) and ask(report, "wear", "regions"):
        found.append(f"the worn amount is known to {100 * std / abs(value):.0f}{SPACE}% only")
    if ask(report, "closed_loop", "unexplained", "found"):
        found.append(unexplained_words(report))
    for where in (report, report.get("registration") or {}):
        found += [str(text) for key in ("warnings", "notes") for text in where.get(key) or []]
    harmless = set(ask(report, "design", "warnings") or [])  # about the drawing, not about this result
    return [sentence(text) for text in dict.fromkeys(found) if text not in harmless]


def grave_doubts(report: Report) -> list[str]:
    """What puts the whole result in question."""
    grave = []
    registration = report.get("registration") or {}
    if registration.get("converged") is False:
        grave.append("the registration did not settle")
    lost = [i + 1 for i, view in enumerate(registration.get("views") or []) if view.get("converged") is False]
    if lost:
        grave.append(f"{'view' if len(lost) == 1 else 'views'} {listed(map(str, lost))} could not be placed for certain")
    seen = ask(report, "scan", "coverage", "flank")
    sides = {side: ask(report, "scan", "coverage", f"flank_{side}") for side in ("left", "right")}
    unseen = [side for side, share in sides.items() if share is not None and share < NOT_SEEN]
    if isinstance(seen, (int, float)) and seen < LITTLE_SEEN:
        which = f", of the {unseen[0]} ones next to nothing" if len(unseen) == 1 else ""
        grave.append(f"only {100 * seen:.0f}{SPACE}% of the flanks was seen{which}")
    other = wrong_design(report)
    return grave if other is None else [*grave, other]


def wrong_design(report: Report) -> str | None:
    """Why the scan is more likely of another gear than the design's; None where nothing says so."""
    base, found = ask(report, "design", "base_radius_mm"), ask(report, "registration", "flank_base_radius_mm")
    if base and found and abs(found / base - 1.0) > BASE_OFF:
        text = f"the flanks are those of another gear or out of scale: their base circle is some {_diameter(found)} in diameter"
        return f"{text} and the design's {_diameter(base)}; check module and pressure angle"
    module = ask(report, "design", "module_mm") or math.inf
    off = []
    for rim, limit in RIM_OFF_MODULES.items():
        there, drawn = (ask(report, part, f"{rim}_radius_mm") for part in ("registration", "design"))
        if there and drawn and abs(there - drawn) > limit * module + RIM_OFF_MM:
            off.append(f"{rim}s lie at a diameter of {_diameter(there)} and the design's at {_diameter(drawn)}")
    if off:
        return f"the {listed(off)}; check tip and root diameter"
    left = ask(report, "closed_loop", "after" if sought(report) else "before", "rms_um")
    if left is not None and left > max(FAR_OFF_UM, 1e3 * FAR_OFF_MODULES * module):
        text = f"outside the wear the scan is {significant(left)}{SPACE}µm off the design (RMS)"
        return f"{text}, as that of another gear would be"
    return None


def _diameter(radius: float) -> str:
    return f"{significant(2.0 * radius)}{SPACE}mm"


def key_figures(report: Report) -> list[tuple[str, str, str]]:
    """Name, value with its uncertainty where one is known, and what it refers to, of the figures that come first."""
    wear, loop, meshing = report.get("wear") or {}, report.get("closed_loop") or {}, report.get("meshing") or {}
    regions = wear.get("regions") or []
    key = []
    if "area_mm2" in wear:
        key.append(("Section lost", quantity(wear["area_mm2"], "mm²"), "a planar section: area, not volume"))
    elif wear.get("volume_mm3") is not None:
        flanks = f"from {which_flanks(regions, ask(report, 'design', 'teeth'))}" if regions else "no region stands out"
        key.append(("Metal lost", quantity(wear["volume_mm3"], "mm³"), flanks))
    if regions:
        worst = max(regions, key=lambda region: region.get("max_depth_um") or 0.0)
        where = f"tooth {worst['tooth']}, {worst['flank']} flank"
        where += "" if "area_mm2" in wear else ", mean of 0.5 × 0.5 mm"
        key.append(("Deepest wear", f"{number(worst.get('max_depth_um'), 0)}{SPACE}µm", where))
    row = thinnest(report)
    if row is not None:
        where = "" if "area_mm2" in wear else f" at z = {number(row.get('at_z_mm'), 1)}{SPACE}mm"
        note = f"tooth {row['tooth']}{where}; design {number(row['nominal_mm'], 3)}{SPACE}mm"
        least = with_std(row["min_mm"], row["min_std_mm"]) if row.get("min_std_mm") else number(row["min_mm"], 3)
        key.append(("Thinnest tooth", f"{least}{SPACE}mm", note + ", at the reference circle"))
    design, worn = (
        ask(meshing, "design", "backlash", "circumferential_mm"),
        ask(meshing, "worn", "backlash", "circumferential_mm"),
    )
    if worn is not None:
        std = ask(meshing, "worn", "backlash", "circumferential_mm_std")
        shown = with_std(worn, std) if std and std >= LEAST_STD_MM else number(worn, 3)
        key.append(("Backlash, greatest", f"{shown}{SPACE}mm", f"circumferential; design {number(design, 3)}{SPACE}mm"))
    error = ask(meshing, "worn", "transmission_error_um")
    if error is not None:
        std = ask(meshing, "worn", "transmission_error_um_std")
        shown = with_std(error, std) if std and std >= 1e3 * LEAST_STD_MM else number(error, 1)
        key.append(("Transmission error", f"{shown}{SPACE}µm", "peak to peak over a revolution, unloaded"))
    before, after, noise = ask(loop, "before", "rms_um"), ask(loop, "after", "rms_um"), loop.get("noise_um")
    told = f"the scan's own noise is {significant(noise)}{SPACE}µm" if noise is not None else "outside wear"
    effects, name = loop.get("effects") or [], "Error outside wear, RMS"
    if sought(report) and effects:
        value = f"{significant(before)} → {significant(after)}{SPACE}µm"
        key.append((name, value, f"{plural(len(effects), 'effect')} taken out; {told}"))
    elif sought(report):
        key.append((name, f"{significant(after)}{SPACE}µm", f"no effect is named; {told}"))
    elif before is not None:
        key.append((name, f"{significant(before)}{SPACE}µm", f"no effect was looked for; {told}"))
    return key


def subject(report: Report) -> str:
    """What was measured: the gear and the scan, on one line."""
    design, scan = report.get("design") or {}, report.get("scan") or {}
    part = str(design.get("part") or "gear")
    facts = [
        f"z = {design.get('teeth', '?')}",
        f"m = {significant(design.get('module_mm'))}{SPACE}mm",
        f"α = {significant(design.get('pressure_angle_deg'))}°",
    ]
    names = scan.get("files") or scan.get("file") or []
    names = [names] if isinstance(names, str) else list(names)
    shown = Path(str(names[0])).name + (f" and {len(names) - 1} more" if len(names) > 1 else "") if names else "scan"
    return f"{part}, {', '.join(facts)} · {shown}, {number(scan.get('points'), 0)} points"
