"""What a section of the page is made of: plain text and drawings; how they look as HTML is the templates' affair."""

from __future__ import annotations

import base64
import io
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from itertools import chain
from typing import TYPE_CHECKING, Any, ClassVar

from markupsafe import Markup

if TYPE_CHECKING:
    from matplotlib.figure import Figure


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
        from gearwear.report.page.svg import svg

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
