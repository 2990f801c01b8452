"""Pieces of HTML: everything a user wrote is escaped here, figures become inline SVG."""

from __future__ import annotations

import base64
import io
import re
from collections.abc import Iterable, Sequence
from html import escape
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FULL = 10.2
"""Inches that fill the width of the page: type comes out at one size in all figures."""


def section(ident: str, title: str, *body: str) -> str:
    """A section with its heading; empty pieces are left out."""
    inner = "\n".join(piece for piece in body if piece)
    return f'<section id="{ident}">\n<h2>{escape(title)}</h2>\n{inner}\n</section>'


def paragraph(text: str, kind: str = "") -> str:
    """A paragraph of plain text."""
    attribute = f' class="{kind}"' if kind else ""
    return f"<p{attribute}>{escape(text)}</p>" if text else ""


def heading(text: str) -> str:
    return f"<h3>{escape(text)}</h3>"


def table(head: Sequence[str], rows: Iterable[Sequence[str]], words: int = 1, caption: str = "") -> str:
    """A table of plain text; the first `words` columns are words, the others numbers."""

    def line(cells: Sequence[str], tag: str) -> str:
        kinds = ["" if i < words else ' class="n"' for i in range(len(cells))]
        return "<tr>" + "".join(f"<{tag}{k}>{escape(str(c))}</{tag}>" for k, c in zip(kinds, cells, strict=True)) + "</tr>"

    body = "\n".join(line(row, "td") for row in rows)
    title = f"<caption>{escape(caption)}</caption>" if caption else ""
    return f'<div class="table"><table>{title}<thead>{line(head, "th")}</thead>\n<tbody>{body}</tbody></table></div>'


def facts(pairs: Iterable[tuple[str, str]]) -> str:
    """Names and values, one under the other."""
    return '<dl class="facts">' + "".join(f"<dt>{escape(k)}</dt><dd>{escape(v)}</dd>" for k, v in pairs if v) + "</dl>"


def items(texts: Iterable[str]) -> str:
    """A plain list."""
    return "<ul>" + "".join(f"<li>{escape(text)}</li>" for text in texts) + "</ul>"


def picture(figure: Figure, ident: str, title: str, caption: str, trim: bool = True) -> str:
    """A figure with its caption.

    Parameters
    ----------
    figure : Figure
        Drawn under `figures.STYLE`.
    ident : str
        Unique on the page.
    title, caption : str
        What it is, and what to see in it.
    trim : bool
        Cut to what is drawn; False for a sheet with its own margins.

    Returns
    -------
    str
    """
    return (
        f'<figure role="group" aria-label="{escape(title)}">{svg(figure, ident, trim)}'
        f"<figcaption><b>{escape(title)}.</b> {escape(caption)}</figcaption></figure>"
    )


def svg(figure: Figure, ident: str, trim: bool = True) -> str:
    """Inline SVG with text as text, identifiers of its own, and no date in it."""
    from matplotlib.backends.backend_svg import FigureCanvasSVG

    buffer, dpi = io.StringIO(), figure.dpi
    FigureCanvasSVG(figure)  # measures type as it will write it
    # matplotlib's own "tight" draws everything once more to find this box.
    box = figure.get_tightbbox().padded(0.04) if trim else None
    blank = {"Date": None, "Creator": None, "Format": None, "Type": None}
    figure.savefig(buffer, format="svg", metadata=blank, transparent=True, bbox_inches=box, dpi=dpi)
    text = buffer.getvalue()
    text = text[text.index("<svg") :]
    for mark in (' id="', "url(#", 'href="#'):
        text = text.replace(mark, f"{mark}{ident}-")
    size = re.search(r'width="([\d.]+)pt" height="([\d.]+)pt"', text)
    assert size is not None
    share = min(100.0, 100.0 * float(size[1]) / (72.0 * FULL))
    return text.replace(size[0], f'style="width:{share:.1f}%;height:auto"', 1)


def png(figure: Figure, dpi: int = 150) -> str:
    """A figure as the address of an image in the page itself."""
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=dpi, metadata={"Software": None})
    return "data:image/png;base64," + base64.b64encode(buffer.getvalue()).decode("ascii")
