"""The report as one page: works offline from disk, prints to a clean PDF."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.resources import files as resources
from pathlib import Path
from typing import Any

from markupsafe import Markup

from gearwear.comparison.results import Results
from gearwear.report.figures.arrays import ReportArrays
from gearwear.report.figures.colours import ColourScale, colour_scale
from gearwear.report.page.blocks import Section
from gearwear.report.page.environment import environment
from gearwear.report.records.comparison import program_version
from gearwear.report.words.verdict import KeyFigure, doubts, grave_doubts, key_figures, subject, verdict


@dataclass(frozen=True, slots=True, kw_only=True)
class PageView:
    """What the template of the page fills in.

    Parameters
    ----------
    subject, verdict, under, footer : str
        What was measured, what became of it, the caption of the first picture, and the last line.
    doubtful : bool
        Whether the whole result is.
    doubts : sequence of str
        What the reader must know, each a sentence.
    figures : sequence of KeyFigure
        What comes first.
    still, still_words : str
        The first picture as an address, and in words.
    scene : dict or None
        What plotly draws in its place; None where it stays a picture.
    sections : sequence of Section
    """

    subject: str
    verdict: str
    doubtful: bool
    doubts: Sequence[str]
    figures: Sequence[KeyFigure]
    still: str
    still_words: str
    under: str
    scene: dict[str, Any] | None
    sections: Sequence[Section]
    footer: str

    @property
    def packed(self) -> Markup:
        """The scene as JSON that ends no script."""
        return Markup(json.dumps(self.scene, allow_nan=False, separators=(",", ":")).replace("</", "<\\/"))


def write_html(path: Path, results: Results, arrays: ReportArrays, files: Sequence[str] = ()) -> None:
    """Write the page.

    Parameters
    ----------
    path : Path
        The file.
    results : Results
    arrays : ReportArrays
        What the figures draw.
    files : sequence of str
        What was written beside it.
    """
    path.write_text(page(results, arrays, files), encoding="utf-8")


def page(results: Results, arrays: ReportArrays, files: Sequence[str] = ()) -> str:
    """The page as text; the same bytes for the same input."""
    view = view_of(results, arrays, files)
    library = ""
    if view.scene is not None:
        library = resources("plotly").joinpath("package_data/plotly.min.js").read_text(encoding="utf-8")
    return environment().get_template("page.html.j2").render(view=view, library=Markup(library))


def view_of(results: Results, arrays: ReportArrays, files: Sequence[str] = ()) -> PageView:
    """What stands on the page."""
    from matplotlib import rc_context

    from gearwear.report import figures
    from gearwear.report.page import sections

    scale = colour_scale(arrays.deviation_um)
    with rc_context(figures.STYLE):
        still, scene = _first_picture(results, arrays, scale)
        every = (
            sections.wear(results, arrays, scale), sections.loop(results, arrays), sections.thickness(results),
            sections.meshing(results, arrays), sections.inspection(arrays), sections.paper(results), sections.registration(results),
            sections.scan(results), sections.closing(results), sections.written(files),
        )  # fmt: skip
    what = "section" if arrays.planar else "gear"
    return PageView(
        subject=subject(results.part, results.gear, results.measured.scans),
        verdict=verdict(results),
        doubtful=bool(grave_doubts(results)),
        doubts=doubts(results),
        figures=key_figures(results),
        still=still,
        still_words=f"The {'section' if arrays.planar else 'worn gear'} coloured by deviation",
        under=f"The {what} as it is, {'' if arrays.planar else 'at true scale, '}coloured by its deviation from the design; grey:"
        f" {'fillets and roots' if arrays.planar else 'ends'}, or not seen. {scale.words}",
        scene=scene,
        sections=[one for one in every if one is not None],
        footer=f"Made by {' '.join(filter(None, ('gearwear', program_version())))}. Deviations are along the outward normal, + is too much"
        " material. Teeth count from 1, counter-clockwise seen from +z; the left flank is the counter-clockwise side. Standard deviations"
        " are one sigma.",
    )


def _first_picture(results: Results, arrays: ReportArrays, scale: ColourScale) -> tuple[str, dict[str, Any] | None]:
    """The picture of the first screen, and what brings it to life; None where it stays a picture."""
    from matplotlib.figure import Figure

    from gearwear.report import figures
    from gearwear.report.figures.scene import eye_direction, scene, still
    from gearwear.report.figures.surfaces import gear_surfaces, whole_outline, worn_volume
    from gearwear.report.page.blocks import png

    figure = Figure(figsize=(7.2, 4.9))
    bar = figure.add_axes((0.88, 0.2, 0.016, 0.6))
    figures.colour_bar(bar, scale)
    if arrays.planar:
        figures.outline(figure.add_axes((0.08, 0.1, 0.76, 0.88)), *whole_outline(arrays), scale)
        return png(figure), None
    eye = eye_direction(results.wear.regions, arrays.gear)
    worn = gear_surfaces(arrays, worn=True)
    still(figure.add_axes((0.0, 0.0, 0.86, 1.0)), worn, scale, eye)
    return png(figure), scene(gear_surfaces(arrays, worn=False), worn, worn_volume(arrays), scale, eye)
