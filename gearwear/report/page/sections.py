"""The sections of the page on the gear: wear, closed loop, thickness, meshing. Whatever is missing is said to be missing."""

from __future__ import annotations

from typing import Any

from gearwear.design.quantity import MISSING, SPACE, listed, number, sentence, significant
from gearwear.report.figures.arrays import Report, ReportArrays
from gearwear.report.figures.colours import ColourScale
from gearwear.report.page import pictures
from gearwear.report.page.parts import items, paragraph, section, table
from gearwear.report.words.consequences import change_table
from gearwear.report.words.effects import effect_words
from gearwear.report.words.numbers import ask, bare, effect_title, quantity, row, said, which_flanks
from gearwear.report.words.shafts import take_up_words
from gearwear.report.words.verdict import loop_words, lost_most, sought, thinnest
from gearwear.report.words.wear_law import ageing


def wear(report: Report, arrays: ReportArrays, scale: ColourScale) -> str:
    """Wear by tooth and flank: the map, the regions, the laws, sections of the worst teeth."""
    found = report.get("wear") or {}
    regions = found.get("regions") or []
    return section(
        "wear",
        "Wear by tooth and flank",
        paragraph(_wear_words(report, arrays)),
        pictures.deviation_map(arrays, scale),
        _regions(regions, arrays.planar),
        _laws(found.get("laws") or []),
        pictures.worst_sections(report, arrays),
    )


def _wear_words(report: Report, arrays: ReportArrays) -> str:
    found = report.get("wear") or {}
    regions = found.get("regions") or []
    amount, unit, what = ("area_mm2", "mm²", "of the section") if arrays.planar else ("volume_mm3", "mm³", "of metal")
    before, limit = ask(found, "before_loop", amount), found.get("detection_limit_um")
    if regions:
        text = [f"in all {quantity(found.get(amount), unit)} {what} from {which_flanks(regions, arrays.gear.teeth)}"]
        if sought(report) and before:
            text.append(
                f"without taking the effects of scan and manufacture out first it would have been {quantity(before, unit)}"
            )
    else:
        text = ["no region of wear stands out of the scatter of this scan"]
    if limit:
        text.append(f"wear is seen from a mean depth of about {significant(limit, 2)}{SPACE}µm on")
    if found.get("reference"):
        text.append(f"it is measured against {found['reference']}")
    if found.get("plain_boolean"):
        text.append(f"the plain boolean with the scan's own triangles: {said(found['plain_boolean'])}")
    if arrays.planar:
        text.append("a planar section gives areas; volumes would need a scan of the whole face width")
    return " ".join(sentence(part) for part in text)


def _regions(regions: list[Any], planar: bool) -> str:
    if not regions:
        return ""
    amount = "area_mm2" if planar else "volume_mm3"
    head = ["tooth", "flank", "area, mm²" if planar else "volume, mm³", "deepest 0.5 × 0.5 mm, µm", "mean depth, µm"]
    head += ([] if planar else ["worn area, mm²"]) + ["centroid x, y, z, mm", "pieces"]
    rows = []
    for region in regions:
        cells = [str(region["tooth"]), str(region["flank"]), bare(region.get(amount))]
        cells += [number(region.get(key), 0) for key in ("max_depth_um", "mean_depth_um")]
        cells += [] if planar else [number(region.get("area_mm2"), 1)]
        rows.append([*cells, row(region.get("centroid_mm"), 1), str(region.get("patches", MISSING))])
    return table(head, rows, words=2)


def _laws(laws: list[Any]) -> str:
    if not laws:
        return ""
    rows = [
        (
            effect_words(law),
            str(law.get("flanks", "")),
            significant(law.get("rms_before_um")),
            significant(law.get("rms_after_um")),
        )
        for law in laws
    ]
    return table(("law of wear", "flanks", "RMS on worn regions before, µm", "after, µm"), rows, words=2)


def loop(report: Report, arrays: ReportArrays) -> str:
    """The closed loop: what was found besides wear, and that the error really fell."""
    title, found = "Closed loop: what else is in the scan", report.get("closed_loop") or {}
    lead = paragraph(loop_words(report), "lead")
    if not sought(report):
        return section("loop", title, lead, paragraph(_known(found)))
    effects, left = found.get("effects") or [], found.get("unexplained") or {}
    body = [lead, pictures.waterfall(found), _effects(effects)] if effects else [lead, paragraph(_known(found))]
    if left.get("found"):
        body.append(_patterns(left))
    return section("loop", title, *body, change_table(found), pictures.residual_maps(arrays))


def _known(found: Any) -> str:
    """Error and noise where there is nothing to draw."""
    before, noise = ask(found, "before", "rms_um"), found.get("noise_um")
    known = [f"the RMS of the residual outside wear is {significant(before)}{SPACE}µm"] if before is not None else []
    known += [f"the scan's own noise is {significant(noise)}{SPACE}µm"] if noise else []
    return sentence(listed(known))


def _effects(effects: list[Any]) -> str:
    def span(effect: Any, key: str) -> str:
        first, last = effect.get(f"{key}_before_um"), effect.get(f"{key}_after_um")
        return f"{significant(first)} → {significant(last)}" if last is not None else MISSING

    if not effects:
        return ""
    rows = [
        (
            sentence(effect_words(effect)).rstrip("."),
            str(effect.get("kind", "")),
            listed((effect_title(str(name)) for name in effect.get("alternatives") or []), "or") or "–",
            _evidence(effect.get("evidence")),
            span(effect, "rms"),
            span(effect, "heldout_rms"),
        )
        for effect in effects
    ]
    telling = [f"{effect_title(str(e['name']))}: {e['tells_apart']}" for e in effects if e.get("tells_apart")]
    more = paragraph("What would tell what the data cannot:") + items(map(sentence, telling)) if telling else ""
    return table(("effect", "kind", "cannot be told from", "evidence", "RMS, µm", "held out, µm"), rows, words=4) + more


def _evidence(evidence: Any) -> str:
    """Statistic, effective sample size and p-value; whatever else there is stays in the JSON file."""
    if not isinstance(evidence, dict):
        return said(evidence)
    statistic = evidence.get("value", evidence.get("statistic"))
    p = evidence.get("p_value")
    text = [f"F = {significant(statistic)}"] if isinstance(statistic, (int, float)) else []
    number_of = evidence.get("effective_sample_size")
    text += [f"n_eff = {number(float(number_of), 0)}"] if number_of is not None else []
    text += [("p < 1e−300" if p == 0 else f"p = {significant(p, 2)}")] if p is not None else []
    return ", ".join(text)


def _patterns(left: Any) -> str:
    rows = [
        (
            significant(pattern.get("order")), said(pattern.get("sides")), significant(pattern.get("waves_across_face")),
            significant(pattern.get("waves_along_profile")), significant(pattern.get("rms_um")), significant(pattern.get("peak_um")),
            significant(pattern.get("p_value"), 2),
        )
        for pattern in left.get("patterns") or []
    ]  # fmt: skip
    head = ("order round the gear", "flanks", "waves across the face", "waves along the profile", "RMS, µm", "peak, µm", "p")
    treated = paragraph(sentence(str(left["treatment"]))) if left.get("treatment") else ""
    return (table(head, rows, words=2, caption="Unexplained patterns") if rows else "") + treated


def thickness(report: Report) -> str:
    """Tooth thickness left."""
    rows = report.get("thickness") or []
    if not rows:
        none = "No tooth thickness could be measured: no tooth was seen on both flanks."
        return section("thickness", "Tooth thickness", paragraph(none))
    worn, text = bool(ask(report, "wear", "regions")), ""
    row = lost_most(report) if worn else thinnest(report)
    if row is not None:
        lost = (
            f"Tooth {row['tooth']} lost most, {number(row['loss_max_mm'], 3)} mm"
            if worn
            else f"The thinnest is tooth {row['tooth']}"
        )
        text = (
            f"{lost}; its least is {number(row.get('min_mm'), 3)} mm, designed are {number(row['nominal_mm'], 3)} mm."
            " Thickness is the arc at the reference circle, without what the scanner added; a loss is against the gear as made."
        )
    keys = [("nominal_mm", "design, mm"), ("mean_mm", "mean, mm"), ("min_mm", "least, mm"), ("loss_max_mm", "greatest loss, mm")]
    keys += [("std_mm", "± of one section, mm")] if any(r.get("std_mm") is not None for r in rows) else []
    cells = [(str(r["tooth"]), *(number(r.get(key), 3) for key, _ in keys), number(r.get("at_z_mm"), 1)) for r in rows]
    head = ("tooth", *(label for _, label in keys), "least at z, mm")
    return section("thickness", "Tooth thickness", paragraph(text), pictures.thickness(rows), table(head, cells))


_MESHING_ROWS = (
    ("centre distance, mm", ("centre_distance_mm",), 3),
    ("working pressure angle, °", ("working_pressure_angle_deg",), 3),
    ("circumferential backlash, mm", ("backlash", "circumferential_mm"), 4),
    ("normal backlash, mm", ("backlash", "normal_mm"), 4),
    ("radial backlash, mm", ("backlash", "radial_mm"), 4),
    ("angular backlash of the pinion, °", ("backlash", "angular_pinion_deg"), 4),
    ("angular backlash of the gear, °", ("backlash", "angular_gear_deg"), 4),
    ("path of contact, mm", ("path_of_contact_mm",), 3),
    ("contact ratio", ("contact_ratio",), 3),
    ("transmission error, peak to peak, µm", ("transmission_error_um",), 1),
)


def meshing(report: Report, arrays: ReportArrays) -> str:
    """Meshing, design against worn."""
    title, found = "Meshing: design against worn", report.get("meshing") or {}
    if not found.get("design"):
        alone = "The design names one gear and no mate: backlash, transmission error and contact need a pair."
        return section("meshing", title, paragraph(alone))
    rows = []
    for label, path, digits in _MESHING_ROWS:
        design, worn = ask(found, "design", *path), ask(found, "worn", *path)
        least = ask(found, "worn", *path[:-1], f"{path[-1]}_min")
        shown = number(worn, digits) if least is None else f"{number(least, digits)} … {number(worn, digits)}"
        std = ask(found, "worn", *path[:-1], f"{path[-1]}_std")
        shown += f" ± {number(std, digits)}" if std and round(std, digits) > 0.0 else ""
        rows.append((label, number(design, digits), shown, _change(design, worn, digits)))
    housing = "The housing holds the shafts at the design's centre distance. Ranges run over one revolution; ± and the change are those of the greatest."
    curves = "No curves over the revolution were computed for this scan."
    return section(
        "meshing",
        title,
        paragraph(housing),
        table(("", "design", "worn", "change"), rows),
        _take_up(found.get("take_up")),
        ageing(report),
        paragraph(curves) if arrays.meshing is None else pictures.meshing_curves(arrays.meshing),
        "" if arrays.contact_share is None or arrays.planar else pictures.contact_pattern(arrays.contact_share),
    )


def _change(design: Any, worn: Any, digits: int) -> str:
    if not isinstance(design, (int, float)) or not isinstance(worn, (int, float)):
        return MISSING
    text = number(worn - design, digits)
    return f"+{text}" if worn > design and any(digit in text for digit in "123456789") else text


def _take_up(found: Any) -> str:
    return paragraph(take_up_words(found)) if isinstance(found, dict) and "tightest" in found else ""


_PAPER_ROWS = (
    ("loss of thickness B′, mm", "thickness_loss_mm"),
    ("backlash B, mm", "backlash_mm"),
    ("change of centre distance, mm", "centre_distance_change_mm"),
    ("centre distance c′, mm", "centre_distance_mm"),
    ("pressure angle θ′, °", "pressure_angle_deg"),
    ("pitch radius of the pinion, mm", "pitch_radius_pinion_mm"),
    ("pitch radius of the gear, mm", "pitch_radius_gear_mm"),
    ("length of contact, design, mm", "contact_length_design_mm"),
    ("length of contact, worn, mm", "contact_length_worn_mm"),
)


def paper(report: Report) -> str:
    """The published calculation, from this scan's greatest thickness loss."""
    found = ask(report, "meshing", "paper")
    if not found:
        return ""
    text = (
        "After Kumar, Jain and Pathak (ICPME 2014): the loss of thickness is turned into a centre distance at which unworn gears would have"
        " the same play. It is an equivalent number: in a housing the shafts do not move, and the exact figures are those under Meshing."
    )
    if found.get("baseline"):
        text += f" The loss counts from this baseline: {effect_title(str(found['baseline']))}."
    rows = [(label, number(found.get(key), 4)) for label, key in _PAPER_ROWS]
    return section("paper", "The published calculation", paragraph(text), table(("by the paper's formulas", "value"), rows))
