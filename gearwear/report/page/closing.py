"""The sections of the page on how it was done: inspection charts, registration, scan and design, doubts, files."""

from __future__ import annotations

from typing import Any

from gearwear.design.quantity import MISSING, listed, number, sentence, significant, with_std
from gearwear.report.figures.arrays import Report, ReportArrays
from gearwear.report.page import pictures
from gearwear.report.page.parts import facts, heading, items, paragraph, section, table
from gearwear.report.words.numbers import effect_title, row, said
from gearwear.report.words.verdict import doubts

YES = {True: "yes", False: "no", None: ""}


def inspection(report: Report, arrays: ReportArrays) -> str:
    """The worst of every deviation with its class, and the charts."""
    found = report.get("inspection")
    body = [pictures.inspection_charts(arrays)]
    if isinstance(found, dict):
        graded = f", class {found['class']} in all" if found.get("class") is not None else ""
        text = f"{found.get('standard', 'evaluated')}{graded}; U is expanded uncertainty, k = {significant(found.get('coverage_factor', 2), 1)}"
        body = [paragraph(sentence(text)), _findings(found.get("findings") or []), *body]
        body.append(
            paragraph(
                " ".join(sentence(str(text)) for text in [*(found.get("notes") or []), found.get("footnote") or ""] if text)
            )
        )
    return section("inspection", "Inspection charts", *body) if any(body) else ""


def _findings(findings: list[Any]) -> str:
    if not findings:
        return ""
    rows = [
        (
            str(f.get("symbol", "")).replace("_", ""), effect_title(str(f.get("quantity", ""))), str(f.get("flank") or ""), said(f.get("tooth")),
            str(f.get("statement") or f.get("verdict") or ""), number(f.get("value_um"), 1), number(f.get("expanded_um"), 1),
            number(f.get("tolerance_um"), 1), said(f.get("class")) or MISSING,
        )
        for f in findings
    ]  # fmt: skip
    head = ("", "deviation", "flank", "tooth", "judgement", "µm", "U, µm", "tolerance, µm", "class by value")
    return table(head, rows, words=5)


def registration(report: Report) -> str:
    """How the scan was laid on the design, and what is assumed."""
    found = report.get("registration") or {}
    side = found.get("worn_side")
    datum = found.get("datum") or []
    assumed = found.get("assumptions") or []
    notes = [*(assumed if isinstance(assumed, list) else [assumed]), *(found.get("notes") or [])]
    at_base = found.get("rotation_std_at_base_circle_um")
    pairs = [
        ("settled", YES.get(found.get("converged"), "")),
        ("rests on (datum)", listed(effect_title(str(name)) for name in datum) if isinstance(datum, list) else str(datum)),
        ("worn throughout, not used", f"{side} flanks" if side else ""),
        ("assumed", " ".join(sentence(str(note)) for note in notes)),
        ("offset of all surfaces", with_std(found["offset_um"], None, "µm") if found.get("offset_um") else ""),
        ("translation x, y, z, mm", row(found.get("translation_mm"), 5)),
        ("± standard deviation, µm", row(found.get("translation_std_um"), 2)),
        ("rotation, row by row", "; ".join(row(line, 8) for line in found.get("rotation") or [])),
        ("± about x, y, z, °", row(found.get("rotation_std_deg"), 6)),
        ("± about z, at the base circle", with_std(at_base, None, "µm") if at_base is not None else ""),
        ("standard deviation", said(found.get("std"))),
    ]
    return section(
        "registration",
        "Registration: how the scan was laid on the design",
        paragraph("design = rotation · scan + translation, found without a starting guess."),
        facts(pairs),
        _views(found.get("views") or []),
    )


def _views(views: list[Any]) -> str:
    if len(views) < 2:
        return ""
    rows = [
        (
            str(i + 1), YES.get(view.get("converged"), ""), number(view.get("points"), 0), number(view.get("kept"), 0),
            significant(view.get("offset_um"), 2), significant(view.get("mismatch_um"), 2), row(view.get("translation_mm"), 4),
        )
        for i, view in enumerate(views)
    ]  # fmt: skip
    head = ("view", "settled", "points", "kept", "offset, µm", "mismatch with its neighbours, µm", "translation, mm")
    return table(head, rows, words=2)


_DESIGN = (
    ("teeth", "teeth", 0), ("module_mm", "module, mm", 4), ("pressure_angle_deg", "pressure angle, °", 3),
    ("profile_shift", "profile shift, modules", 4), ("face_width_mm", "face width, mm", 3), ("reference_radius_mm", "reference radius, mm", 4),
    ("base_radius_mm", "base radius, mm", 4), ("tip_radius_mm", "tip radius, mm", 4), ("root_radius_mm", "root radius, mm", 4),
    ("form_radius_mm", "form radius, mm", 4), ("tooth_thickness_mm", "tooth thickness, mm of arc", 4),
)  # fmt: skip


def scan(report: Report) -> str:
    """The scan and the design it was held against."""
    found, design = report.get("scan") or {}, report.get("design") or {}
    names = found.get("files") or found.get("file") or []
    kinds = {"cloud": "point cloud", "triangles": "triangles", "section": "planar section"}
    told = [
        ("files", ", ".join(map(str, [names] if isinstance(names, str) else names))),
        ("before wear", ", ".join(map(str, found.get("before_files") or []))),
        ("kind", kinds.get(str(found.get("kind")), str(found.get("kind") or ""))),
        ("points", number(found.get("points"), 0)),
        ("used", number(found.get("used"), 0)),
        ("rejected", said(found.get("rejected")) or "none"),
        ("other, left out", number(found.get("other"), 0)),
    ]
    seen = {key: share for key, share in (found.get("coverage") or {}).items() if isinstance(share, (int, float))}
    coverage = table(("surface", "seen, %"), [(effect_title(key), number(100.0 * share, 1)) for key, share in seen.items()])
    drawn = [(label, number(design[key], digits)) for key, label, digits in _DESIGN if design.get(key) is not None]
    drawn.append(("undercut", YES.get(design.get("undercut"), "")))
    columns = (
        heading("Scan") + facts(told),
        heading("Seen of each surface") + (coverage if seen else paragraph("Coverage was not computed.")),
        heading("Design") + facts(drawn),
    )
    return section(
        "scan", "Scan and design", '<div class="columns">' + "".join(f"<div>{column}</div>" for column in columns) + "</div>"
    )


def closing(report: Report) -> str:
    """Doubts, notes and files."""
    doubtful = doubts(report)
    noted = [sentence(str(text)) for text in (report.get("design") or {}).get("warnings") or []]
    told = list(dict.fromkeys([*doubtful, *noted]))
    names = [str(name) for name in report.get("files") or []]
    first = section("doubts", "Warnings and doubts", items(told) if told else paragraph("None."))
    return first + "\n" + section("files", "Files written", items(names) if names else paragraph("None."))
