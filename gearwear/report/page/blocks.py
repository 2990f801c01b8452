"""What a section of the page is made of: plain text and drawings; how they look as HTML is the templates' affair."""

from __future__ import annotations

import base64
import io
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache, partial
from itertools import chain
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from markupsafe import Markup

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FULL = 10.2
"""Inches that fill the width of the page: type comes out at one size in all figures."""

_SPARED = (
    (re.compile(r"font-family: [^;]*; "), ""),  # the page has its own
    (re.compile(r' transform="rotate\(-0 [^)]*\)"'), ""),
    (re.compile(r'<g id="[^"]*text_\d+">\s*(<text[^>]*>[^<]*</text>)\s*</g>'), r"\1"),
    (re.compile(r'( [xy]="-?\d+\.\d\d)\d+'), r"\1"),
)
"""What matplotlib writes that nobody sees: fonts of each word, turns by nothing, groups of one, and more than hundredths of a point."""

_LINES = re.compile(r' d="((?:[ML] -?[\d.]+ -?[\d.]+ \n|z\n)+)"')
"""A path of straight lines, as matplotlib writes it."""

_IMAGE = re.compile(r"(?<=data:image/png;base64,)[A-Za-z0-9+/=\s]+")
"""An image, as matplotlib writes it."""


@dataclass(frozen=True, slots=True)
class Paragraph:
    """Text; `lead` is set larger."""

    block: ClassVar[str] = "paragraph"
    text: str
    lead: bool = False


@dataclass(frozen=True, slots=True)
class Heading:
    """A heading within a section."""

    block: ClassVar[str] = "heading"
    text: str


@dataclass(frozen=True, slots=True)
class Table:
    """A table; the first `words` columns are words, the others numbers."""

    block: ClassVar[str] = "table"
    head: Sequence[str]
    rows: Sequence[Sequence[str]]
    words: int = 1
    caption: str = ""


@dataclass(frozen=True, slots=True)
class Facts:
    """Names and values, one under the other; a value that is empty is left out."""

    block: ClassVar[str] = "facts"
    pairs: Sequence[tuple[str, str]]


@dataclass(frozen=True, slots=True)
class Items:
    """A plain list."""

    block: ClassVar[str] = "items"
    texts: Sequence[str]


@dataclass(frozen=True, slots=True)
class Picture:
    """A drawing with its title and a caption that says what to see.

    Parameters
    ----------
    draw : callable
        Draws it; called once for each file it goes to, where there is a processor for it.
    ident : str
        Unique on the page.
    title, caption : str
        What it is, and what to see in it.
    trim : bool
        Cut to what is drawn; False for a sheet with its own margins.
    sheets : callable or None
        Draws the same on sheets of paper, where it is larger than one; None: it is one sheet.
    """

    block: ClassVar[str] = "picture"
    draw: Callable[[], Figure]
    ident: str
    title: str
    caption: str
    trim: bool = True
    sheets: Callable[[], Iterable[Figure]] | None = None

    def figure(self) -> Figure:
        """The drawing, in the style of the report."""
        from matplotlib import rc_context

        from gearwear.report.figures import STYLE

        with rc_context(STYLE):
            return self.draw()

    def svg(self) -> Markup:
        """The same for the page."""
        return svg(self.figure(), self.ident, self.trim)


@dataclass(frozen=True, slots=True)
class Columns:
    """Blocks side by side."""

    block: ClassVar[str] = "columns"
    columns: Sequence[Sequence[Block]]


Block = Paragraph | Heading | Table | Facts | Items | Picture | Columns


@dataclass(frozen=True, slots=True)
class Section:
    """A part of the page.

    Parameters
    ----------
    ident : str
        Its address on the page.
    link : str
        In the list of contents.
    title : str
    blocks : sequence of Block
    """

    ident: str
    link: str
    title: str
    blocks: Sequence[Block]


def blocks(*given: Block | Iterable[Block] | None) -> list[Block]:
    """Blocks and lists of blocks one after the other, without what is not there and paragraphs without text."""
    flat: list[Block] = []
    for block in given:
        if isinstance(block, Paragraph | Heading | Table | Facts | Items | Picture | Columns):
            flat.append(block)
        elif block is not None:
            flat += block
    return [block for block in flat if not (isinstance(block, Paragraph) and not block.text)]


def pictures_of(given: Iterable[Block]) -> list[Picture]:
    """The pictures among blocks, those in columns too."""
    pictures: list[Picture] = []
    for block in given:
        if isinstance(block, Picture):
            pictures.append(block)
        elif isinstance(block, Columns):
            pictures += pictures_of(chain(*block.columns))
    return pictures


def svg(figure: Figure, ident: str, trim: bool = True) -> Markup:
    """Inline SVG with text as text, identifiers of its own, and no date in it."""
    from matplotlib import rc_context
    from matplotlib.backends.backend_svg import FigureCanvasSVG

    from gearwear.report.figures import STYLE

    buffer, dpi = io.StringIO(), figure.dpi
    blank = {"Date": None, "Creator": None, "Format": None, "Type": None}
    with rc_context(STYLE), _measured_once():
        FigureCanvasSVG(figure)  # measures type as it will write it
        # matplotlib's own "tight" draws everything once more to find this box.
        box = figure.get_tightbbox().padded(0.04) if trim else None
        figure.savefig(buffer, format="svg", metadata=blank, transparent=True, bbox_inches=box, dpi=dpi)
    text = buffer.getvalue()
    text = text[text.index("<svg") :]
    for mark in (' id="', "url(#", 'href="#'):
        text = text.replace(mark, f"{mark}{ident}-")
    for written, spared in _SPARED:
        text = written.sub(spared, text)
    text = _IMAGE.sub(lambda image: _by_palette(image[0]), _LINES.sub(_step_by_step, text))
    size = re.search(r'width="([\d.]+)pt" height="([\d.]+)pt"', text)
    assert size is not None
    share = min(100.0, 100.0 * float(size[1]) / (72.0 * FULL))
    return Markup(
        text.replace(size[0], f'style="width:{share:.1f}%;height:auto;--natural:{float(size[1]) * 96.0 / 72.0:.0f}px"', 1)
    )  # matplotlib escapes what it writes


@contextmanager
def _measured_once() -> Iterator[None]:
    """In the body a text is measured for the file once, and not for the box round all and again for the drawing."""
    from matplotlib.textpath import TextToPath

    measure = TextToPath.get_text_width_height_descent
    known = cache(partial(measure, TextToPath()))
    TextToPath.get_text_width_height_descent = lambda self, s, prop, ismath: known(s, prop.copy(), ismath)  # type: ignore[method-assign]
    try:
        yield
    finally:
        TextToPath.get_text_width_height_descent = measure  # type: ignore[method-assign]


def _by_palette(image: str) -> str:
    """An image of few colours as numbers of them: a map is half as large, its pixels are the same."""
    from PIL import Image

    pixels = np.asarray(Image.open(io.BytesIO(base64.b64decode(image))).convert("RGBA"))
    whole, number = np.unique(
        pixels.view("<u4"), return_inverse=True
    )  # a colour as one number: rows would take ten times as long
    if len(whole) > 256:
        return image
    colours = whole[:, None].view(np.uint8)
    picture = Image.fromarray(number.reshape(pixels.shape[:2]).astype(np.uint8))
    picture.putpalette(colours[:, :3].tobytes())
    buffer = io.BytesIO()
    picture.save(buffer, format="png", transparency=colours[:, 3].tobytes())
    return base64.b64encode(buffer.getvalue()).decode("ascii")


def _step_by_step(path: re.Match[str]) -> str:
    """A path of straight lines in steps of whole hundredths of a point: half of the text."""
    written = []
    for part in path[1].split("M")[1:]:
        closed = "z" in part
        corners = np.array(part.replace("L", " ").replace("z", " ").split(), dtype=np.float64).reshape(-1, 2)
        steps = np.diff(np.rint(100.0 * corners), axis=0, prepend=0.0)
        first, *others = (" ".join(f"{value:.8g}" for value in step) for step in (0.01 * steps).tolist())
        written.append(f"M{first}{'l' if others else ''}{' '.join(others)}{'z' if closed else ''}")
    return f' d="{"".join(written)}"'


def extent(figure: Figure, trim: bool = True) -> Any:
    """The part of a figure that is drawn as PDF, inches: a box with `width` and `height`."""
    from matplotlib import rc_context
    from matplotlib.backends.backend_pdf import FigureCanvasPdf
    from matplotlib.transforms import Bbox

    from gearwear.report.figures import STYLE

    if not trim:
        return Bbox.from_bounds(0.0, 0.0, *figure.get_size_inches())
    with rc_context(STYLE):
        FigureCanvasPdf(figure)
        return figure.get_tightbbox().padded(0.04)


def png(figure: Figure, dpi: int = 150) -> str:
    """A figure as the address of an image in the page itself."""
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=dpi, metadata={"Software": None})
    return "data:image/png;base64," + base64.b64encode(buffer.getvalue()).decode("ascii")
