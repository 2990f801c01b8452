"""The report as one page: works offline from disk, prints to a clean PDF."""

from __future__ import annotations

import json
from html import escape
from importlib.resources import files
from pathlib import Path
from string import Template

from gearwear.report.figures.arrays import Report, ReportArrays
from gearwear.report.figures.colours import ColourScale, colour_scale
from gearwear.report.files.writing import finite
from gearwear.report.words.verdict import doubts, grave_doubts, key_figures, subject, verdict

CONTENTS = (
    ("wear", "Wear"), ("loop", "Closed loop"), ("thickness", "Thickness"), ("meshing", "Meshing"), ("inspection", "Inspection charts"),
    ("paper", "Published calculation"), ("registration", "Registration"), ("scan", "Scan and design"), ("doubts", "Warnings and doubts"),
    ("files", "Files"),
)  # fmt: skip


def write_html(path: Path, report: Report, arrays: ReportArrays) -> None:
    """Write the page.

    Parameters
    ----------
    path : Path
        The file.
    report : mapping
        As `report.json`.
    arrays : ReportArrays
        What the figures draw.
    """
    path.write_text(page(report, arrays), encoding="utf-8")


def page(report: Report, arrays: ReportArrays) -> str:
    """The page as text; the same bytes for the same input."""
    from matplotlib import rc_context

    from gearwear.report import figures
    from gearwear.report.page import closing, sections

    report = finite(report)
    scale = colour_scale(arrays.deviation_um)
    with rc_context(figures.STYLE):
        viewer, scripts = _viewer(report, arrays, scale)
        body = [
            sections.wear(report, arrays, scale), sections.loop(report, arrays), sections.thickness(report), sections.meshing(report, arrays),
            closing.inspection(report, arrays), sections.paper(report), closing.registration(report), closing.scan(report),
            closing.closing(report),
        ]  # fmt: skip
    text = "\n".join(piece for piece in body if piece)
    links = "".join(f'<a href="#{ident}">{label}</a>' for ident, label in CONTENTS if f'<section id="{ident}"' in text)
    return Template(_own("page.html")).substitute(
        title=escape(f"Wear report: {subject(report)}"),
        css=_own("page.css"),
        heading="Gear wear report",
        subject=escape(subject(report)),
        contents=links,
        doubtful=" doubtful" if grave_doubts(report) else "",
        verdict=escape(verdict(report)),
        doubts=_doubts(report),
        viewer=viewer,
        readout='<p class="readout" id="readout">Drag to turn, scroll to zoom, click a point to read it.</p>' if scripts else "",
        under=escape(_under(arrays, scale)),
        key="\n".join(
            f"<div><dt>{escape(name)}</dt><dd>{escape(value)}<small>{escape(note)}</small></dd></div>"
            for name, value, note in key_figures(report)
        ),
        sections=text,
        footer=escape(_footer(report)),
        scripts=scripts,
    )


def _own(name: str) -> str:
    return files(__package__).joinpath(name).read_text(encoding="utf-8")


def _doubts(report: Report) -> str:
    said = doubts(report)
    if not said:
        return ""
    shown = "".join(f"<li>{escape(text)}</li>" for text in said[:3])
    more = f'<li><a href="#doubts">and {len(said) - 3} more</a></li>' if len(said) > 3 else ""
    return f'<div class="doubts"><b>Please note</b><ul>{shown}{more}</ul></div>'


def _under(arrays: ReportArrays, scale: ColourScale) -> str:
    """Caption of the picture of the first screen."""
    if arrays.planar:
        return f"The section as it is, coloured by its deviation from the design; grey: fillets and roots, or not seen. {scale.words}"
    return f"The gear as it is, at true scale, coloured by its deviation from the design; grey: ends, or not seen. {scale.words}"


def _footer(report: Report) -> str:
    made = " ".join(str(word) for word in ("gearwear", report.get("version")) if word)
    return (
        f"Made by {made}. Deviations are along the outward normal, + is too much material. Teeth count from 1, counter-clockwise"
        " seen from +z; the left flank is the counter-clockwise side. Standard deviations are one sigma."
    )


def _viewer(report: Report, arrays: ReportArrays, scale: ColourScale) -> tuple[str, str]:
    """The picture of the first screen, and the scripts that bring it to life ("" where it stays a picture)."""
    from matplotlib.figure import Figure

    from gearwear.report import figures
    from gearwear.report.figures.scene import eye_direction, scene, still
    from gearwear.report.figures.surfaces import gear_surfaces, whole_outline, worn_volume
    from gearwear.report.page.parts import png

    figure = Figure(figsize=(7.2, 4.9))
    bar = figure.add_axes((0.88, 0.2, 0.016, 0.6))
    if arrays.planar:
        figures.outline(figure.add_axes((0.08, 0.1, 0.76, 0.88)), *whole_outline(arrays), scale)
        figures.colour_bar(bar, scale)
        return f'<img class="still" alt="The section coloured by deviation" src="{png(figure)}">', ""
    eye = eye_direction(report, arrays)
    worn = gear_surfaces(arrays, worn=True)
    still(figure.add_axes((0.0, 0.0, 0.86, 1.0)), worn, scale, eye)
    figures.colour_bar(bar, scale)
    drawn = scene(gear_surfaces(arrays, worn=False), worn, worn_volume(arrays), scale, eye)
    lost = '<button type="button" data-group="lost" aria-pressed="false">Lost metal</button>' if drawn["groups"]["lost"] else ""
    inner = (
        '<div class="bar" role="group" aria-label="What is shown">'
        '<button type="button" data-group="worn" aria-pressed="true">Worn gear</button>'
        f'{lost}<button type="button" data-group="nominal" aria-pressed="false">Design</button></div>'
        '<div id="view"></div>'
        f'<img class="still" alt="The worn gear coloured by deviation" src="{png(figure)}">'
    )
    packed = json.dumps(drawn, allow_nan=False, separators=(",", ":")).replace("</", "<\\/")
    library = files("plotly").joinpath("package_data/plotly.min.js").read_text(encoding="utf-8")
    scripts = f'<script type="application/json" id="scene">{packed}</script>\n<script>{library}</script>\n<script>\n{_own("page.js")}</script>'
    return inner, scripts
