"""What the page's pen writes, against what matplotlib itself writes of the same figure."""

from __future__ import annotations

import io
import re
from xml.etree import ElementTree

import numpy as np
import pytest
from matplotlib import rc_context
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from gearwear.report.figures import STYLE
from gearwear.report.page.svg import MARGIN, Letters, Pen, svg

SPACE = "{http://www.w3.org/2000/svg}"


def figure_of(draw):
    with rc_context(STYLE):
        figure = Figure(figsize=(4.0, 3.0), dpi=72.0)
        axis = figure.add_axes((0.2, 0.2, 0.7, 0.6))
        draw(axis)
    return figure


def own_of(draw, trim=False):
    return ElementTree.fromstring(str(svg(figure_of(draw), "x", trim)))


def theirs_of(draw):
    buffer = io.StringIO()
    with rc_context(STYLE):
        figure_of(draw).savefig(buffer, format="svg", transparent=True)
    return ElementTree.fromstring(buffer.getvalue())


def elements(root, tag, look=""):
    return [element for element in root.iter(SPACE + tag) if look in element.get("style", "")]


def corners(steps):
    """Corners of a path in steps, those that steer its curves too."""
    at, found = np.zeros(2), []
    for letter, numbers in re.findall(r"([Mlqcz])([^Mlqcz]*)", steps):
        moves = np.array(numbers.split(), dtype=float).reshape(-1, {"q": 2, "c": 3}.get(letter, 1), 2)
        for move in moves:
            found += list(move + (0.0 if letter == "M" else at))
            at = found[-1]
    return np.array(found)


def words(axis):
    axis.plot([0.0, 30.0], [-1.0, 2.0])
    axis.set(xlabel="depth & more, µm", ylabel="share <1>", title="of all flanks")
    axis.text(15.0, 0.5, "two\nlines", ha="center", va="center", color="#123456", fontweight="bold")
    axis.annotate("away", (20.0, 1.0), (4.0, 3.0), textcoords="offset points", ha="right", fontstyle="italic")


def test_words_stand_where_matplotlib_puts_them():
    """Along the line to the hundredth, and across within what the height of letters is rounded to; as they look there."""
    one, other = ({text.text: text for text in elements(root, "text")} for root in (own_of(words), theirs_of(words)))
    assert list(one) == list(other) and {"two", "lines", "share <1>"} < set(one)
    for name, own in one.items():
        theirs, style = other[name], own.get("style")
        for part in ("text-anchor", "font-weight", "font-style", "fill", "font-size"):
            told = [re.search(rf"(?:^|;) ?{part}: ?([^;]+)", text) for text in (style, theirs.get("style"))]
            mine, usual = ("" if found is None else found[1].replace("start", "") for found in told)
            assert mine == usual, (name, part)
        turned = own.get("transform", "").startswith("rotate(-90 ")
        assert turned == ("rotate(-90" in theirs.get("transform", "")), name
        place = [theirs.get("x"), theirs.get("y")]
        if None in place:  # lines of several: each where the layout has it
            place = re.search(r"translate\(([-\d.]+)[ ,]+([-\d.]+)\)", theirs.get("transform")).groups()
        off = np.abs(np.array([own.get("x"), own.get("y")], dtype=float) - np.array(place, dtype=float))
        assert (off < ([0.15, 0.0051] if turned else [0.0051, 0.15])).all(), (name, off)


def test_it_is_cut_to_what_matplotlib_calls_tight():
    def draw(axis):
        words(axis)
        axis.plot([0.0, 30.0], [0.0, 1.0], label="beyond the figure")
        axis.legend(loc="upper center", bbox_to_anchor=(0.5, -0.4))

    figure = figure_of(draw)
    with rc_context(STYLE):
        FigureCanvasSVG(figure)
        box = 72.0 * figure.get_tightbbox().padded(MARGIN).get_points()
    x, y, width, height = map(float, own_of(draw, trim=True).get("viewBox").split())
    assert y + height > 216.0, "the legend lies under the figure"
    np.testing.assert_allclose([x, x + width, 216.0 - y], [*box[:, 0], box[1, 1]], atol=0.7)
    # Below by less than matplotlib's, which counts the legend's blank edge of 0.4 sizes of its type.
    assert box[0, 1] <= 216.0 - y - height <= box[0, 1] + 0.5 * 8.0


def test_curves_in_steps_are_the_curves():
    def draw(axis):
        axis.add_patch(Circle((0.5, 0.5), 0.3, facecolor="#123456", alpha=0.5))

    ((own,), (theirs,)) = (elements(root, "path", "#123456") for root in (own_of(draw), theirs_of(draw)))
    exact = np.array(re.findall(r"-?[\d.]+", theirs.get("d")), dtype=float).reshape(-1, 2)
    np.testing.assert_allclose(corners(own.get("d")), exact, atol=0.00501)
    assert "opacity:0.5" in own.get("style")


def test_lines_of_one_look_are_one_element_and_markers_are_defined_once():
    def draw(axis):
        for y in range(5):
            axis.plot([0.0, 1.0], [y, y], color="#123456", ls="--")
        axis.plot(np.linspace(0.0, 1.0, 7), np.arange(7.0), "o", color="#654321")
        axis.plot([0.0, 1.0], [np.nan, 1.0], color="#aa0000")

    root = own_of(draw)
    (lines,) = elements(root, "path", "#123456")
    assert lines.get("d").count("M") == 5 and "stroke-dasharray" in lines.get("style")
    (group,) = elements(root, "g", "#654321")
    uses = [(float(use.get("x")), float(use.get("y"))) for use in group]
    ours = {(round(float(use.get("x")), 2), round(float(use.get("y")), 2)) for use in elements(theirs_of(draw), "use", "#654321")}
    assert set(uses) == ours and len(uses) == 7
    (mark,) = (element for element in root.iter() if element.get("id") == group[0].get("href")[1:])
    assert np.ptp(corners(mark.get("d"))[:, 0]) == pytest.approx(6.0, abs=0.02)  # lines.markersize
    assert not elements(root, "path", "#aa0000") or "M" not in elements(root, "path", "#aa0000")[0].get("d")[1:]


def test_what_is_beyond_its_axes_is_cut_off_and_hatches_are_defined():
    def draw(axis):
        axis.plot([-5.0, 5.0], [0.5, 0.5], color="#123456")
        axis.add_patch(Circle((0.5, 0.5), 0.3, facecolor="#aabbcc", hatch="////"))
        axis.set(xlim=(0.0, 1.0), ylim=(0.0, 1.0))

    root = own_of(draw)
    named = {element.get("id"): element for element in root.iter() if element.get("id")}
    (line,) = elements(root, "path", "#123456")
    outline = named[line.get("clip-path")[5:-1]].find(f"{SPACE}path")
    np.testing.assert_allclose(np.ptp(corners(outline.get("d")), axis=0), [0.7 * 288.0, 0.6 * 216.0], atol=0.02)
    (circle,) = elements(root, "path", "fill:url(#")
    pattern = named[re.search(r"url\(#([^)]+)\)", circle.get("style"))[1]]
    assert next(part.get("fill") for part in pattern) == "#aabbcc"


def test_letters_are_as_wide_as_matplotlib_shapes_them():
    """But for kerning, of which words without pairs that are kerned have none."""
    from matplotlib.font_manager import FontProperties, findfont
    from matplotlib.textpath import text_to_path

    prop = FontProperties(size=8.5)
    for text in ("mm", "12", "tooth", "−0.5", "lp"):
        np.testing.assert_allclose(
            Letters(findfont(prop)).size(text, 8.5), text_to_path.get_text_width_height_descent(text, prop, False), atol=0.03
        )


def test_lines_are_as_high_as_matplotlib_reads_in_the_font(monkeypatch):
    own = str(svg(figure_of(words), "x"))
    with monkeypatch.context() as without:
        without.delattr(Pen, "_get_font_height_metrics")
        assert str(svg(figure_of(words), "x")) == own
    # A font without the table: matplotlib measures.
    monkeypatch.setattr(Pen, "_get_font_height_metrics", lambda self, prop: (None, None, None))
    assert str(svg(figure_of(words), "x")) == own
