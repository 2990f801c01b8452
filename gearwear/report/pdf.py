"""The report on pages of A4: the same sections as the page, text that can be selected, charts as lines and not as pixels.

reportlab sets the text and leaves room for the charts; matplotlib writes them as pages of one file, and pypdf lays them there.
Charts that are sheets of their own are the last pages, at their true size: text goes on without a gap, and a magnification holds on paper.
"""

from __future__ import annotations

import base64
import io
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from markupsafe import escape
from pypdf import PageObject, PdfReader, PdfWriter
from pypdf.generic import ArrayObject, DecodedStreamObject, DictionaryObject, NameObject, StreamObject
from reportlab.lib.colors import HexColor
from reportlab.lib.pagesizes import A4, landscape
from reportlab.lib.styles import ParagraphStyle
from reportlab.lib.units import mm
from reportlab.pdfbase import pdfmetrics
from reportlab.pdfbase.ttfonts import TTFont
from reportlab.pdfgen.canvas import Canvas
from reportlab.platypus import (
    BaseDocTemplate,
    CondPageBreak,
    Flowable,
    Frame,
    Image,
    NextPageTemplate,
    PageBreak,
    PageTemplate,
    Paragraph,
    Table,
)  # fmt: skip

from gearwear.report.figures.colours import INK, MUTED, RULE
from gearwear.report.figures.maps import STYLE
from gearwear.report.page import blocks
from gearwear.report.page.view import PageView

if TYPE_CHECKING:
    from matplotlib.figure import Figure

WIDTH, HEIGHT = landscape(A4)
MARGIN, FOOT = 14 * mm, 13 * mm
"""Of a page of text; what is below `FOOT` is the page's number."""
SHEET_LINE, SHEET_LINE_ROOM = 4.2 * mm, 215 * mm
"""Of the same words on a sheet, whose foot is full: how far below the upper edge, and how far to the left they may go, clear of its title."""
SMALLEST_CHART = 0.75
"""Of a chart's size: so far it is made smaller where it then stands on the page that is begun; its type is still read."""
SHORT_ITEM = 45
"""Signs; items no longer than this, such as names of files, are set one after the other."""
INNER = WIDTH - 2 * MARGIN
FONT, BOLD = "DejaVuSans", "DejaVuSans-Bold"
"""The type of the charts, which has every sign that the report uses."""


def _style(name: str, size: float, **more: Any) -> ParagraphStyle:
    return ParagraphStyle(name, **{"fontName": FONT, "fontSize": size, "leading": 1.35 * size, "textColor": HexColor(INK)} | more)


TEXT = _style("text", 8.5, spaceAfter=4)
LEAD = _style("lead", 9.5, spaceAfter=5)
SMALL = _style("small", 7.5, textColor=HexColor(MUTED), spaceAfter=4)
CELL = _style("cell", 7.5)
NUMBER = _style("number", 7.5, alignment=2)
HEAD = _style("head", 7.5, fontName=BOLD)
NUMBER_HEAD = _style("number head", 7.5, fontName=BOLD, alignment=2)
TITLE = _style("title", 15, fontName=BOLD, spaceAfter=2)
SECTION = _style("section", 12, fontName=BOLD, spaceBefore=8, spaceAfter=5, keepWithNext=1)
HEADING = _style("heading", 9, fontName=BOLD, spaceBefore=3, spaceAfter=3, keepWithNext=1)
VERDICT = _style("verdict", 12.5, spaceBefore=4, spaceAfter=6)
NOTE = _style("note", 8.5, spaceBefore=6, spaceAfter=6)
VALUE = _style("value", 11)


@dataclass(slots=True)
class Charts:
    """Charts with the part of each that is drawn, in inches; where they are laid: page (0-based), left and lower edge in points, scale,
    number; the scale of each page that is a sheet; and the sheets that are still to come."""

    drawn: list[tuple[Figure, Any]] = field(default_factory=list)
    places: list[tuple[int, float, float, float, int]] = field(default_factory=list)
    sheets: dict[int, float] = field(default_factory=dict)
    later: list[Figure] = field(default_factory=list)

    def as_pdf(self) -> PdfReader:
        """All of them in one file, a page each, so that each font is in it once."""
        from matplotlib import rc_context
        from matplotlib.backends.backend_pdf import PdfPages

        buffer = io.BytesIO()
        blank = {"CreationDate": None, "Creator": None, "Producer": None}
        with rc_context(STYLE), PdfPages(buffer, metadata=blank) as pages:
            for figure, box in self.drawn:
                pages.savefig(figure, bbox_inches=box, transparent=True)
        return PdfReader(buffer)


class Room(Flowable):  # type: ignore[misc]  # reportlab has no types
    """Room for a chart and its caption, at most as large as the frame, and a little smaller where it then stands on the page begun."""

    def __init__(self, block: blocks.Picture, charts: Charts, widest: float, highest: float) -> None:
        super().__init__()
        figure = block.figure()
        box = blocks.extent(figure, block.trim)
        self.natural = 72.0 * box.width, 72.0 * box.height
        self.largest = min(1.0, widest / self.natural[0], highest / self.natural[1])
        self.caption = Paragraph(f'<font name="{BOLD}">{escape(block.title)}.</font> {escape(block.caption)}', SMALL)
        self.charts, self.number = charts, len(charts.drawn)
        charts.drawn.append((figure, box))

    def wrap(self, width: float, height: float) -> tuple[float, float]:
        self.below = 3.0 + self.caption.wrap(width, height)[1]
        fits = (height - self.below) / self.natural[1]
        self.scale = min(self.largest, fits) if fits >= SMALLEST_CHART * self.largest else self.largest
        self.width, self.height = width, self.scale * self.natural[1] + self.below
        return self.width, self.height

    def draw(self) -> None:
        self.caption.drawOn(self.canv, 0.0, 0.0)
        x, y = self.canv.absolutePosition(0.0, self.below)
        self.charts.places.append((self.canv.getPageNumber() - 1, x, y, self.scale, self.number))


class Sheet(Flowable):  # type: ignore[misc]
    """A page that is a chart with margins of its own, at its true size; smaller only where it is larger than the paper."""

    def __init__(self, figure: Figure, charts: Charts) -> None:
        super().__init__()
        box = blocks.extent(figure, trim=False)
        self.scale = min(1.0, WIDTH / (72.0 * box.width), HEIGHT / (72.0 * box.height))
        self.width, self.height = self.scale * 72.0 * box.width, self.scale * 72.0 * box.height
        self.charts, self.number = charts, len(charts.drawn)
        charts.drawn.append((figure, box))

    def draw(self) -> None:
        x, y = self.canv.absolutePosition(0.0, 0.0)
        page = self.canv.getPageNumber() - 1
        self.charts.sheets[page] = self.scale
        self.charts.places.append((page, x, y, self.scale, self.number))


class Numbered(Canvas):  # type: ignore[misc]
    """A canvas that knows on every page how many there are."""

    def __init__(self, *arguments: Any, charts: Charts, below: str, **more: Any) -> None:
        super().__init__(*arguments, **more)
        self._charts, self._below = charts, below
        self._kept: list[dict[str, Any]] = []

    def showPage(self) -> None:
        self._kept.append(dict(self.__dict__))
        self._startPage()

    def save(self) -> None:
        for number, state in enumerate(self._kept):
            self.__dict__.update(state)
            self.setFillColor(HexColor(MUTED))
            of_all = f"page {number + 1} of {len(self._kept)}"
            scale = self._charts.sheets.get(number)
            if scale is None:
                self.setFont(FONT, 7)
                self.drawString(MARGIN, 5 * mm, self._below)
                self.drawRightString(WIDTH - MARGIN, 5 * mm, of_all)
            else:
                shrunk = "" if scale > 0.999 else f"printed at {100 * scale:.0f} % of the size that its magnifications are of"
                words = " · ".join(filter(None, [self._below, shrunk, of_all]))
                self.setFont(FONT, min(7.0, 7.0 * SHEET_LINE_ROOM / pdfmetrics.stringWidth(words, FONT, 7.0)))
                self.drawRightString(WIDTH - 8 * mm, HEIGHT - SHEET_LINE, words)
            super().showPage()
        super().save()


def write_pdf(path: Path, view: PageView) -> None:
    """Write the report as PDF; the same bytes for the same view.

    Parameters
    ----------
    path : Path
    view : PageView
        What stands on the page.
    """
    _fonts()
    charts, buffer = Charts(), io.BytesIO()
    document = BaseDocTemplate(buffer, pagesize=(WIDTH, HEIGHT), title=view.title, author="", invariant=1, subject=view.subject)
    text = Frame(MARGIN, FOOT, INNER, HEIGHT - FOOT - 12 * mm, 0, 0, 0, 0)
    sheet = Frame(0, 0, WIDTH, HEIGHT, 0, 0, 0, 0)
    document.addPageTemplates([PageTemplate("text", [text]), PageTemplate("sheet", [sheet])])
    story = [*_first(view), *(flowable for section in view.sections for flowable in _section(section, charts))]
    story += [_signature()]
    story += [flowable for figure in charts.later for flowable in (NextPageTemplate("sheet"), PageBreak(), Sheet(figure, charts))]
    below = " · ".join(filter(None, [view.title, view.marking, view.made_by]))
    document.build(story, canvasmaker=lambda *given, **more: Numbered(*given, charts=charts, below=below, **more))
    buffer.seek(0)
    writer = PdfWriter(clone_from=buffer)
    if charts.places:
        drawn = charts.as_pdf()
        for number, x, y, scale, chart in charts.places:
            _lay(
                writer,
                writer.pages[number],
                drawn.pages[chart],
                f"/Chart{chart}",
                f"q {scale:.6f} 0 0 {scale:.6f} {x:.3f} {y:.3f} cm",
            )
    with path.open("wb") as file:
        writer.write(file)


def _lay(writer: PdfWriter, page: PageObject, chart: PageObject, name: str, placed: str) -> None:
    """Lay a chart on a page, under its text, as a form: a drawing within the drawing."""
    form = DecodedStreamObject()
    form.set_data(cast(StreamObject, chart["/Contents"].get_object()).get_data())
    form.update({
        NameObject("/Type"): NameObject("/XObject"), NameObject("/Subtype"): NameObject("/Form"),
        NameObject("/BBox"): chart.mediabox.clone(writer), NameObject("/Resources"): chart["/Resources"].clone(writer),
    })  # fmt: skip
    stamp = DecodedStreamObject()
    stamp.set_data(f"{placed} {name} Do Q\n".encode())
    resources = cast(DictionaryObject, page["/Resources"].get_object())
    forms = cast(DictionaryObject, resources.setdefault(NameObject("/XObject"), DictionaryObject()).get_object())
    forms[NameObject(name)] = writer._add_object(form.flate_encode())
    before = page.raw_get("/Contents")
    streams = before if isinstance(before, ArrayObject) else [before]
    page[NameObject("/Contents")] = ArrayObject([writer._add_object(stamp), *streams])


def _fonts() -> None:
    from matplotlib import get_data_path

    folder = Path(get_data_path()) / "fonts" / "ttf"
    for name in (FONT, BOLD):
        if name not in pdfmetrics.getRegisteredFontNames():
            pdfmetrics.registerFont(TTFont(name, str(folder / f"{name}.ttf")))


def _words(text: str, style: ParagraphStyle = TEXT) -> Paragraph:
    """A paragraph of plain text: what looks like markup in it is text too."""
    return Paragraph(str(escape(text)).replace("\n", "<br/>"), style)


def _picture(address: str, width: float, height: float) -> Image:
    """A picture of the page, as large as fits."""
    return Image(io.BytesIO(base64.b64decode(address.partition(",")[2])), width, height, kind="proportional")


def _first(view: PageView) -> Iterator[Flowable]:
    """The first page: of what it is, the verdict, the first picture, the figures that come first."""
    head: list[Any] = [[_words(view.title, TITLE), _words(view.subject, SMALL)]]
    logo = _picture(view.logo, 60 * mm, 14 * mm) if view.logo else ""
    yield _grid(
        [[head[0], logo]],
        [INNER - 62 * mm, 62 * mm],
        [("ALIGN", (1, 0), (1, 0), "RIGHT"), ("LINEBELOW", (0, 0), (-1, 0), 1, HexColor(INK))],
    )
    short = [(name, text) for name, text in view.details if name != "remarks"]
    if short:
        rows = [short[i : i + 3] for i in range(0, len(short), 3)]
        cells = [
            [part for name, text in row for part in (_words(name, SMALL), _words(text, CELL))] + [""] * (6 - 2 * len(row))
            for row in rows
        ]
        yield _grid(cells, [0.11 * INNER, 0.2233 * INNER] * 3, [("LINEBELOW", (0, -1), (-1, -1), 0.4, HexColor(RULE))])
    for name, text in view.details:
        if name == "remarks":
            yield _words(f"{name}: {text}", CELL)
    if view.verdict:
        yield _words(view.verdict, VERDICT)
    if view.doubts:
        yield _words("Please note: " + " ".join(view.doubts[:3]), NOTE)
    figures = [[_words(key.name, SMALL), _words(key.value, VALUE), _words(key.note, SMALL)] for key in view.figures]
    key = [flowable for cells in figures for flowable in cells]
    still = view.still()
    if still:
        picture = [_picture(still, 0.6 * INNER, 100 * mm), _words(view.under, SMALL)]
        yield _grid([[picture, key]], [0.63 * INNER, 0.37 * INNER])
    else:
        yield from key


def _signature() -> Table:
    """A line to sign on, at the end of the text."""
    row = [part for name in ("date", "name", "signature") for part in (_words(name, SMALL), "")]
    lines = [("LINEBELOW", (at, 0), (at, 0), 0.6, HexColor(INK)) for at in (1, 3, 5)]
    return _grid(
        [row],
        [0.08 * INNER, 0.17 * INNER, 0.08 * INNER, 0.27 * INNER, 0.1 * INNER, 0.3 * INNER],
        [("TOPPADDING", (0, 0), (-1, 0), 40), *lines],
    )


def _section(section: blocks.Section, charts: Charts) -> Iterator[Flowable]:
    yield CondPageBreak(40 * mm)
    yield _words(section.title, SECTION)
    yield from _blocks(section.blocks, charts, INNER)


def _blocks(given: Iterable[blocks.Block], charts: Charts, width: float) -> Iterator[Flowable]:
    for block in given:
        if isinstance(block, blocks.Paragraph):
            yield _words(block.text, LEAD if block.lead else TEXT)
        elif isinstance(block, blocks.Heading):
            yield _words(block.text, HEADING)
        elif isinstance(block, blocks.Items):
            short = all(len(text) <= SHORT_ITEM for text in block.texts)
            yield from (_words(f"• {text}") for text in (["   • ".join(block.texts)] if short else block.texts))
        elif isinstance(block, blocks.Facts):
            pairs = [(name, value) for name, value in block.pairs if value]
            if pairs:
                share = 0.36 if width < INNER else 0.18
                yield _grid(
                    [[_words(name, SMALL), _words(value, CELL)] for name, value in pairs], [share * width, (1.0 - share) * width]
                )
        elif isinstance(block, blocks.Table):
            yield from _table(block, width)
        elif isinstance(block, blocks.Picture) and not block.trim:
            yield _words(f"{block.title}: among the last pages. {block.caption}", SMALL)
            charts.later += block.sheets() if block.sheets else [block.figure()]
        elif isinstance(block, blocks.Picture):
            yield Room(block, charts, INNER, HEIGHT - FOOT - 40 * mm)
        else:
            part = width / len(block.columns)
            yield _grid([[[*_blocks(column, charts, part - 4 * mm)] for column in block.columns]], [part] * len(block.columns))


def _grid(rows: Sequence[Sequence[Any]], widths: Sequence[float], lines: Sequence[Any] = ()) -> Table:
    """Cells without rules; a row may go over several pages."""
    tight = [("VALIGN", (0, 0), (-1, -1), "TOP"), ("LEFTPADDING", (0, 0), (-1, -1), 0), ("RIGHTPADDING", (0, 0), (-1, -1), 6),
             ("TOPPADDING", (0, 0), (-1, -1), 1), ("BOTTOMPADDING", (0, 0), (-1, -1), 2)]  # fmt: skip
    return Table(list(map(list, rows)), colWidths=list(widths), style=[*tight, *lines], hAlign="LEFT", splitInRow=1)


def _table(block: blocks.Table, width: float) -> Iterator[Flowable]:
    """Columns as wide as what stands in them asks for; the head again on every page."""
    if block.caption:
        yield _words(block.caption, SMALL)
    columns = list(zip(block.head, *block.rows, strict=True))
    wanted = [min(max(pdfmetrics.stringWidth(cell, FONT, 7.5) for cell in column), 0.3 * width) + 14 for column in columns]
    longest = [
        max(pdfmetrics.stringWidth(word, BOLD, 7.5) for cell in column for word in cell.split(" ")) + 8 for column in columns
    ]
    shrink = min(1.0, width / sum(wanted))
    widths = [max(shrink * natural, min(least, width / len(columns))) for natural, least in zip(wanted, longest, strict=True)]

    def cells(row: Sequence[str], styles: tuple[ParagraphStyle, ParagraphStyle]) -> list[Paragraph]:
        return [_words(cell, styles[i >= block.words]) for i, cell in enumerate(row)]

    rows = [cells(block.head, (HEAD, NUMBER_HEAD)), *(cells(row, (CELL, NUMBER)) for row in block.rows)]
    lines = [
        ("VALIGN", (0, 0), (-1, -1), "TOP"), ("LEFTPADDING", (0, 0), (-1, -1), 0), ("TOPPADDING", (0, 0), (-1, -1), 1.2),
        ("BOTTOMPADDING", (0, 0), (-1, -1), 1.8), ("LINEBELOW", (0, 0), (-1, 0), 0.9, HexColor(INK)),
        ("LINEBELOW", (0, 1), (-1, -1), 0.3, HexColor(RULE)),
    ]  # fmt: skip
    yield Table(rows, colWidths=widths, repeatRows=1, style=lines, hAlign="LEFT", spaceBefore=3, spaceAfter=6)
