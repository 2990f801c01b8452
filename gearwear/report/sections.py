"""The sections of the page, in the order they are read. Whatever is missing is said to be missing."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from gearwear.arrays import Floats
from gearwear.report import figures
from gearwear.report.arrays import Report, ReportArrays
from gearwear.report.colours import BLUE, TEAL, ColourScale, colour_scale
from gearwear.report.parts import FULL, HALF, THIRD, facts, heading, items, paragraph, picture, section, table
from gearwear.report.surfaces import section as tooth_outline
from gearwear.report.verdict import doubts, loop_words, sought, thinnest, unexplained_words
from gearwear.report.words import (
    MISSING, SPACE, ask, bare, effect_title, effect_words, listed, number, plural, quantity, said, sentence, significant,
)  # fmt: skip


def wear(report: Report, arrays: ReportArrays, scale: ColourScale) -> str:
    """Wear by tooth and flank: the map, the regions, the laws, sections of the worst teeth."""
    found = report.get("wear") or {}
    regions = found.get("regions") or []
    amount, unit = ("area_mm2", "mm²") if arrays.planar or "area_mm2" in found else ("volume_mm3", "mm³")
    rows = [
        (
            str(region["tooth"]), str(region["flank"]), bare(region.get(amount)), number(region.get("max_depth_um"), 0),
            number(region.get("mean_depth_um"), 0), "" if arrays.planar else number(region.get("area_mm2"), 1),
            _row(region.get("centroid_mm"), 1), str(region.get("patches", MISSING)),
        )
        for region in regions
    ]  # fmt: skip
    head = (
        "tooth", "flank", f"{'area' if arrays.planar else 'volume'}, {unit}", "deepest 0.5 × 0.5 mm, µm", "mean depth, µm",
        "" if arrays.planar else "worn area, mm²", "centroid x, y, z, mm", "pieces",
    )  # fmt: skip
    if arrays.planar:
        rows, head = [(*row[:5], *row[6:]) for row in rows], (*head[:5], *head[6:])  # type: ignore[misc]
    total = found.get(amount)
    before = ask(found, "before_loop", amount)
    text = (
        f"In all {quantity(total, unit)} {'of the section' if arrays.planar else 'of metal'} from {plural(len(regions), 'flank')}."
        if regions
        else "No region of wear stands out of the scatter of this scan."
    )
    if regions and sought(report) and before:
        text += f" Without taking the effects of scan and manufacture out first it would have been {quantity(before, unit)}."
    if arrays.planar:
        text += " A planar section gives areas; volumes would need a scan of the whole face width."
    return section(
        "wear", "Wear by tooth and flank", paragraph(text), _deviation_figure(arrays, scale),
        table(head, rows, words=2) if regions else "", _laws(found.get("laws") or []), _sections(report, arrays),
    )  # fmt: skip


def _deviation_figure(arrays: ReportArrays, scale: ColourScale) -> str:
    if arrays.planar:
        return _charts(arrays, "deviation", arrays.deviation_um)
    teeth = arrays.gear.teeth
    rows = -(-teeth // figures.teeth_in_a_row(teeth))
    figure = Figure(figsize=(FULL, 0.8 + 2.1 * rows))
    figures.flank_map(figure.add_axes((0.0, 0.0, 0.93, 1.0)), arrays.deviation_um, scale)
    figures.colour_bar(figure.add_axes((0.95, 0.08, 0.012, 0.8)), scale)
    return picture(
        figure, "map", "Deviation from the design, all flanks unrolled",
        f"Blue is missing metal, red too much; a worn flank is blue among pale ones, and what all flanks share is not wear. Hatched: not seen. {scale.words}",
    )  # fmt: skip


def _laws(laws: list[Any]) -> str:
    if not laws:
        return ""
    rows = [
        (effect_words(law), significant(law.get("rms_before_um")), significant(law.get("rms_after_um")))
        for law in laws
    ]  # fmt: skip
    return table(("law of wear", "RMS on worn regions before, µm", "after, µm"), rows)


def _sections(report: Report, arrays: ReportArrays) -> str:
    regions = ask(report, "wear", "regions") or []
    worst: dict[int, Any] = {}
    for region in regions:
        worst.setdefault(int(region["tooth"]), region)
    if not worst:
        return ""
    heights = {row["tooth"]: row.get("at_z_mm") for row in report.get("thickness") or []}
    figure = Figure(figsize=(FULL, 3.6))
    shown = list(worst)[:3]
    axes = figure.subplots(1, max(len(shown), 2), squeeze=False)[0]
    figure.subplots_adjust(left=0.05, right=0.99, wspace=0.1)
    for axis in axes[len(shown) :]:
        axis.remove()
    for axis, tooth in zip(axes, shown, strict=False):
        z = heights.get(tooth)
        z = float(z) if z is not None else float(arrays.z_mm[len(arrays.z_mm) // 2])
        nominal, worn = tooth_outline(arrays, tooth, z)
        factor = figures.magnification(nominal, worn)
        figures.tooth_section(axis, nominal, worn, arrays.gear.reference_radius, factor)
        axis.set_title(f"tooth {tooth}, z = {number(z, 1)} mm" + (f", loss × {factor:g}" if factor > 1.0 else ", true scale"))
        axis.legend(loc="upper center", bbox_to_anchor=(0.5, -0.17), ncols=2)
        if axis is not axes[0]:
            axis.set_ylabel("")
    return picture(
        figure, "sections", f"Worn against design: the worst {plural(len(shown), 'tooth', 'teeth')}",
        "Each tooth upright in its own frame, left flank on the left, where it is thinnest. The filled strip is the lost metal,"
        " magnified across the flank by the factor in the title where it would not show at true scale.",
    )  # fmt: skip


def loop(report: Report, arrays: ReportArrays) -> str:
    """The closed loop: what was found besides wear, and that the error really fell."""
    found = report.get("closed_loop") or {}
    body = [paragraph(loop_words(report), "lead")]
    if not sought(report):
        before = ask(found, "before", "rms_um")
        known = [f"the RMS of the residual outside wear is {significant(before)}{SPACE}µm"] if before is not None else []
        if found.get("noise_um"):
            known.append(f"the scan's own noise is {significant(found['noise_um'])}{SPACE}µm")
        return section("loop", "Closed loop: what else is in the scan", *body, paragraph(sentence(listed(known))))
    effects = found.get("effects") or []
    figure = Figure(figsize=(0.78 * FULL, 0.75 + 0.34 * (len(effects) + 2)))
    figures.waterfall(figure.add_axes((0.2, 0.0, 0.8, 1.0)), found)
    body.append(picture(
        figure, "waterfall", "Residual error, effect by effect",
        "Each bar is what one effect takes away, on the same points throughout. The loop has closed where the last bar meets the"
        " scan's own noise; the diamonds show that the gain is as large on data the fit never saw.",
    ))  # fmt: skip
    if effects:
        body.append(_effects(effects))
    left = found.get("unexplained") or {}
    body.append(paragraph(sentence(unexplained_words(report))) if left else "")
    if left.get("found") is False and left.get("pattern"):
        body.append(paragraph(sentence(f"what is left looks like this: {said(left['pattern'])}")))
    body.append(_residuals(arrays))
    return section("loop", "Closed loop: what else is in the scan", *body)


def _effects(effects: list[Any]) -> str:
    def span(effect: Any, key: str) -> str:
        first, last = effect.get(f"{key}_before_um"), effect.get(f"{key}_after_um")
        return f"{significant(first)} → {significant(last)}" if last is not None else MISSING

    rows = [
        (
            sentence(effect_words(effect)).rstrip("."), str(effect.get("kind", "")),
            listed((effect_title(str(name)) for name in effect.get("alternatives") or []), "or") or "none: certain",
            _evidence(effect.get("evidence")), span(effect, "rms"), span(effect, "heldout_rms"),
        )
        for effect in effects
    ]  # fmt: skip
    head = ("effect", "kind", "cannot be told from", "evidence", "RMS, µm", "RMS held out, µm")
    return table(head, rows, words=4)


def _evidence(evidence: Any) -> str:
    if not isinstance(evidence, dict):
        return "" if evidence is None else str(evidence)
    names = {"p_value": "p", "effective_sample_size": "effective n", "n_eff": "effective n"}
    return ", ".join(f"{names.get(key, effect_title(key))} = {said(value)}" for key, value in evidence.items() if value is not None)


def _residuals(arrays: ReportArrays) -> str:
    before, after = arrays.residual_before_um, arrays.residual_after_um
    if before is None or after is None:
        return ""
    if arrays.planar:
        return _charts(arrays, "residual before", before) + _charts(arrays, "residual after", after)
    scale = colour_scale(before, after)
    teeth = arrays.gear.teeth
    across = figures.teeth_in_a_row(teeth, 8)
    rows = -(-teeth // across)
    figure = Figure(figsize=(FULL, 0.7 + 1.25 * rows))
    left, right = figure.add_axes((0.0, 0.0, 0.435, 1.0)), figure.add_axes((0.49, 0.0, 0.435, 1.0))
    for axis, values, title in ((left, before, "before"), (right, after, "after")):
        figures.flank_map(axis, values, scale, across)
        rms = float(np.sqrt(np.nanmean(values**2)))
        axis.set_title(f"{title}: RMS of the cells {significant(rms)} µm")
        axis.set_xlabel("tooth; each picture root → tip")
    right.set_ylabel("")
    figures.colour_bar(figure.add_axes((0.95, 0.08, 0.012, 0.8)), scale, "residual, µm")
    return picture(
        figure, "residual", "Residual before and after the loop, same points, one scale",
        f"Structure on the left is what the model lacked; on the right only speckle should be left. Cells are means over points, so their RMS is below that of the points. Hatched: worn, or not seen. {scale.words}",
    )  # fmt: skip


def thickness(report: Report) -> str:
    """Tooth thickness left."""
    rows = report.get("thickness") or []
    if not rows:
        return section(
            "thickness", "Tooth thickness", paragraph("No tooth thickness could be measured: no tooth was seen on both flanks.")
        )
    figure = Figure(figsize=(FULL, 2.7))
    figures.thickness_per_tooth(figure.add_axes((0.06, 0.1, 0.92, 0.8)), rows)
    row = thinnest(report)
    text = ""
    if row is not None:
        text = (
            f"Tooth {row['tooth']} lost most: {number(row['loss_max_mm'], 3)} mm of {number(row['nominal_mm'], 3)} mm, at z ="
            f" {number(row.get('at_z_mm'), 1)} mm. Thickness is the arc at the reference circle, corrected for the effects above."
        )
    cells = [
        tuple([str(r["tooth"]), *(number(r.get(k), 3) for k in ("nominal_mm", "mean_mm", "min_mm", "loss_max_mm")), number(r.get("at_z_mm"), 1)])
        for r in rows
    ]  # fmt: skip
    head = ("tooth", "design, mm", "mean, mm", "least, mm", "greatest loss, mm", "at z, mm")
    return section(
        "thickness", "Tooth thickness", paragraph(text),
        picture(figure, "thick", "Thickness tooth by tooth", "A tooth is worn where its triangle leaves the dashed line; the bar runs from the mean to the least."),
        table(head, cells),
    )  # fmt: skip


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
        return section(
            "meshing",
            title,
            paragraph("The design names one gear and no mate: backlash, transmission error and contact need a pair."),
        )
    rows = []
    for label, path, digits in _MESHING_ROWS:
        design, worn = ask(found, "design", *path), ask(found, "worn", *path)
        least = ask(found, "worn", *path[:-1], f"{path[-1]}_min")
        shown = number(worn, digits) if least is None else f"{number(least, digits)} … {number(worn, digits)}"
        change = number(worn - design, digits) if isinstance(worn, (int, float)) and isinstance(design, (int, float)) else MISSING
        rows.append(
            (
                label,
                number(design, digits),
                shown,
                change if change[0] in "−–" or float(change.replace(SPACE, "")) == 0 else f"+{change}",
            )
        )
    body = [
        paragraph("The housing holds the shafts at the design's centre distance. Ranges run over one revolution; the change is that of the greatest."),
        table(("", "design", "worn", "change"), rows),
    ]  # fmt: skip
    curves = arrays.meshing
    if curves is None:
        body.append(paragraph("No curves over the revolution were computed for this scan."))
    else:
        figure = Figure(figsize=(FULL, 2.5))
        left, right = figure.subplots(1, 2)
        figure.subplots_adjust(left=0.06, right=0.99, wspace=0.24)
        figures.backlash(left, curves)
        figures.transmission_error(right, curves)
        body.append(picture(
            figure, "curves", "Backlash and transmission error over a revolution",
            "Backlash grows while a worn flank carries; the transmission error drops by the depth the mate sinks in. A neighbour that still carries hides part of a single worn tooth.",
        ))  # fmt: skip
    if arrays.contact_gap_um is not None and not arrays.planar:
        body.append(_contact(arrays.contact_gap_um, arrays.gear.teeth))
    return section("meshing", title, *body)


def _contact(gap_um: Floats, teeth: int) -> str:
    limit = 20.0
    figure = Figure(figsize=(FULL, 0.8 + 2.0 * -(-teeth // figures.teeth_in_a_row(teeth))))
    axis = figures.gap_map(figure.add_axes((0.0, 0.0, 0.93, 1.0)), gap_um, limit)
    bar = figure.colorbar(axis.images[-1], cax=figure.add_axes((0.95, 0.08, 0.012, 0.8)))
    bar.set_ticks([0.0, 0.5, 1.0], labels=["0", f"{0.5 * limit:g}", f"≥ {limit:g}"])
    bar.set_label("least gap to the mate, µm")
    return picture(
        figure, "contact", "Contact pattern",
        "Dark: the flank touches its mate, unloaded, somewhere in the revolution; light: it no longer does. Hatched: out of reach of the mate.",
    )  # fmt: skip


def inspection(report: Report, arrays: ReportArrays) -> str:
    """Profile and helix charts, and the evaluated deviations where the report has them."""
    body = [] if arrays.planar else [_charts(arrays, "deviation", arrays.deviation_um)]
    rows = report.get("inspection") or []
    if isinstance(rows, list) and rows:
        keys = list(rows[0])
        body.append(table([effect_title(key) for key in keys], [[said(row.get(key)) or MISSING for key in keys] for row in rows]))
    return section("inspection", "Inspection charts", *body) if body else ""


def _charts(arrays: ReportArrays, what: str, values: Floats) -> str:
    """Profile traces (mean of the middle half of the face) and helix traces (mean of the middle half of the roll)."""
    rows, columns = values.shape[2:]
    with np.errstate(invalid="ignore"):
        profile = _mean(values[:, :, rows // 4 : max(rows - rows // 4, rows // 4 + 1)], 2)
        helix = _mean(values[..., columns // 4 : columns - columns // 4], 3)
    bulk = np.abs(profile[np.isfinite(profile)])
    step = 2.0 * colour_scale(np.array([np.quantile(bulk, 0.75) if bulk.size else 1.0])).limit_um
    kinds: list[tuple[str, Floats, Floats, str]] = [("profile", arrays.roll_mm, profile, "roll length, mm")]
    if not arrays.planar:
        kinds.append(("helix", arrays.z_mm, helix, "z, mm"))
    figure = Figure(figsize=(FULL, 1.0 + 2.2 * len(kinds)))
    axes = figure.subplots(len(kinds), 2, squeeze=False)
    figure.subplots_adjust(left=0.06, right=0.99, wspace=0.1, hspace=0.5)
    for (name, along, data, label), pair in zip(kinds, axes, strict=True):
        for side, (word, colour) in enumerate((("left", BLUE), ("right", TEAL))):
            figures.traces(pair[side], along, data[:, side], step, colour)
            pair[side].set_title(f"{name}, {word} flanks")
        pair[0].set_ylabel(label)
    return picture(
        figure, "charts-" + what.replace(" ", "-"), f"{what.capitalize()} as gear charts",
        "A trace per tooth on its own line; to the right of the line is too much material, to the left missing."
        + ("" if arrays.planar else " Profile: mean over the middle half of the face; helix: over the middle half of the roll.")
        + " A triangle marks traces cut off at the neighbour's line.",
    )  # fmt: skip


def _row(values: Any, digits: int) -> str:
    """A vector on one line."""
    return ", ".join(number(value, digits) for value in values or [])


def _mean(values: Floats, axis: int) -> Floats:
    """Mean of what was seen; nan where nothing was."""
    seen = np.isfinite(values)
    count = seen.sum(axis=axis)
    return np.where(count > 0, np.where(seen, values, 0.0).sum(axis=axis) / np.maximum(count, 1), np.nan)


def paper(report: Report) -> str:
    """The published calculation, from this scan's greatest thickness loss."""
    found = ask(report, "meshing", "paper")
    if not found:
        return ""
    rows = [
        ("loss of thickness B′, mm", number(found.get("thickness_loss_mm"), 4)),
        ("backlash B, mm", number(found.get("backlash_mm"), 4)),
        ("change of centre distance, mm", number(found.get("centre_distance_change_mm"), 4)),
        ("centre distance C′, mm", number(found.get("centre_distance_mm"), 4)),
        ("pressure angle θ′, °", number(found.get("pressure_angle_deg"), 4)),
        ("pitch radius of the pinion, mm", number(found.get("pitch_radius_pinion_mm"), 4)),
        ("pitch radius of the gear, mm", number(found.get("pitch_radius_gear_mm"), 4)),
        ("length of contact, design, mm", number(found.get("contact_length_design_mm"), 4)),
        ("length of contact, worn, mm", number(found.get("contact_length_worn_mm"), 4)),
    ]  # fmt: skip
    return section(
        "paper", "The published calculation",
        paragraph("After Kumar, Jain and Pathak (ICPME 2014): the loss of thickness is turned into a centre distance at which unworn gears would have the same play. It is an equivalent number: in a housing the shafts do not move, and the exact figures are those under Meshing."),
        table(("as printed", "value"), rows),
    )  # fmt: skip


def registration(report: Report) -> str:
    """How the scan was laid on the design, and what is assumed."""
    found = report.get("registration") or {}
    datum, assumed = found.get("datum"), found.get("assumptions") or []
    matrix = "; ".join(" ".join(number(v, 8) for v in row) for row in found.get("rotation") or [])
    spread = found.get("std") or found.get("uncertainty") or {}
    pairs = [
        ("settled", {True: "yes", False: "no"}.get(found.get("converged"), MISSING)),  # type: ignore[arg-type]
        ("datum: the surfaces it rests on", listed(map(str, datum)) if isinstance(datum, (list, tuple)) else str(datum or "")),
        ("assumed", "; ".join(map(str, assumed)) if isinstance(assumed, (list, tuple)) else str(assumed)),
        ("standard deviation", said(spread)),
        ("translation, mm", _row(found.get("translation_mm"), 5)),
        ("rotation, row by row", matrix),
    ]
    views = found.get("views") or []
    rows = [
        (str(i + 1), {True: "yes", False: "no"}.get(view.get("converged"), MISSING), _row(view.get("translation_mm"), 4))
        for i, view in enumerate(views)
    ]  # fmt: skip
    return section(
        "registration", "Registration: how the scan was laid on the design",
        paragraph("design = rotation · scan + translation, found without a starting guess."), facts(pairs),
        table(("view", "settled", "translation, mm"), rows) if len(views) > 1 else "",
    )  # fmt: skip


def scan(report: Report) -> str:
    """The scan and the design it was held against."""
    found, design = report.get("scan") or {}, report.get("design") or {}
    names = found.get("files") or found.get("file") or []
    names = [names] if isinstance(names, str) else names
    counts = [(key, number(found.get(key), 0)) for key in ("points", "used", "rejected", "other") if found.get(key) is not None]
    kinds = {"cloud": "point cloud", "triangles": "triangles", "section": "planar section"}
    seen = found.get("coverage") or {}
    labels = {"other": "other, left out", "rejected": "rejected as stray", "used": "used"}
    left = facts([
        ("files", ", ".join(map(str, names))), ("kind", kinds.get(str(found.get("kind")), str(found.get("kind", "")))),
        *((labels.get(key, key), value) for key, value in counts),
    ])  # fmt: skip
    coverage = table(
        ("surface", "seen, %"), [(effect_title(key), number(100.0 * share, 1)) for key, share in seen.items() if isinstance(share, (int, float))]
    )  # fmt: skip
    known = {
        "module_mm": ("module, mm", 4),
        "pressure_angle_deg": ("pressure angle, °", 3),
        "face_width_mm": ("face width, mm", 3),
    }
    radii = {f"{k}_radius_mm": (f"{k} radius, mm", 4) for k in ("reference", "base", "tip", "root", "form")}
    pairs = [("teeth", str(design.get("teeth", "")))]
    pairs += [
        (label, number(design[key], digits)) for key, (label, digits) in (known | radii).items() if design.get(key) is not None
    ]
    if design.get("tooth_thickness_mm") is not None:
        pairs.append(("tooth thickness, mm of arc", number(design["tooth_thickness_mm"], 4)))
    pairs.append(("undercut", {True: "yes", False: "no"}.get(design.get("undercut"), "")))  # type: ignore[arg-type]
    return section(
        "scan", "Scan and design", '<div class="columns"><div>' + heading("Scan") + left + "</div><div>" + heading("Seen of each surface")
        + (coverage if seen else paragraph("Coverage was not computed.")) + "</div><div>" + heading("Design") + facts(pairs) + "</div></div>",
    )  # fmt: skip


def closing(report: Report) -> str:
    """Doubts and files."""
    doubtful = doubts(report)
    names = [str(name) for name in report.get("files") or []]
    return section(
        "doubts", "Warnings and doubts", items(doubtful) if doubtful else paragraph("None.")
    ) + "\n" + section("files", "Files written", items(names) if names else paragraph("None."))  # fmt: skip


__all__ = [
    "FULL",
    "HALF",
    "THIRD",
    "closing",
    "inspection",
    "loop",
    "meshing",
    "paper",
    "registration",
    "scan",
    "thickness",
    "wear",
]
