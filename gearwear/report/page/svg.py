"""Figures as inline SVG: what matplotlib draws, in the fewest words, and cut to what was drawn while it is drawn."""

from __future__ import annotations

import base64
import io
import math
from typing import Any, cast
from xml.sax.saxutils import escape

import numpy as np
from markupsafe import Markup
from matplotlib import rc_context
from matplotlib.backend_bases import RendererBase
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties, findfont, get_font, weight_dict
from matplotlib.path import Path
from matplotlib.text import Text
from matplotlib.textpath import text_to_path
from matplotlib.transforms import Affine2D, Bbox, Transform
from PIL import Image

from gearwear.arrays import Floats
from gearwear.report.figures import STYLE

FULL = 10.2
"""Inches that fill the width of the page: type comes out at one size in all figures."""

MARGIN = 0.04
"""Inches left round what was drawn of a figure that is cut to it."""

LARGE = 1000.0
"""Points at which letters are measured: no pixel counts there."""

HATCH = 72
"""Points after which a hatch repeats."""

ANCHORS = {"left": "", "center": ";text-anchor:middle", "right": ";text-anchor:end"}
"""How a text stands at its place."""

CORNERS = {Path.LINETO: 1, Path.CURVE3: 2, Path.CURVE4: 3}
"""Corners of each step of a path, by its code."""

LETTERS = {Path.MOVETO: "M", Path.LINETO: "l", Path.CURVE3: "q", Path.CURVE4: "c", Path.CLOSEPOLY: "z"}


def svg(figure: Figure, ident: str, trim: bool = True) -> Markup:
    """Inline SVG with text as text and identifiers of its own; cut to what is drawn, or whole. The figure has no ground afterwards, and 72 dpi."""
    figure.patch.set_visible(False)
    for axis in figure.axes:
        axis.patch.set_visible(False)
    sharp = figure.dpi / 72.0
    figure.set_dpi(72.0)
    pen = Pen(ident, *figure.bbox.size, sharp)
    with rc_context(STYLE):
        figure.draw(pen)
    box = figure.bbox.frozen()
    if trim:
        box = Bbox.union([*pen.reach, *(axis.get_window_extent() for axis in figure.axes)]).padded(72.0 * MARGIN)
    return pen.cut(box)


class Pen(RendererBase):
    """Writes what a figure of so many points draws as SVG, with `sharp` pixels to a point of its pictures; identifiers begin with `ident`."""

    def __init__(self, ident: str, width: float, height: float, sharp: float) -> None:
        super().__init__()
        self.ident, self.width, self.height, self.sharp = ident, width, height, sharp
        self.down = Affine2D().scale(1.0, -1.0).translate(0.0, height)  # from points that run upwards
        self.reach: list[Bbox] = []
        self._marks: list[str] = []
        self._line: tuple[str, list[str]] = "", []
        self._defined: dict[str, str] = {}
        self._clips: dict[object, str] = {}
        self._letters: dict[FontProperties, Letters] = {}

    def cut(self, box: Bbox) -> Markup:
        """What was drawn in a part of the figure, points from below."""
        self._mark()
        share = min(100.0, 100.0 * box.width / (72.0 * FULL))
        style = f"width:{share:.1f}%;height:auto;--natural:{box.width * 96.0 / 72.0:.0f}px"
        view = f"{box.x0:.2f} {self.height - box.y1:.2f} {box.width:.2f} {box.height:.2f}"
        head = f'<svg xmlns="http://www.w3.org/2000/svg" style="{style}" viewBox="{view}" stroke-linejoin="round">'
        return Markup("\n".join([head, *self._marks, "</svg>"]))  # texts are escaped as they are written

    def draw_path(self, gc: Any, path: Path, transform: Transform, rgbFace: Any = None) -> None:
        line, look = rgbFace is None and gc.get_hatch() is None, self._look(gc, rgbFace)
        if not look:
            return
        if "clip-path" not in look:
            self.reach.append(path.get_extents(transform))
        simple = bool(path.should_simplify and line)
        steps = _steps(path.cleaned(transform + self.down, remove_nans=True, simplify=simple, curves=True))
        if not line or "opacity" in look:
            self._mark(f'<path d="{steps}"{look}/>')
            return
        if look != self._line[0]:
            self._mark()
            self._line = look, []
        self._line[1].append(steps)

    def draw_markers(
        self, gc: Any, marker_path: Path, marker_trans: Transform, path: Path, trans: Transform, rgbFace: Any = None
    ) -> None:
        look = self._look(gc, rgbFace)
        if not look:
            return
        marker, places = (
            marker_path.cleaned(marker_trans + Affine2D().scale(1.0, -1.0), curves=True),
            path.cleaned(trans + self.down, remove_nans=True),
        )
        at: Floats = np.asarray(places.vertices)[np.asarray(places.codes) != Path.STOP]
        name = self._named(f'<path id="%s" d="{_steps(marker)}"/>')
        uses = "".join(f'<use href="#{name}" x="{_short(x)}" y="{_short(y)}"/>' for x, y in at.tolist())
        self._mark(f"<g{look}>{uses}</g>")

    def draw_image(self, gc: Any, x: float, y: float, im: Any, transform: Any = None) -> None:
        high, wide = im.shape[:2]
        scale = Affine2D().scale(1.0 / self.sharp) if transform is None else Affine2D().scale(1.0 / wide, 1.0 / high) + transform
        matrix = (scale + Affine2D().translate(x, y) + self.down).get_matrix()[:2]
        told = " ".join(f"{value:.6g}" for value in matrix.T.ravel())
        look = "" if transform is None else ' style="image-rendering:pixelated"'
        size = f'width="{wide}" height="{high}" transform="matrix({told})" preserveAspectRatio="none"'
        self._mark(self._within(gc, f'<image href="data:image/png;base64,{_png(im)}" {size}{look}/>'))

    def draw_text(
        self, gc: Any, x: float, y: float, s: str, prop: FontProperties, angle: float, ismath: Any = False, mtext: Text | None = None
    ) -> None:  # fmt: skip
        if ismath:
            super().draw_text(gc, x, y, s, prop, angle, ismath, mtext)
            return
        w, h, d = self.get_text_width_height_descent(s, prop, False)
        corners = Affine2D().rotate_deg(angle).translate(x, self.height - y).transform([(0, -d), (w, -d), (w, h - d), (0, h - d)])
        self.reach.append(Bbox([corners.min(axis=0), corners.max(axis=0)]))
        weight: Any = prop.get_weight()
        weight, (*ink, alpha) = weight_dict.get(weight, weight), gc.get_rgb()
        look = f"font-size:{_short(prop.get_size_in_points())}px"
        look += f";font-style:{prop.get_style()}" if prop.get_style() != "normal" else ""
        look += f";font-weight:{weight}" if weight != 400 else ""
        look += f";fill:{to_hex(ink)}" if any(ink) else ""
        look += f";opacity:{alpha:g}" if alpha != 1.0 else ""
        if mtext is not None and (angle == 0.0 or mtext.get_rotation_mode() == "anchor"):
            # At its own place along the line: the page's type is not as wide as what was measured.
            own_x, own_y = self.down.transform(mtext.get_transform().transform(mtext.get_unitless_position()))
            sine, cosine = math.sin(math.radians(angle)), math.cos(math.radians(angle))
            off = sine * (x - own_x) + cosine * (y - own_y)
            x, y = own_x + sine * off, own_y + cosine * off
            look += ANCHORS[mtext.get_horizontalalignment()]
        turn = f' transform="rotate({-angle:g} {_short(x)} {_short(y)})"' if angle else ""
        self._mark(self._within(gc, f'<text x="{_short(x)}" y="{_short(y)}"{turn} style="{look}">{escape(s)}</text>'))

    def get_text_width_height_descent(self, s: str, prop: FontProperties, ismath: Any) -> tuple[float, float, float]:
        if ismath:
            return text_to_path.get_text_width_height_descent(s, prop, ismath)
        return self._letters_of(prop).size(s, prop.get_size_in_points())

    def _get_font_height_metrics(self, prop: FontProperties) -> tuple[float | None, ...]:
        """Ascent, descent and gap of lines: where a renderer knows them, matplotlib does not read the font's tables for every text."""
        points, lines = prop.get_size_in_points(), self._letters_of(prop).lines
        return (points * lines[0], -points * lines[1], points * lines[2]) if lines else (None, None, None)

    def _letters_of(self, prop: FontProperties) -> Letters:
        if prop not in self._letters:
            self._letters[prop.copy()] = Letters(findfont(prop))
        return self._letters[prop]

    def get_canvas_width_height(self) -> tuple[float, float]:
        return self.width, self.height

    def option_scale_image(self) -> bool:
        return True

    def get_image_magnification(self) -> float:
        return self.sharp

    def _mark(self, element: str = "") -> None:
        """One element, behind the lines of one look that were collected."""
        look, lines = self._line
        self._marks += [f'<path d="{"".join(lines)}"{look}/>'] * bool(lines) + [element] * bool(element)
        self._line = "", []

    def _named(self, element: str) -> str:
        """Name of a definition, put in for %s, which is written once."""
        if element not in self._defined:
            self._defined[element] = f"{self.ident}-{len(self._defined)}"
            self._mark(f"<defs>{element % self._defined[element]}</defs>")
        return self._defined[element]

    def _clip(self, gc: Any) -> str:
        """Attribute of what something is cut off by."""
        box, (path, transform) = gc.get_clip_rectangle(), gc.get_clip_path()
        if box is None and path is None:
            return ""
        key = box.bounds if path is None else path
        if key not in self._clips:
            if path is None:
                path, transform = Path.unit_rectangle(), Affine2D().scale(*box.size).translate(*box.p0)
            steps = _steps(path.cleaned(transform + self.down, curves=True))
            self._clips[key] = self._named(f'<clipPath id="%s"><path d="{steps}"/></clipPath>')
        return f' clip-path="url(#{self._clips[key]})"'

    def _within(self, gc: Any, element: str) -> str:
        """An element that has a place of its own, cut off."""
        clip = self._clip(gc)
        return f"<g{clip}>{element}</g>" if clip else element

    def _look(self, gc: Any, face: Any) -> str:
        """Attributes of a path; empty where nothing of it is seen."""
        forced, (*ink, alpha), width = gc.get_forced_alpha(), gc.get_rgb(), gc.get_linewidth()
        stroked, filled = width > 0.0 and alpha > 0.0, face is not None and face[-1:] != (0.0,)
        if gc.get_hatch() is not None:
            look = f"fill:url(#{self._hatch(gc, face)})"
        elif not stroked and not filled:
            return ""
        else:
            look = f"fill:{to_hex(face[:3]) if filled else 'none'}"
            look += f";fill-opacity:{face[3]:g}" if filled and len(face) == 4 and face[3] != 1.0 and not forced else ""
        look += f";opacity:{gc.get_alpha():g}" if forced and gc.get_alpha() != 1.0 else ""
        if stroked:
            look += f";stroke:{to_hex(ink)}"
            look += f";stroke-opacity:{alpha:g}" if alpha != 1.0 and not forced else ""
            look += f";stroke-width:{_short(width)}" if width != 1.0 else ""
            look += f";stroke-linejoin:{gc.get_joinstyle()}" if gc.get_joinstyle() != "round" else ""
            look += f";stroke-linecap:{gc.get_capstyle().replace('projecting', 'square')}" if gc.get_capstyle() != "butt" else ""
            offset, dashes = gc.get_dashes()
            if dashes is not None:
                look += f";stroke-dasharray:{','.join(map(_short, dashes))};stroke-dashoffset:{_short(offset)}"
        return f'{self._clip(gc)} style="{look}"'

    def _hatch(self, gc: Any, face: Any) -> str:
        steps = _steps(gc.get_hatch_path().cleaned(Affine2D().scale(HATCH, -HATCH).translate(0.0, HATCH), curves=True))
        ink, ground = to_hex(gc.get_hatch_color()), "none" if face is None else to_hex(face[:3])
        return self._named(
            f'<pattern id="%s" patternUnits="userSpaceOnUse" width="{HATCH}" height="{HATCH}"><path d="M0 0h{HATCH + 1}v{HATCH + 1}H0z" fill="{ground}"/>'
            f'<path d="{steps}" style="fill:{ink};stroke:{ink};stroke-width:{gc.get_hatch_linewidth():g};stroke-linejoin:miter"/></pattern>'
        )


class Letters(dict[str, tuple[float, float, float]]):
    """How far the letters of a font reach to the right, down and up, of type as large as 1; each is measured when it is first asked for.

    A text is as wide as its letters, which is told in a hundredth of the time that shaping it would take; the page's type has other widths anyway.
    """

    def __init__(self, file: str) -> None:
        super().__init__()
        self.font = cast(Any, get_font(file))
        told, names = self.font.get_sfnt_table("OS/2"), ("sTypoAscender", "sTypoDescender", "sTypoLineGap")
        self.lines = () if told is None else tuple(told[name] / self.font.get_sfnt_table("head")["unitsPerEm"] for name in names)

    def __missing__(self, letter: str) -> tuple[float, float, float]:
        self.font.set_size(LARGE, 72.0)
        glyph = self.font.load_char(ord(letter))
        _, low, _, high = glyph.bbox
        self[letter] = glyph.linearHoriAdvance / (65536.0 * LARGE), low / (64.0 * LARGE), high / (64.0 * LARGE)
        return self[letter]

    def size(self, text: str, points: float) -> tuple[float, float, float]:
        """Width, height and depth under the line of a text, points."""
        wide, low, high = zip(*(self[letter] for letter in text), strict=True)
        return points * sum(wide), points * (max(high) - min(low)), -points * min(low)


def _short(value: float) -> str:
    """A hundredth of a point is less than anybody sees."""
    return f"{round(value, 2):.8g}"


def _steps(path: Path) -> str:
    """A path as `Path.cleaned` gives it, in steps of whole hundredths of a point: half as long as by its places."""
    codes, corner = np.asarray(path.codes), np.asarray(path.vertices, dtype=np.float64)
    within = codes != Path.STOP
    codes, places = codes[within], np.rint(100.0 * corner[within])
    if not len(codes):
        return ""
    starts = np.flatnonzero(np.diff(codes, prepend=0) | (codes == Path.MOVETO))
    lengths = np.diff(starts, append=len(codes))
    # Each corner counts from where the step before it ended: of a curve's, not from the one before.
    corners = np.repeat([CORNERS.get(code, 1) for code in codes[starts].tolist()], lengths)
    number = np.arange(len(codes))
    before = number - 1 - (number - np.repeat(starts, lengths)) % corners
    moves = 0.01 * (places - np.where((codes == Path.MOVETO)[:, None], 0.0, places[before]))
    words = [f"{x:.8g} {y:.8g}" for x, y in moves.tolist()]
    return "".join(
        LETTERS[code] + ("" if code == Path.CLOSEPOLY else " ".join(words[start : start + length]))
        for code, start, length in zip(codes[starts].tolist(), starts.tolist(), lengths.tolist(), strict=True)
    )


def _png(pixels: Any) -> str:
    """Pixels (rows, columns, 4) as PNG; of few colours as numbers of them: a map is half as large, its pixels are the same."""
    rows, columns = pixels.shape[:2]
    # A colour as one number: rows would take ten times as long.
    whole, number = np.unique(np.ascontiguousarray(pixels).view("<u4"), return_inverse=True)
    buffer = io.BytesIO()
    if len(whole) > 256:
        Image.fromarray(pixels).save(buffer, format="png")
    else:
        colours = whole[:, None].view(np.uint8)
        picture = Image.fromarray(number.reshape(rows, columns).astype(np.uint8))
        picture.putpalette(colours[:, :3].tobytes())
        picture.save(buffer, format="png", transparency=colours[:, 3].tobytes())
    return base64.b64encode(buffer.getvalue()).decode("ascii")
