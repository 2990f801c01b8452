"""The 3-D view in a real browser: what it shows and reads is where geometry says. Skips without Chromium."""

from __future__ import annotations

import io
import json
import math

import numpy as np
import pytest
from matplotlib.colors import to_rgb

from gearwear.report.figures.colours import DIVERGING, ColourScale
from gearwear.report.figures.maps import colours
from gearwear.report.page.view import page
from tests.report.browser import CHROMIUM, browser
from tests.report.fake import fake_arrays, fake_gear, fake_results

pytestmark = [pytest.mark.long, pytest.mark.skipif(CHROMIUM is None, reason="no Chromium here")]
GEAR = fake_gear()
FIELD_OF_VIEW = math.radians(28.0)
SHADE = (0.82, 1.04)
"""What light leaves of a colour."""


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    path = tmp_path_factory.mktemp("page") / "report.html"
    path.write_text(page(fake_results(), fake_arrays(columns=24, rows=12)), encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def tab(tmp_path_factory, file):
    with browser(tmp_path_factory.mktemp("profile")) as opened:
        if not opened.open_drawn(file):
            pytest.skip("this Chromium has no WebGL")
        yield opened


@pytest.fixture
def view(tab):
    """The view as it is at first; nothing but the drawing in pictures of it."""
    tab.run("document.getElementById('home').click()")
    tab.frames(3)
    yield tab
    assert tab.complaints == []
    for button in ("measure", "lost", "design"):
        tab.run(
            f"(b => b.getAttribute('aria-pressed') === 'true' && b.click())(document.querySelector('#{button}, [data-group={button}]'))"
        )
    choose(tab, "cut", "none")


def choose(view, field, value):
    view.run(f"(f => {{ f.value = '{value}'; f.dispatchEvent(new Event(f.tagName === 'SELECT' ? 'change' : 'input')); }})"
             f"(document.getElementById('{field}'))")  # fmt: skip
    view.frames(3)


def canvas(view):
    """Left, top, width, height of the canvas in the window."""
    return view.run("(b => [b.left, b.top, b.width, b.height])(window.gearView.canvas.getBoundingClientRect())")


def pixels(view):
    """(height, width, 3) of the canvas over plain green, up to 255."""
    from PIL import Image

    style = "document.head.insertAdjacentHTML('beforeend', '<style id=bare>.notes, #legend { visibility: hidden } canvas { outline: none !important } .viewer { background: #0f0 !important }</style>')"
    view.run(style)
    picture = Image.open(io.BytesIO(view.picture(*canvas(view)))).convert("RGB")
    view.run("document.getElementById('bare').remove()")
    return np.asarray(picture).astype(float)


def nothing(picture):
    """Where no gear is."""
    return (picture == [0.0, 255.0, 0.0]).all(axis=-1)


def read(view, places):
    """What is read at places on the canvas: [name, tooth, point, values] or None."""
    under = "window.gearView.under(x, y)"
    return view.run(f"{np.asarray(places).tolist()}.map(([x, y]) => (r => r && [r.name, r.tooth, r.point, r.read])({under}))")


def from_above(view, away=300.0):
    """See the gear along its axis; gives where a point (r, angle) of its upper end is on the canvas: x points down, y to the right."""
    view.run(f"window.gearView.camera.look([0, 0, 1], {away}); window.gearView.draw()")
    view.frames(3)
    _, _, _width, height = canvas(view)
    focal = 0.5 * height / math.tan(0.5 * FIELD_OF_VIEW)
    middle = view.run("0.5 * window.gearView.camera.width - window.gearView.camera.aside")
    size = focal / (away - 0.5 * GEAR.face_width)
    return lambda radius, angle: (middle + size * radius * np.sin(angle), 0.5 * height + size * radius * np.cos(angle))


def test_the_outline_is_where_perspective_puts_it(view):
    """From above: the tip circle of the upper end and the bore, to a pixel."""
    place = from_above(view)
    drawn = ~nothing(pixels(view))
    rows, columns = np.nonzero(drawn)
    lands = [
        place(GEAR.tip_radius, tooth * GEAR.pitch_angle + share * GEAR.tip_half_angle)
        for tooth in range(12)
        for share in (-1, 0, 1)
    ]
    x, y = np.array(lands).T
    assert columns.max() + 0.5 == pytest.approx(x.max(), abs=1.0)
    assert rows.min() + 0.5 == pytest.approx(y.min(), abs=1.0)
    assert rows.max() + 0.5 == pytest.approx(y.max(), abs=1.0)
    angle = np.linspace(0.0, 2.0 * math.pi, 60)
    x, y = place(12.0 + 0.3, angle)
    assert drawn[y.astype(int), x.astype(int)].all(), "metal outside the bore, 24 mm across"


def test_between_two_tips_is_the_distance_of_their_corners(view):
    """Clicks next to corners of tip and end: the chord between them."""
    place = from_above(view)
    radius, corner = GEAR.tip_radius - 0.05, 0.98 * GEAR.tip_half_angle
    ends = (4 * GEAR.pitch_angle - corner, 9 * GEAR.pitch_angle + corner)
    left, top, _, _ = canvas(view)
    view.run("document.getElementById('measure').click()")
    for angle in ends:
        x, y = place(radius, angle)
        view.drag([(left + x, top + y)])
    picked = view.run("window.gearView.picked.map(p => [p.point, p.tooth])")
    chord = 2.0 * radius * math.sin(0.5 * (ends[1] - ends[0]))
    for (point, tooth), angle, number in zip(picked, ends, (5, 10), strict=True):
        np.testing.assert_allclose(point, [radius * math.cos(angle), radius * math.sin(angle), GEAR.face_width], atol=2e-3)
        assert tooth == number
    words = view.run("document.getElementById('readout').textContent")
    assert float(words.split("distance ")[1].split(" mm")[0]) == pytest.approx(chord, abs=2e-3)
    assert view.run("[...document.querySelectorAll('.notes .pick')][1].textContent") == words.split("distance ")[1].split(" (")[0]
    dots = view.run("[...document.querySelectorAll('.notes circle')].map(c => [c.cx.baseVal.value, c.cy.baseVal.value])")
    np.testing.assert_allclose(dots, [place(radius, angle) for angle in ends], atol=0.05)


@pytest.mark.parametrize(("section", "share"), [("none", 0.5), ("across", 0.5), ("along", 0.6)])
def test_what_is_read_is_what_is_drawn(view, section, share):
    """Metal, nothing or the section, at a thousand pixels: by the ray on the processor as by the graphics."""
    choose(view, "cut", section)
    choose(view, "cut-at", share)
    picture = pixels(view)
    inside = 255.0 * np.array(to_rgb(view.run("JSON.parse(document.getElementById('scene').textContent).colours.inside")))
    empty, cut = nothing(picture), (np.abs(picture - inside) < 1.5).all(axis=-1)
    rows, columns = (grid.ravel() for grid in np.mgrid[8 : picture.shape[0] - 8 : 13, 8 : picture.shape[1] - 8 : 17])

    def even(seen):
        return np.array([np.ptp(seen[r - 1 : r + 2, c - 1 : c + 2].astype(int)) == 0 for r, c in zip(rows, columns, strict=True)])

    away_from_edges = even(empty) & even(cut)
    rows, columns = rows[away_from_edges], columns[away_from_edges]
    names = [None if reading is None else reading[0] for reading in read(view, np.stack([columns + 0.5, rows + 0.5], axis=1))]
    assert [name is None for name in names] == empty[rows, columns].tolist()
    assert [name == "section" for name in names] == cut[rows, columns].tolist()
    assert ("section" in names) == (section != "none")
    assert len(rows) > 1000 and not all(empty[rows, columns])


def test_a_section_is_read_in_its_plane(view):
    choose(view, "cut", "across")
    choose(view, "cut-at", 0.4)
    place = from_above(view)
    (name, tooth, point, values), *_ = read(view, [place(GEAR.root_radius, 5 * GEAR.pitch_angle)])
    assert (name, tooth, values) == ("section", 6, {})
    assert point[2] == pytest.approx(0.4 * GEAR.face_width, abs=1e-9)


@pytest.mark.parametrize("key", ["wear", "measured"])
def test_a_colour_is_that_of_the_scale_and_the_legend(view, key):
    """Pixels on flanks, against the colour map of the figures: the same but for light, which has no colour."""
    view.run(f"document.querySelector('[data-view={key}]').click()")
    view.frames(4)
    picture = pixels(view)
    places = np.array([[c + 0.5, r + 0.5] for r in range(5, picture.shape[0], 9) for c in range(5, picture.shape[1], 9)])
    told = view.run("JSON.parse(document.getElementById('scene').textContent).views")
    scale = next(ColourScale(one["limit"], one["linear"]) for one in told if one["key"] == key)
    readings = [
        (places[i], reading[3][key])
        for i, reading in enumerate(read(view, places))
        if reading and "flank" in reading[0] and key in reading[3]
    ]
    shares, errors = [], []
    for (x, y), um in readings:
        expected = 255.0 * np.array(colours()(0.5 + 0.5 * float(scale.fraction(np.array(um))))[:3])
        seen = picture[int(y), int(x)]
        shares.append(seen @ expected / (expected @ expected))
        errors.append(np.abs(seen - shares[-1] * expected).max())
    assert len(readings) > 100
    # The pixel lies between corners and its value with it; a tenth lies next to an edge of what was seen.
    assert np.quantile(errors, 0.85) < 8.0
    assert SHADE[0] - 0.03 < np.quantile(shares, 0.1) and np.quantile(shares, 0.9) < SHADE[1] + 0.03
    view.run("document.querySelector('[data-view=wear]').click()")


def test_an_own_range_saturates_the_colours(view):
    def darkest():
        return (np.abs(pixels(view) - 255.0 * np.array(to_rgb(DIVERGING[0]))).max(axis=-1) < 30.0).mean()

    assert darkest() < 1e-4
    choose(view, "range", "300")
    assert darkest() > 2e-3
    choose(view, "range", "")


def look(view):
    """Azimuth and elevation in degrees, distance in mm, target."""
    azimuth, elevation, away, *target = view.run("(c => [c.azimuth, c.elevation, c.away, ...c.target])(window.gearView.camera)")
    return math.degrees(azimuth), math.degrees(elevation), away, np.array(target)


def test_one_finger_turns_and_two_pinch_and_pan(view):
    left, top, width, height = canvas(view)
    x, y = left + 0.5 * width, top + 0.5 * height
    view.ask("Emulation.setTouchEmulationEnabled", enabled=True, maxTouchPoints=2)
    before = look(view)
    view.touch(*[[(x + 20 * step, y)] for step in range(6)])
    turned = look(view)
    # Chromium keeps back the first 15 px of a finger, until it knows that they are no tap.
    assert before[0] - turned[0] == pytest.approx(360.0 * 100.0 / height, abs=360.0 * 16.0 / height)
    assert (turned[1], turned[2]) == (before[1], before[2])
    view.touch(*[[(x - 40 - 8 * step, y), (x + 40 + 8 * step, y)] for step in range(6)])
    pinched = look(view)
    assert pinched[2] < 0.75 * turned[2]
    assert pinched[0] == turned[0], "two fingers do not turn"
    view.touch(*[[(x - 40 + 10 * step, y), (x + 40 + 10 * step, y)] for step in range(6)])
    panned = look(view)
    assert np.linalg.norm(panned[3] - pinched[3]) > 1.0
    assert panned[2] == pytest.approx(pinched[2], rel=0.02)
    assert view.run("window.gearView.picked.length") == 0, "no finger that moved has picked"
    view.ask("Emulation.setTouchEmulationEnabled", enabled=False)


def test_the_wheel_zooms_to_what_is_under_the_mouse(view):
    left, top, width, height = canvas(view)
    place = (0.2 * width, 0.65 * height)
    (before,) = read(view, [place])
    away = look(view)[2]
    view.mouse("mouseWheel", left + place[0], top + place[1], deltaX=0, deltaY=-240)
    view.frames(4)
    assert look(view)[2] < 0.8 * away
    (after,) = read(view, [place])
    # What lies in the plane of the target stays; the surface is not in it, and moves by what it stands out.
    assert math.dist(before[2], after[2]) < 6.0


def test_shift_and_the_mouse_pan(view):
    left, top, width, height = canvas(view)
    start, x, y = look(view), left + 0.5 * width, top + 0.5 * height
    middle = view.run("(p => [p.x, p.y])(window.gearView.camera.project(window.gearView.camera.middle))")
    view.drag([(x, y), (x + 20, y + 10), (x + 40, y + 30)], modifiers=8)
    assert look(view)[:3] == start[:3]
    moved = view.run("(p => [p.x, p.y])(window.gearView.camera.project(window.gearView.camera.middle))")
    np.testing.assert_allclose(np.subtract(moved, middle), [40.0, 30.0], atol=1e-6)


def test_keys_turn_zoom_pan_read_and_go_home(view):
    view.run("window.gearView.canvas.focus()")
    start = look(view)
    view.key("ArrowRight")
    assert look(view)[0] == pytest.approx(start[0] - 5.0)
    view.key("ArrowUp")
    assert look(view)[1] == pytest.approx(start[1] - 5.0)
    view.key("+")
    assert look(view)[2] < start[2]
    view.key("-")
    assert look(view)[2] == pytest.approx(start[2])
    left, top, _width, height = canvas(view)
    view.drag([(left + 50.0, top + share * height) for share in (0.1, 0.5, 0.9)])
    assert look(view)[1] == 90.0, "the gear does not tip over"
    choose(view, "cut", "across")
    view.run("window.gearView.canvas.focus()")
    view.key("Enter")
    assert view.run("window.gearView.picked.length") == 0, "the bore is in the middle"
    view.key("Home")
    home = look(view)
    assert home[:3] == pytest.approx(start[:3])
    np.testing.assert_allclose(home[3], start[3])


def test_a_lost_context_leaves_the_picture_and_comes_back(view):
    shown = "['.still', '#view', '.bar'].map(s => getComputedStyle(document.querySelector(s)).display !== 'none')"
    before = pixels(view)
    view.run(
        "window.lose = window.gearView.canvas.getContext('webgl2').getExtension('WEBGL_lose_context'); window.lose.loseContext()"
    )
    view.frames(5)
    assert view.run(shown) == [True, False, False]
    view.run("window.lose.restoreContext()")
    view.frames(10)
    assert view.run(shown) == [False, True, True]
    np.testing.assert_array_equal(pixels(view), before)


def test_fine_screens_and_other_widths_are_drawn_sharp(view):
    size = "(c => [c.width, c.height, c.clientWidth, c.clientHeight])(window.gearView.canvas)"
    view.run("window.gearView.canvas.focus()")
    view.key("ArrowRight")  # what the reader turned stays, whatever the window does
    eye = np.array(view.run("window.gearView.camera.eye"))
    try:
        for width, density, times in ((1200, 2.0, 2.0), (1000, 1.0, 1.0), (900, 1.5, 1.5), (600, 3.0, 2.0)):
            view.screen(width, 900, density)
            view.frames(8)
            across, down, wide, high = view.run(size)
            assert (across, down) == pytest.approx((times * wide, times * high), abs=0.5)
            np.testing.assert_array_equal(view.run("window.gearView.camera.eye"), eye)
    finally:
        view.screen()
        view.frames(8)


def test_without_webgl_the_picture_stays(file, tmp_path):
    with browser(tmp_path) as tab:
        tab.ask("Page.addScriptToEvaluateOnNewDocument", source="HTMLCanvasElement.prototype.getContext = () => null")
        assert not tab.open_drawn(file)
        shown = "['.still', '#view', '#legend', '.bar'].map(s => getComputedStyle(document.querySelector(s)).display !== 'none')"
        assert tab.run(shown) == [True, False, False, False]
        assert tab.complaints == []


def test_a_phone_that_is_turned_still_shows_the_whole_gear(view):
    """Tips of both ends lie on the canvas, left of the legend, after a window of another shape too; until the reader has turned the gear."""
    corners = [
        [GEAR.tip_radius * math.cos(angle), GEAR.tip_radius * math.sin(angle), z]
        for angle in np.arange(12) * GEAR.pitch_angle
        for z in (0.0, GEAR.face_width)
    ]
    seen = f"{json.dumps(corners)}.map(p => window.gearView.camera.project(p)).map(p => [p.x, p.y])"
    size = "(c => [c.clientWidth, c.clientHeight])(window.gearView.canvas)"
    try:
        for shape in ((800, 600), (390, 800), (800, 600)):
            view.screen(*shape, mobile=True)
            view.frames(4)
            x, y = np.array(view.run(seen)).T
            width, height = view.run(size)
            assert x.min() > 0.0 and x.max() < width - 84.0 and y.min() > 0.0 and y.max() < height, shape
        view.run("window.gearView.canvas.focus()")
        view.key("ArrowRight")
        eye = view.run("window.gearView.camera.eye")
        view.screen(390, 800, mobile=True)
        view.frames(4)
        assert view.run("window.gearView.camera.eye") == eye
    finally:
        view.screen()
        view.frames(4)
