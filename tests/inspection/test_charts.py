"""The charts say what the numbers say: magnification on paper, marks, what was not seen."""

import io
import math
import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from gearwear.design.gear import Gear
from gearwear.design.side import Side
from gearwear.design.spec import GearSpec
from gearwear.inspection import KBand, KBands, Settings, inspect
from gearwear.inspection.k_band import BandVerdict
from gearwear.inspection.ranges import profile_range
from gearwear.report.charts import areal_chart, helix_chart, pitch_chart, profile_chart, topography_chart
from gearwear.report.charts.panel import GROUPS
from gearwear.report.charts.sheet import headline, micrometres, nice, plain
from gearwear.report.figures.colours import ALARM, INK, ORANGE, PAPER, TEAL
from gearwear.report.files.inspection import lines as summary
from tests.inspection.synthetic import displaced, flanks


@pytest.fixture(scope="module")
def points_of(pinion):
    """Slopes of 12 µm, one flank missing, one worn by 0.4 mm."""
    points = flanks(pinion, 60, 20)
    deviation = 0.012 * (points.roll - 14.5) / 23.0 + np.random.default_rng(1).normal(0.0, 0.002, len(points))
    deviation -= np.where((points.tooth == 2) & (points.side == 1), 0.4 * np.exp(-(((points.roll - 15.0) / 5.0) ** 2)), 0.0)
    keep = ~((points.tooth == 6) & (points.side == -1))
    return displaced(points.take(keep), deviation[keep], pinion)


@pytest.fixture(scope="module")
def found(points_of, pinion):
    return inspect(points_of, pinion, Settings(required_class=8))


def words(figure):
    return [t.get_text() for axis in figure.axes for t in axis.texts] + [t.get_text() for t in figure.texts]


def test_the_head_of_a_helical_gears_chart_has_its_helix():
    """It read z = 23 m = 2.5 mm α = 20°, which no one can tell from a spur gear."""
    gear = Gear.from_spec(GearSpec("gear", 23, 2.5, 30.0, helix_angle=math.radians(-25.0), profile_shift=0.2))
    page = Figure().add_axes((0.0, 0.0, 1.0, 1.0))
    headline(page, "Helix", SimpleNamespace(gear=gear), 10.0)
    assert "z = 23   mn = 2.5 mm   α = 20°   β = 25° left   x = 0.2   d = 63.444 mm" in page.texts[1].get_text()  # z m_n / cos β


def test_warnings_on_the_terminal_are_whole_and_the_rest_is_counted(found):
    """They ended amid a sentence: "The scan is too thin for the standard's …"."""
    coat = "taken out as the scanner's or the mounting's: a coat 12.00 ± 0.18 µm thick on every surface; --no-loop leaves it in"
    thin = "The scan is too thin for the standard's filter: in places the cut-off of the profile is 1.18 mm in place of 0.37 mm."
    short = "of flank 3 left nothing was seen"

    def warned(*doubts):
        return " ".join(text for text, style in summary(found, "a gear", doubts) if style == "yellow" and text[0] not in "fF")

    assert warned(coat, thin, short) == f"! {coat[0].upper()}{coat[1:]}. And 2 more, in inspection.json."
    assert warned(short, short) == f"! O{short[1:]}. O{short[1:]}."
    assert warned() == ""
    # One that alone has no room goes to the end of a clause, as on the terminal of a comparison.
    assert warned(f"{short}; {'the same of its neighbours ' * 8}", thin) == f"! O{short[1:]} (more in the report)."


def lines(figure, colour):
    return [line for line in figure.axes[0].lines if line.get_color() == colour]


def trace_of(figure, found, evaluation, tooth, side, colour):
    """The drawn trace, mm of paper, in its column (12 teeth and two more columns a group)."""
    left, right = GROUPS[side]
    width = (right - left) / 14
    column = left + tooth * width, left + (tooth + 1) * width
    long = [line.get_xydata() for line in lines(figure, colour) if len(line.get_xdata()) > len(evaluation.station)]
    traces = np.concatenate(long).reshape(-1, len(evaluation.station) + 1, 2)  # each ends with a gap
    (mine,) = [trace[:-1] for trace in traces if column[0] <= np.nanmedian(trace[:, 0]) <= column[1]]
    return mine[:, 0] - np.mean(column), mine[:, 1]


@pytest.mark.parametrize(("draw", "name"), [(profile_chart, "profile"), (helix_chart, "helix")])
def test_magnification_is_true_on_paper(found, draw, name):
    figure = Figure()
    assert draw(figure, found) is figure
    width, height = figure.get_size_inches() * 25.4
    page = figure.axes[0]
    assert (page.get_xlim(), page.get_ylim()) == ((0.0, pytest.approx(width)), (0.0, pytest.approx(height)))
    evaluation = getattr(found, name)
    (stated,) = [re.search(r"magnification (\d+):1 across, ([\d.]+):1 along", t) for t in words(figure) if "magnification " in t]
    across, along = float(stated[1]), float(stated[2])
    x, y = trace_of(figure, found, evaluation, 4, Side.LEFT, INK)
    shown = np.isfinite(x)
    expected = across * (evaluation.filtered[4, 0] - evaluation.line[4, 0, 0])
    np.testing.assert_allclose(x[shown], expected[shown], atol=1e-9)
    np.testing.assert_allclose(np.diff(y), along * np.diff(evaluation.station), atol=1e-9)


def test_a_trace_too_large_is_drawn_at_its_own_magnification(found):
    figure = profile_chart(Figure(), found)
    x, _ = trace_of(figure, found, found.profile, 2, Side.LEFT, ORANGE)
    own = [int(m[1]) for t in figure.axes[0].texts if t.get_color() == ORANGE and (m := re.fullmatch(r"(\d+):1", t.get_text()))]
    assert len(own) == 1
    expected = own[0] * (found.profile.filtered[2, 0] - found.profile.line[2, 0, 0])
    np.testing.assert_allclose(x, expected, atol=1e-9)


def test_values_marks_and_what_was_not_seen(found):
    said = words(profile_chart(Figure(), found))
    assert said.count("not seen") == 1
    assert any("tooth 7 right" in text for text in said)
    assert micrometres(found.profile.slope.value[4, 0]) in said
    assert not [text for text in said if "nan" in text]
    figure = profile_chart(Figure(), found)
    bold = {t.get_text() for t in figure.axes[0].texts if t.get_fontweight() == "bold" and t.get_color() == ALARM}
    assert micrometres(found.profile.form.value[2, 0]) in bold
    assert micrometres(found.profile.form.value[4, 0]) not in bold


@pytest.mark.parametrize(("width", "verdict"), [(0.008, BandVerdict.OUTSIDE), (0.060, BandVerdict.INSIDE)])
def test_k_band_is_drawn_and_what_leaves_it_is_marked(points_of, pinion, width, verdict):
    band = KBand.straight(profile_range(pinion), width)
    found = inspect(points_of, pinion, Settings(k_bands=KBands(profile=(band, band), source="a drawing")))
    assert found.profile.k.verdict(4, 0) is verdict  # 12 µm of slope do not fit into 8, and do into 60
    figure = profile_chart(Figure(), found, teeth=[4, 5])
    thick = [line.get_xdata().reshape(4, -1) for line in lines(figure, ALARM) if line.get_linewidth() > 2.0]
    marked = [np.isfinite(trace).any() for line in thick for trace in line]
    assert marked == ([True] * 4 if verdict is BandVerdict.OUTSIDE else [])
    (edge,) = [line for line in lines(figure, TEAL) if line.get_linewidth() == 0.6]
    assert len(edge.get_xdata()) == 4 * (2 * len(band.station) + 2)  # both limits of four flanks, closed, and a gap
    said = words(figure)
    assert any("K band (a drawing)" in text for text in said)
    assert micrometres(float(found.profile.k.excess.value[4, 0])) in said
    assert ("11/12" in said) == (verdict is BandVerdict.INSIDE)  # tooth 3 left is worn; tooth 7 right is missing: 11 of 11


def test_bars_are_the_values_and_a_broken_one_says_its_own(found):
    figure = pitch_chart(Figure(), found)
    single = figure.axes[1]
    value = 1e3 * found.pitch.single.value[:, 0]
    heights = np.array([bar.get_height() for bar in single.patches])
    broken = np.isin(np.arange(12), [2, 3])  # to the worn tooth and from it
    np.testing.assert_allclose(heights[~broken], value[~broken], atol=1e-9)
    assert (np.abs(heights[broken]) < 0.5 * np.abs(value[broken])).all()
    assert (np.sign(heights[broken]) == np.sign(value[broken])).all()
    strokes = [line for line in single.lines if line.get_color() == PAPER]
    assert len(strokes) == 2 * broken.sum()
    bold = [t.get_text() for t in single.texts if t.get_fontweight() == "bold"]
    assert bold == [micrometres(1e-3 * v) for v in value[broken]]
    said = [t.get_text() for axis in figure.axes for t in axis.texts]
    assert sum("not seen" in text for text in said) >= 3  # the flank's own bars, and the totals of its side
    assert any("tolerance" in text for text in said)


@pytest.mark.long
@pytest.mark.parametrize("teeth", [7, 24, 61])
def test_values_of_bars_touch_neither_bar_nor_whisker(teeth):
    """In pixels of the drawn chart: no value lies over a bar, a whisker or the zero line, and none leaves its chart."""
    gear = Gear.from_spec(GearSpec("gear", teeth, 3.0, 20.0, profile_shift=0.3))
    points = flanks(gear, 32, 16)
    index = np.random.default_rng(4).normal(0.0, 0.01, teeth)
    index[3] += 0.4
    found = inspect(points.with_deviation(points.side * index[points.tooth]), gear, Settings(noise=0.004))
    figure = pitch_chart(Figure(), found)
    renderer = FigureCanvasAgg(figure).get_renderer()
    for axis in figure.axes[1:]:
        values = [t.get_window_extent(renderer) for t in axis.texts[:-1]]
        bars = [bar.get_window_extent(renderer) for bar in axis.patches]
        whiskers = [segment for c in axis.collections for segment in c.get_segments()]
        ends = axis.transData.transform(np.array(whiskers).reshape(-1, 2)).reshape(-1, 2, 2)
        zero = axis.transData.transform((1.0, 0.0))[1]
        low, high = axis.get_window_extent(renderer).intervaly
        assert values
        for box in values:
            assert low <= box.y0
            assert box.y1 <= high
            assert not box.y0 < zero < box.y1
            assert not any(box.overlaps(bar) and min(box.y1, bar.y1) - max(box.y0, bar.y0) > 0.5 for bar in bars)
            across = (ends[:, 0, 0] > box.x0) & (ends[:, 0, 0] < box.x1)
            assert not (across & (ends[..., 1].max(axis=1) > box.y0) & (ends[..., 1].min(axis=1) < box.y1)).any()


@pytest.mark.parametrize(
    ("axis", "said"),
    [pytest.param("bore", "about the axis of the bore.", marks=pytest.mark.long), ("teeth", "takes their common eccentricity")],
)
def test_the_pitch_chart_says_about_which_axis_it_is(found, axis, said):
    about = replace(found, notes=inspect(flanks(found.gear, 20, 6), found.gear, Settings(axis=axis, laboratory=False)).notes)
    told = " ".join(words(pitch_chart(Figure(), about)))
    assert said in told and ("registered on" in told) == (axis == "teeth")


def test_topography_draws_only_what_was_seen(found):
    figure = topography_chart(Figure(), found, 6)
    nets = [c for c in figure.axes[0].collections if type(c).__name__ == "PolyCollection" and len(c.get_paths())]
    assert len(nets) == 1  # the right flank of tooth 7 is missing
    assert len(topography_chart(Figure(), found, 2).axes[0].collections) >= 4


@pytest.mark.parametrize("draw", [profile_chart, helix_chart, pitch_chart, lambda f, i: topography_chart(f, i, 2)])
def test_every_chart_can_be_written(found, draw):
    buffer = io.BytesIO()
    draw(Figure(), found).savefig(buffer, format="svg")
    assert buffer.getvalue().startswith(b"<?xml")


def test_an_empty_inspection_is_drawn_as_such(found, pinion):
    empty = inspect(flanks(pinion, 10, 4).take(np.zeros(960, bool)), pinion)
    for draw in (profile_chart, helix_chart, pitch_chart):
        assert any("not seen" in text for text in words(draw(Figure(), empty)))
    topography_chart(Figure(), empty, 0)


@pytest.mark.long
def test_many_teeth_take_more_rows(wheel):
    points = flanks(wheel, 30, 10)
    found = inspect(points.with_deviation(np.random.default_rng(0).normal(0.0, 0.003, len(points))), wheel)
    one = profile_chart(Figure(), found, teeth=range(12))
    two = profile_chart(Figure(), found)
    assert one.get_size_inches() * 25.4 == pytest.approx([297.0, 210.0])  # a page of A4
    assert two.get_size_inches()[0] == one.get_size_inches()[0]
    assert two.get_size_inches()[1] > one.get_size_inches()[1]
    assert [words(one).count(name) for name in ("11", "13", "23")] == [4, 0, 0]  # above and below the traces of either side
    assert [words(two).count(name) for name in ("11", "13", "23")] == [4, 4, 4]


def test_words():
    assert [micrometres(v) for v in (-0.00004, 0.0123, -0.2345, float("nan"))] == ["0.0", "12.3", "−234", "–"]
    assert [nice(v) for v in (0.9, 1.0, 4.9, 73.0)] == [0.5, 1.0, 2.0, 50.0]
    assert plain("f_Hα") == "fHα"


def test_the_scale_of_parameters_by_tooth_is_that_of_the_many(pinion):
    """A flank that leans by 0.4 mm stands beyond, hollow and with its value; the others keep an axis of their own size."""
    points = flanks(pinion, 40, 16)
    deviation = 0.012 * (points.roll - 14.5) / 23.0 + np.random.default_rng(1).normal(0.0, 0.002, len(points))
    deviation -= np.where((points.tooth == 2) & (points.side == 1), 0.4 * points.position[:, 2] / 15.0, 0.0)
    inspection = inspect(points.with_deviation(deviation), pinion, Settings(laboratory=True))
    figure = areal_chart(Figure(), inspection, inspection.laboratory)
    left, right = (
        next(axis for axis in figure.axes if axis.get_title("left") == f"By tooth · {side} flanks") for side in ("left", "right")
    )
    lean = inspection.laboratory.areal.flanks.named()["helix_slope"]
    assert abs(1e3 * lean.value[2, 0]) > 300.0
    assert micrometres(float(lean.value[2, 0])) in [text.get_text() for text in left.texts]
    assert np.ptp(left.get_ylim()) < 2.0 * np.ptp(right.get_ylim()) < 150.0
    assert not right.texts
