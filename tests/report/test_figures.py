"""Every figure returns its axis, names its units, and shows deviations on a scale that is the same both ways."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from matplotlib import rc_context
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from gearwear.design import Gear, GearSpec
from gearwear.design.side import Side
from gearwear.errors import InputError
from gearwear.meshing.exact import exact_meshing
from gearwear.meshing.path import sliding
from gearwear.report import figures
from gearwear.report.figures.arrays import MeshingCurves
from gearwear.report.figures.colours import DIVERGING, ColourScale, colour_scale
from gearwear.report.figures.surfaces import section, whole_outline
from gearwear.report.page import pictures
from gearwear.wear_law.study import WearStudy
from tests.report.fake import WORN, fake_arrays, fake_regions, fake_results


@pytest.fixture(scope="module")
def arrays():
    return fake_arrays()


@pytest.fixture
def axis():
    with rc_context(figures.STYLE):
        yield Figure(figsize=(8, 4)).add_subplot()


def drawn(axis):
    """The axis, really rendered: what only fails when drawn fails here."""
    axis.figure.draw_without_rendering()
    return axis


SCALES = [ColourScale(40.0), ColourScale(2000.0, 40.0)]


@pytest.mark.parametrize("scale", SCALES, ids=["linear", "arsinh"])
def test_the_scale_is_odd_rising_and_ends_at_its_limit(scale):
    value = np.linspace(0.0, scale.limit_um, 500)
    up, down = scale.fraction(value), scale.fraction(-value)
    np.testing.assert_array_equal(up, -down)
    assert (np.diff(up) > 0.0).all()
    assert (up[0], up[-1]) == (0.0, pytest.approx(1.0))
    assert scale.fraction(np.array(10.0 * scale.limit_um)) == 1.0
    assert scale.ticks_um == tuple(-tick for tick in reversed(scale.ticks_um))
    assert len(scale.tick_labels) == len(scale.ticks_um) <= 11
    assert np.diff(scale.fraction(np.array(scale.ticks_um))).min() > 0.1, "labels do not run into each other"


def test_the_middle_of_an_arsinh_scale_is_about_linear():
    scale = SCALES[1]
    slope = scale.fraction(np.array([1.0, 40.0])) / [1.0, 40.0]
    assert 0.85 < slope[1] / slope[0] <= 1.0  # arsinh(1) = 0.88


def test_the_scale_holds_the_data_and_stretches_only_where_it_must():
    rng = np.random.default_rng(0)
    noise = rng.normal(0.0, 10.0, 20000)
    assert colour_scale(noise).linear_um is None
    assert colour_scale(noise).limit_um >= np.quantile(np.abs(noise), 0.9995)
    worn = np.concatenate([noise, np.full(400, -1500.0), [np.nan]])
    scale = colour_scale(worn, None)
    assert scale.linear_um is not None
    assert scale.limit_um >= 1500.0
    assert colour_scale(None).limit_um > 0.0
    assert colour_scale(np.full(3, np.nan)).limit_um > 0.0


def test_the_colours_are_told_apart_without_hue():
    """Lightness (ITU-R 709 luma) falls from the middle to both ends, and the ends differ in blue against red."""
    rgb = np.array([[int(colour[i : i + 2], 16) for i in (1, 3, 5)] for colour in DIVERGING]) / 255.0
    luma = rgb @ [0.2126, 0.7152, 0.0722]
    middle = len(luma) // 2
    assert (np.diff(luma[: middle + 1]) > 0.0).all()
    assert (np.diff(luma[middle:]) < 0.0).all()
    assert (rgb[:middle, 2] > rgb[:middle, 0]).all(), "missing is blue"
    assert (rgb[middle + 1 :, 0] > rgb[middle + 1 :, 2]).all(), "too much is red"


def test_flank_map_puts_every_cell_where_its_flank_is(axis, arrays):
    """The picture of each flank, cut out again by the place of its tooth number, is the data."""
    scale = ColourScale(60.0)
    values = arrays.residual_before_um
    teeth, _, rows, columns = values.shape
    assert figures.flank_map(axis, values, scale, across=5) is axis
    image = axis.images[0]
    canvas = np.ma.filled(image.get_array().astype(float), np.nan)
    assert image.get_clim() == (-1.0, 1.0)
    numbers = {int(text.get_text()): text.get_position() for text in axis.texts}
    assert sorted(numbers) == list(range(1, teeth + 1))
    heights = sorted({y for _, y in numbers.values()}, reverse=True)
    assert [sum(y == height for _, y in numbers.values()) for height in heights] == [5, 5, 2]
    labels = [(tick, label.get_text()) for tick, label in zip(axis.get_yticks(), axis.get_yticklabels(), strict=True)]
    for tooth in (1, 6, 12):
        x, y = numbers[tooth]
        below = sorted((t for t in labels if t[0] < y), reverse=True)[:2]
        assert [label for _, label in below] == ["left", "right"]
        for side, (middle, _) in enumerate(below):
            bottom, left = round(middle - 0.5 * rows), round(x - 0.5 * columns)
            cut = canvas[bottom : bottom + rows, left : left + columns]
            np.testing.assert_array_equal(cut, scale.fraction(values[tooth - 1, side]))
    assert np.isnan(canvas).sum() > np.isnan(values).sum(), "gaps between flanks are not data"
    drawn(axis)


def test_thinning_keeps_small_maps_and_the_means_of_large_ones():
    rng = np.random.default_rng(0)
    values = rng.normal(0.0, 1.0, (3, 2, 40, 60))
    assert figures.thinned(values, values.size) is values
    few = figures.thinned(values, values.size // 4)
    assert few.shape == (3, 2, 20, 30)
    np.testing.assert_allclose(few, values.reshape(3, 2, 20, 2, 30, 2).mean(axis=(3, 5)), atol=1e-12)
    values[0, 0, :2, :2] = np.nan
    values[0, 0, 2, 2] = np.nan
    few = figures.thinned(values, values.size // 4)
    assert np.isnan(few[0, 0, 0, 0])
    assert few[0, 0, 1, 1] == pytest.approx(np.nanmean(values[0, 0, 2:4, 2:4]))


def test_colour_bar_has_signs_and_a_unit(axis, arrays):
    scale = colour_scale(arrays.deviation_um)
    bar = axis.figure.add_axes((0.9, 0.1, 0.02, 0.8))
    assert figures.colour_bar(bar, scale) is bar
    drawn(bar)
    assert "µm" in bar.get_ylabel()
    labels = [label.get_text() for label in bar.get_yticklabels()]
    assert labels[0].startswith("−")
    assert labels[-1].startswith("+")


def test_waterfall_bars_join_and_end_at_what_is_left(axis):
    loop = fake_results().loop
    assert figures.waterfall(axis, loop) is axis
    bars = [(patch.get_x(), patch.get_x() + patch.get_width()) for patch in axis.patches]
    assert bars[0] == (0.0, pytest.approx(1e3 * loop.rms_before))
    edge = bars[0][1]
    for low, high in bars[1:-1]:
        assert high == pytest.approx(edge)
        edge = low
    assert bars[-1] == (0.0, pytest.approx(edge))
    assert "µm" in axis.get_xlabel()
    assert [label.get_text() for label in axis.get_yticklabels()][1] == "coating"
    drawn(axis)


@pytest.mark.parametrize("lost", [{"effects": ()}, {"held_out_before": np.nan, "held_out_after": np.nan}])
def test_waterfall_draws_what_there_is(axis, lost):
    drawn(figures.waterfall(axis, replace(fake_results().loop, **lost)))


def test_section_shows_the_depth_that_is_in_the_map(axis, arrays):
    tooth, z = 2, 7.0
    nominal, worn = section(arrays, tooth, z)
    depth = np.hypot(*(worn - nominal).T)
    left = nominal[:, 0] < 0.0
    # Along the circle the gap is the normal depth over cos of the pressure angle there.
    radius = np.hypot(*nominal.T)
    normal = depth * arrays.gear.base_radius / np.maximum(radius, arrays.gear.base_radius)
    assert 1e3 * normal[left].max() == pytest.approx(WORN[(1, 0)], rel=0.02)
    assert depth[~left].max() < 1e-9
    assert figures.magnification(nominal, worn) == 1.0
    assert figures.tooth_section(axis, nominal, worn, arrays.gear.reference_radius) is axis
    assert "mm" in axis.get_xlabel()
    assert "mm" in axis.get_ylabel()
    drawn(axis)


def test_thickness_figure_shows_every_tooth(axis):
    thickness = fake_results().wear.thickness
    arc = thickness.arc.copy()
    arc[4] = np.nan
    thickness = replace(thickness, arc=arc)
    assert figures.thickness_per_tooth(axis, thickness) is axis
    assert "mm" in axis.get_ylabel()
    least = axis.lines[2]
    np.testing.assert_array_equal(least.get_xdata(), np.arange(1, 13))
    expected = np.array([tooth.least for tooth in thickness.teeth()])
    low = axis.get_ylim()[0]
    # Three teeth lost tenths, the others micrometres: they would flatten the scale, so their values are written.
    far = expected < low
    assert far.sum() == 3
    np.testing.assert_array_equal(least.get_ydata(), np.where(far, np.nan, expected))
    assert [text.get_text() for text in axis.texts] == [f"{value:.3f}" for value in expected[far]]
    drawn(axis)


@pytest.mark.parametrize(("draw", "unit"), [(figures.transmission_error, "µm"), (figures.backlash, "mm")])
def test_meshing_curves_have_units_and_a_whole_turn(axis, arrays, draw, unit):
    assert draw(axis, arrays.meshing) is axis
    assert unit in axis.get_ylabel()
    assert "°" in axis.get_xlabel()
    assert axis.get_xlim() == (0.0, 360.0)
    assert len(axis.get_legend().get_texts()) == 2
    drawn(axis)


@pytest.mark.parametrize(("draw", "least"), [(figures.transmission_error, 1.0), (figures.backlash, 0.009)])
def test_rounding_is_not_blown_up_to_a_curve(axis, draw, least):
    turn = np.linspace(0.0, 360.0, 100)
    rounding = 1e-13 * np.sin(7.0 * turn)
    draw(axis, MeshingCurves(turn, rounding, np.zeros(100), rounding))
    assert np.ptp(axis.get_ylim()) >= least


def test_a_play_that_is_the_same_all_round_does_not_lie_on_the_frame(axis):
    """Its range is rounding, and the scale ended on its line."""
    turn = np.linspace(0.0, 360.0, 100)
    figures.backlash(axis, MeshingCurves(turn, np.zeros(100), np.full(100, 34.1), 34.1 + 1e-13 * np.sin(7.0 * turn)))
    low, high = axis.get_ylim()
    assert low < 0.0 and high > 0.0341 + 0.04 * (high - low)


def test_what_there_is_nothing_to_draw_of_is_told(axis):
    """A gear compared without the loop, and a law that no wear gave, ended in an AttributeError and a plain ValueError."""
    law = WearStudy(Side.RIGHT, (), (), (), "wear on 2 teeth of one side")
    with pytest.raises(InputError, match=r"loop of type NoneType: that of a gear whose effects were looked for \(loop=True"):
        figures.waterfall(axis, None)
    with pytest.raises(InputError, match="nothing to draw: wear on 2 teeth of one side"):
        figures.worn_profile(axis, law)
    with pytest.raises(InputError, match=r"no forecast; one of ahead=gw.Ahead\(cycles_run, cycles\)"):
        figures.greatest_depth(axis, law)


@pytest.mark.long
def test_the_legend_of_a_section_stands_below_its_words(monkeypatch, arrays):
    """Under the flat tooth of a ring, which is drawn low, it lay on them."""
    across = np.linspace(-4.0, 4.0, 60)
    for high in (2.0, 5.0, 9.0):
        outline = np.column_stack([across, arrays.gear.reference_radius - 0.5 * high + high * np.cos(across / 3.0)])
        monkeypatch.setattr(pictures, "section", lambda *given, outline=outline: (outline, outline))
        with rc_context(figures.STYLE):
            page = pictures.worst_sections(fake_regions(), arrays).draw()
            FigureCanvasAgg(page).draw()
        for each in page.axes:
            assert each.get_legend().get_window_extent().y1 < each.xaxis.label.get_window_extent().y0


@pytest.fixture(scope="module")
def pair():
    pinion, gear = (Gear.from_spec(GearSpec(name, z, 6.35, 15.0)) for name, z in (("pinion", 12), ("gear", 24)))
    return pinion, gear, exact_meshing(pinion, gear, 114.3)


@pytest.fixture(scope="module")
def slid(pair):
    path = pair[2].path
    return sliding(pair[0], pair[1], 114.3, np.linspace(path.start_pinion, path.end_pinion, 400)), path


def test_the_path_lies_on_both_flanks_and_on_the_tangent_of_both_base_circles(axis, pair):
    pinion, gear, exact = pair
    assert figures.pair_in_mesh(axis, *pair) is axis
    lines = {line.get_label(): line.get_xydata() for line in axis.lines}
    start, end = lines["path of contact"]
    assert np.hypot(*start) == pytest.approx(np.hypot(pinion.base_radius, exact.path.start_pinion), abs=1e-9)
    assert np.hypot(*(end - [0.0, 114.3])) == pytest.approx(np.hypot(gear.base_radius, exact.path.start_gear), abs=1e-9)
    one, two = lines["line of action"]
    assert one @ (two - one) == pytest.approx(0.0, abs=1e-9)
    assert (two - [0.0, 114.3]) @ (two - one) == pytest.approx(0.0, abs=1e-9)
    # The outlines do not cut into each other, but for the chords between their points.
    first, second = (patch.get_path() for patch in axis.patches[:2])
    for outline, other in ((first, second), (second, first)):
        corners = outline.vertices[np.hypot(*(outline.vertices - [0.0, pinion.reference_radius]).T) < 15.0]
        inside = corners[other.contains_points(corners)]
        edge = np.diff(other.vertices, axis=0)
        for point in inside:
            along = np.clip(
                ((point - other.vertices[:-1]) * edge).sum(axis=1) / np.maximum((edge**2).sum(axis=1), 1e-12), 0.0, 1.0
            )
            assert np.hypot(*(other.vertices[:-1] + along[:, None] * edge - point).T).min() < 1e-3
    assert {text.get_text() for text in axis.texts} == {*"ABCDE", "T₁", "T₂"}
    drawn(axis)


def test_sliding_is_drawn_along_the_path_with_its_points(axis, slid):
    path = slid[1]
    assert figures.specific_sliding(axis, *slid) is axis
    pinion, gear = (next(line for line in axis.lines if line.get_label() == part) for part in ("pinion", "gear"))
    assert pinion.get_ydata()[[0, -1]] == pytest.approx([-5.41, 0.758], abs=5e-3)
    assert gear.get_ydata()[[0, -1]] == pytest.approx([0.844, -3.13], abs=5e-3)
    assert pinion.get_xdata()[[0, -1]] == pytest.approx([path.start_pinion, path.end_pinion])
    assert [text.get_text() for text in axis.texts] == list("ABCDE")
    assert "mm" in axis.get_xlabel()
    drawn(axis)


def test_sliding_velocity_has_its_unit(axis, slid):
    assert figures.sliding_velocity(axis, *slid) is axis
    assert "mm/s" in axis.get_ylabel() and "1 rad/s" in axis.get_ylabel()
    drawn(axis)


def test_traces_stand_on_their_tooth_and_are_cut_at_the_neighbour(axis, arrays):
    values = np.zeros((12, 30))
    values[3] = 1000.0
    values[5] = 10.0
    assert figures.traces(axis, arrays.z_mm, values, 40.0, "#000000") is axis
    x = [line.get_xdata() for line in axis.lines[:12]]
    assert (np.asarray(x[0]) == 1.0).all()
    assert (np.asarray(x[3]) < 5.0).all()
    assert np.asarray(x[5]) == pytest.approx(6.25)
    assert "µm" in axis.get_xlabel()


def test_outline_is_closed_and_coloured_where_seen(axis):
    planar = fake_arrays(planar=True, worn=False)
    nominal, worn, deviation = whole_outline(planar)
    np.testing.assert_array_equal(worn[0], worn[-1])
    x, y = nominal.T
    area = 0.5 * abs(np.sum(x[:-1] * y[1:] - x[1:] * y[:-1]))
    bore = np.pi * (0.5 * planar.gear.spec.bore_diameter) ** 2
    assert area == pytest.approx(planar.gear.section_area() + bore, rel=3e-3)
    seen = np.isfinite(deviation)
    assert 0.3 < seen.mean() < 0.9
    even = replace(planar, deviation_um=np.where(np.isfinite(planar.deviation_um), 17.0, np.nan))
    shown = whole_outline(even)[2]
    np.testing.assert_allclose(shown[np.isfinite(shown)], 17.0, rtol=1e-12)
    np.testing.assert_array_equal(np.isfinite(shown), seen)
    assert figures.outline(axis, nominal, worn, deviation, ColourScale(50.0)) is axis
    drawn(axis)


def test_contact_map_runs_from_never_to_always(axis, arrays):
    assert figures.contact_map(axis, arrays.contact_share) is axis
    assert axis.images[0].get_clim() == (0.0, 1.0)


def test_the_least_thickness_has_a_whisker_of_two_standard_deviations(axis):
    """A triangle alone three micrometres below the design looked worn, of a least that is known to ± 2.5 µm."""
    thickness = fake_results().wear.thickness
    figures.thickness_per_tooth(axis, thickness)
    whiskers = {round(path.vertices[0, 0]): np.ptp(path.vertices[:, 1]) for path in axis.collections[1].get_paths()}
    for tooth in thickness.teeth():
        if tooth.tooth + 1 in whiskers:
            assert whiskers[tooth.tooth + 1] == pytest.approx(4.0 * tooth.least_std)
    assert len(whiskers) >= 9
