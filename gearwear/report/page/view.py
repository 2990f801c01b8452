"""The report as one page: works offline from disk, prints to a clean PDF."""

from __future__ import annotations

import base64
import hashlib
import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from markupsafe import Markup

from gearwear.arrays import Floats
from gearwear.comparison.results import Results
from gearwear.design.gear import Gear
from gearwear.processors import each
from gearwear.report.figures.arrays import ReportArrays
from gearwear.report.figures.colours import ColourScale, colour_scale
from gearwear.report.logo import read_logo
from gearwear.report.page.blocks import Section, pictures_of
from gearwear.report.page.environment import environment
from gearwear.report.records.comparison import made_by
from gearwear.report.words.verdict import KeyFigure, doubts, grave_doubts, key_figures, subject, verdict

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from gearwear.report.figures.views import ColouredGear

VIEWER = ("viewer/camera.js", "viewer/surfaces.js", "page.js")
"""The scripts of the 3-D view; each uses what stands in those before it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PageView:
    """What the template of the page fills in.

    Parameters
    ----------
    title, subject, verdict, under, footer : str
        What it is, what was measured, what became of it, the caption of the first picture, and the last line.
    details : sequence of (str, str)
        What was given to stand at its head, by name.
    logo : str
        As the address of an image in the page itself; empty without one.
    doubtful : bool
        Whether the whole result is.
    doubts : sequence of str
        What the reader must know, each a sentence.
    figures : sequence of KeyFigure
        What comes first.
    still : callable
        Draws the first picture: its address; empty without one.
    still_words : str
        The same in words.
    scene : dict or None
        What the viewer draws in its place; None where it stays a picture.
    scripts : sequence of Markup
        The viewer: camera, surfaces, and the view they make.
    sections : sequence of Section
    """

    title: str
    subject: str
    details: Sequence[tuple[str, str]]
    logo: str
    verdict: str
    doubtful: bool
    doubts: Sequence[str]
    figures: Sequence[KeyFigure]
    still: Callable[[], str]
    still_words: str
    under: str
    scene: dict[str, Any] | None
    scripts: Sequence[Markup]
    sections: Sequence[Section]
    footer: str

    @property
    def marking(self) -> str:
        """Part and serial number, for the foot of every page."""
        details = dict(self.details)
        return " · ".join(f"{name} {details[name]}" for name in ("part number", "serial") if name in details)

    @property
    def made_by(self) -> str:
        """Program and version."""
        return made_by()

    @property
    def packed(self) -> Markup:
        """The scene as JSON that ends no script."""
        # Text within it stays text: what could end the script, or begin markup, is written as its code.
        return Markup(json.dumps(self.scene, allow_nan=False, separators=(",", ":")).replace("<", "\\u003c"))

    @property
    def allowed(self) -> Markup:
        """Sources of scripts for the content policy: these scripts, told by their hashes, and no other."""
        digests = (hashlib.sha256(script.encode()).digest() for script in self.scripts)
        return Markup(" ".join(f"'sha256-{base64.b64encode(digest).decode('ascii')}'" for digest in digests) or "'none'")

    @property
    def lost(self) -> bool:
        """Whether there is lost metal to be shown."""
        return self.scene is not None and any(surface["group"] == "lost" for surface in self.scene["surfaces"])


def write_html(path: Path, view: PageView, beside: Sequence[Callable[[], object]] = ()) -> None:
    """Write the page; what is to be done `beside`, where a processor is idle, is done as well."""
    path.write_bytes(rendered(view, beside).encode())


def page(results: Results, arrays: ReportArrays, files: Sequence[str] = ()) -> str:
    """The page as text; the same bytes for the same input."""
    return rendered(view_of(results, arrays, files))


def rendered(view: PageView, beside: Sequence[Callable[[], object]] = ()) -> str:
    """The page as text."""
    pictures = pictures_of(block for section in view.sections for block in section.blocks)
    # The charts take longest and are the last: begun first, they end with the others.
    calls = [*(picture.svg for picture in reversed(pictures)), view.still, *beside]
    found = dict(zip([*(picture.ident for picture in reversed(pictures)), ""], each(calls), strict=False))
    return environment().get_template("page.html.j2").render(view=view, still=found[""], drawn=found)


def address(logo: str) -> str:
    """A logo's file as the address of an image; empty for none."""
    return f"data:image/png;base64,{base64.b64encode(read_logo(logo).png).decode('ascii')}" if logo else ""


def view_of(results: Results, arrays: ReportArrays, files: Sequence[str] = (), command: str = "") -> PageView:
    """What stands on the page.

    Parameters
    ----------
    results : Results
    arrays : ReportArrays
        What the figures draw.
    files : sequence of str
        What was written beside it.
    command : str
        How it was asked for; empty from Python.
    """
    from gearwear.report.page import sections

    scale = colour_scale(arrays.deviation_um)
    first = _first_picture(results, arrays, scale)
    every = (
        sections.wear(results, arrays, scale), sections.loop(results, arrays), sections.thickness(results),
        sections.meshing(results, arrays), sections.inspection(arrays), sections.paper(results), sections.registration(results),
        sections.scan(results, command), sections.closing(results), sections.written(files),
    )  # fmt: skip
    return PageView(
        title="Gear wear report",
        details=results.design.report.told,
        logo=address(results.design.report.logo),
        subject=subject(results.part, results.gear, results.measured.scans),
        verdict=verdict(results),
        doubtful=bool(grave_doubts(results)),
        doubts=doubts(results),
        figures=key_figures(results),
        still=first.still,
        still_words=f"The {'section' if arrays.planar else 'worn gear'} coloured by {first.title.split(',')[0]}",
        under=first.under,
        scene=first.scene,
        scripts=() if first.scene is None else viewer(),
        sections=[section for section in every if section is not None],
        footer=f"Made by {made_by()}. Deviations are along the outward normal, + is too much"
        " material. Teeth count from 1, counter-clockwise seen from +z; the left flank is the counter-clockwise side. Standard deviations"
        " are one sigma.",
    )


def viewer() -> tuple[Markup, ...]:
    """The scripts of the 3-D view."""
    folder = Path(__file__).parent
    return tuple(Markup(folder.joinpath(file).read_text(encoding="utf-8")) for file in VIEWER)


@dataclass(frozen=True, slots=True)
class FirstPicture:
    """The picture of the first screen.

    Parameters
    ----------
    still : callable
        Draws it: the picture as an address.
    title, under : str
        What it is coloured by, and its caption.
    scene : dict or None
        What brings it to life; None where it stays a picture.
    """

    still: Callable[[], str]
    title: str
    under: str
    scene: dict[str, Any] | None


def _first_picture(results: Results, arrays: ReportArrays, scale: ColourScale) -> FirstPicture:
    """The gear coloured by what the verdict speaks of."""
    from gearwear.report.figures.scene import eye_direction, scene
    from gearwear.report.figures.surfaces import gear_surfaces, worn_volume
    from gearwear.report.figures.views import coloured_gears

    if arrays.planar:
        words = "The section as it is, coloured by its deviation from the design; grey: fillets and roots, or not seen."
        return FirstPicture(partial(_coloured_section, arrays, scale), "deviation", f"{words} {scale.words}", None)
    views, eye = coloured_gears(arrays, scale, bool(results.wear.regions)), eye_direction(results.wear.regions, arrays.gear)
    first = views[0]
    drawn = scene(views, gear_surfaces(arrays, worn=False), worn_volume(arrays), eye, arrays.gear)
    return FirstPicture(partial(_coloured_gear, first, eye, arrays.gear), first.title, first.words, drawn)


def _coloured_section(arrays: ReportArrays, scale: ColourScale) -> str:
    """The outline of a planar section, and its scale, as an address."""
    from gearwear.report import figures
    from gearwear.report.figures.surfaces import whole_outline

    def draw(figure: Figure, bar: Axes) -> None:
        figures.colour_bar(bar, scale)
        figures.outline(figure.add_axes((0.08, 0.1, 0.76, 0.88)), *whole_outline(arrays), scale)

    return _as_address(draw)


def _coloured_gear(first: ColouredGear, eye: Floats, gear: Gear) -> str:
    """The still picture of a coloured gear, and its scale, as an address."""
    from gearwear.report import figures
    from gearwear.report.figures.scene import still, tooth_labels

    def draw(figure: Figure, bar: Axes) -> None:
        figures.colour_bar(bar, first.scale, first.title, first.high)
        still(figure.add_axes((0.0, 0.0, 0.86, 1.0)), first.pieces, first.scale, eye, tooth_labels(first.pieces, gear))

    return _as_address(draw)


def _as_address(draw: Callable[[Figure, Axes], None]) -> str:
    """What is drawn on the first picture's figure, beside its colour bar."""
    from matplotlib import rc_context
    from matplotlib.figure import Figure

    from gearwear.report.figures import STYLE
    from gearwear.report.page.blocks import png

    with rc_context(STYLE):
        figure = Figure(figsize=(7.2, 4.9))
        draw(figure, figure.add_axes((0.88, 0.2, 0.016, 0.6)))
        return png(figure)
