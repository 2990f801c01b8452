"""The page in a real browser: no errors, the 3-D canvas draws, the buttons work, a point can be read. Skips without Chromium."""

from __future__ import annotations

import io
import math
from dataclasses import replace

import numpy as np
import pytest

from gearwear.design.report_details import ReportDetails
from gearwear.report.page.view import VIEWER, page, rendered, view_of
from tests.report.browser import CHROMIUM, browser
from tests.report.fake import bare_results, fake_arrays, fake_results

pytestmark = [pytest.mark.long, pytest.mark.skipif(CHROMIUM is None, reason="no Chromium here")]


@pytest.fixture(scope="module")
def tab(tmp_path_factory):
    with browser(tmp_path_factory.mktemp("profile")) as found:
        yield found


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    """The page."""
    file = tmp_path_factory.mktemp("page") / "report.html"
    file.write_text(page(fake_results(), fake_arrays()), encoding="utf-8")
    return file


@pytest.fixture(scope="module")
def view(tab, file):
    """The page, loaded and drawn."""
    tab.complaints.clear()
    if not tab.open_drawn(file):
        pytest.skip("this Chromium has no WebGL")
    return tab


def box(view):
    """Left, top, width, height of the 3-D canvas in the window."""
    return view.run("(b => [b.left, b.top, b.width, b.height])(document.querySelector('#view canvas').getBoundingClientRect())")


def shares(view):
    """Parts of the canvas that are darker than the page, blue as missing metal, and red; labels and legend do not count."""
    from PIL import Image

    hide = "for (const e of document.querySelectorAll('.notes, #legend')) e.style.visibility = '{}'"
    view.run(hide.format("hidden"))
    pixels = np.asarray(Image.open(io.BytesIO(view.picture(*box(view)))).convert("RGB")).astype(int)
    view.run(hide.format(""))
    red, _, blue = pixels[..., 0], pixels[..., 1], pixels[..., 2]
    return (pixels.min(axis=2) < 220).mean(), (blue - red > 80).mean(), (red - blue > 25).mean()


def press(view, group):
    view.run(f"document.querySelector('[data-group=\"{group}\"]').click()")
    view.frames(6)
    return shares(view)


def test_the_gear_is_drawn_and_the_buttons_show_and_hide(view):
    start = drawn, blue, red = shares(view)
    assert drawn > 0.15
    assert blue > 2e-3, "the worn flank faces the viewer"
    assert red < 1e-4, "wear alone has no red"
    assert press(view, "design")[1] == pytest.approx(blue, rel=0.5), "the design is a veil"
    press(view, "design")
    assert press(view, "worn")[0] == 0.0
    assert press(view, "lost")[1] > 2e-3, "lost metal alone, in the blue of what is missing"
    press(view, "lost")
    assert press(view, "worn") == pytest.approx(start, abs=1e-3)
    pressed = view.run("[...document.querySelectorAll('[data-group]')].map(b => b.getAttribute('aria-pressed'))")
    assert pressed == ["true", "false", "false"]


def test_the_first_picture_is_wear_and_the_switch_shows_the_coat(view):
    views = view.run("[...document.querySelectorAll('[data-view]')].map(b => [b.dataset.view, b.getAttribute('aria-pressed')])")
    assert views == [["wear", "true"], ["effects_out", "false"], ["measured", "false"]]
    red = shares(view)[2]
    view.run("document.querySelector('[data-view=measured]').click()")
    view.frames(6)
    title = "document.querySelector('#legend p').textContent"
    assert "deviation" in view.run(title) and "as measured" in view.run("document.getElementById('under').textContent")
    assert shares(view)[2] > red
    view.run("document.querySelector('[data-view=wear]').click()")
    view.frames(6)
    assert "wear depth" in view.run(title)


def test_an_own_colour_range_is_that_of_the_legend(view):
    ticks = "[...document.querySelectorAll('.ramp span')].map(s => s.textContent)"
    before = view.run(ticks)
    field = "(f => {{ f.value = '{}'; f.dispatchEvent(new Event('input')); }})(document.getElementById('range'))"
    view.run(field.format("50"))
    assert [float(text) for text in view.run(ticks)] == [50.0, 25.0, 0.0]
    view.run(field.format(""))
    assert view.run(ticks) == before


def test_a_section_cuts_the_gear_and_names_its_height(view):
    whole = shares(view)[0]
    choose = "(s => {{ s.value = '{}'; s.dispatchEvent(new Event('change')); }})(document.getElementById('cut'))"
    view.run(choose.format("across"))
    view.frames(6)
    assert view.run("document.getElementById('cut-words').textContent") == "z = 7.50 mm"
    assert shares(view)[0] < 0.95 * whole, "the upper half is away"
    assert view.run("window.gearView.section()") == [0, 0, -1, 7.5]
    view.run(choose.format("none"))
    view.frames(6)
    assert shares(view)[0] == pytest.approx(whole, abs=1e-3)


def test_teeth_and_both_ends_are_labelled(view):
    words = view.run("[...document.querySelectorAll('.notes span')].map(s => s.textContent)")
    assert [str(n) for n in range(1, 13)] == words[:12] and words[12:14] == ["z = 0", "z = 15"]


def test_dragging_turns_and_the_wheel_zooms(view):
    left, top, width, height = box(view)
    x, y = left + 0.5 * width, top + 0.5 * height
    camera = "window.gearView.camera.eye"
    start = np.array(view.run(camera))
    view.drag([(x + 32 * step, y) for step in range(4)])
    middle = np.array([0.0, 0.0, 7.5])
    turned = np.array(view.run(camera))
    cosine = (turned - middle) @ (start - middle) / np.linalg.norm(turned - middle) / np.linalg.norm(start - middle)
    assert cosine < 0.98
    view.mouse("mouseWheel", x, y, deltaX=0, deltaY=-240)
    view.frames(4)
    assert np.linalg.norm(view.run(camera) - middle) < 0.98 * np.linalg.norm(turned - middle)
    view.run("document.getElementById('home').click()")
    view.frames(4)
    np.testing.assert_allclose(view.run(camera), start, atol=1e-6)


def click(view, x, y):
    view.mouse("mousePressed", x, y, button="left", buttons=1, clickCount=1)
    view.mouse("mouseReleased", x, y, button="left", buttons=0, clickCount=1)
    view.frames(2)


def readout(view):
    return view.run("document.getElementById('readout').textContent")


def test_two_points_read_tooth_flank_place_wear_and_their_distance(view):
    left, top, width, height = box(view)
    view.run("document.getElementById('measure').click()")
    picked = "window.gearView.picked.map(p => ({point: p.point, tooth: p.tooth, name: p.name, read: p.read}))"
    for x, y in ((r, c) for r in np.arange(0.2, 0.8, 0.05) for c in np.arange(0.75, 0.5, -0.05)):
        view.mouse("mouseMoved", left + x * width, top + y * height)
        click(view, left + x * width, top + y * height)
        if len(view.run(picked)) == 2:
            break
    else:
        pytest.fail("no two points were found under the mouse")
    words, (one, two) = readout(view), view.run(picked)
    gear = fake_arrays().gear
    for place in (one, two):
        x, y, z = place["point"]
        assert gear.root_radius - 0.01 < math.hypot(x, y) < gear.tip_radius + 0.01 or place["name"] == "end face"
        assert -1e-6 <= z <= gear.face_width + 1e-6
        if "flank" in place["name"]:
            turn = math.atan2(y, x) / gear.pitch_angle - (place["tooth"] - 1)
            assert abs((turn + 6.0) % 12.0 - 6.0) <= 0.75, "that tooth is there"
    x, y, z = two["point"]
    for part in (f"tooth {two['tooth']}", two["name"], f"r {math.hypot(x, y):.2f} mm", f"z {z:.2f} mm"):
        assert part in words
    assert f"distance {math.dist(one['point'], two['point']):.3f} mm" in words
    view.run("document.getElementById('measure').click()")
    assert view.run(picked) == []


def test_the_worn_flank_reads_its_depth(view):
    """The deepest place of the map is where the viewer reads it."""
    place = view.run("""(() => {
        const g = window.gearView, flank = g.surfaces.find(one => one.group === 'worn' && one.name === 'left flank');
        const wear = flank.values.wear, at = wear.at.reduce((best, v, i) => v > -32768 && v < wear.at[best] ? i : best, 0);
        const there = g.camera.project([...flank.corners.subarray(3 * at, 3 * at + 3)]);
        const b = g.canvas.getBoundingClientRect();
        return [b.left + there.x, b.top + there.y, -wear.step * wear.at[at]];
    })()""")
    assert place[2] == pytest.approx(1550.0, rel=0.02)
    click(view, place[0], place[1])
    assert "tooth 2 · left flank" in readout(view)
    depth = float(readout(view).split("wear ")[1].split(" µm")[0])
    assert depth == pytest.approx(1550.0, rel=0.03)


def test_nothing_was_complained_of_and_nothing_asked_for(view):
    assert view.complaints == []


def test_in_print_the_still_picture_takes_the_place_of_the_canvas(view):
    shown = "['.still', '#view', 'nav'].map(s => getComputedStyle(document.querySelector(s)).display !== 'none')"
    assert view.run(shown) == [False, True, True]
    view.ask("Emulation.setEmulatedMedia", media="print")
    assert view.run(shown) == [True, False, False]
    view.ask("Emulation.setEmulatedMedia", media="")


def test_a_planar_page_has_no_errors_and_no_scripts(tab, tmp_path):
    (tmp_path / "page.html").write_text(page(bare_results(), fake_arrays(planar=True, worn=False)), encoding="utf-8")
    tab.complaints.clear()
    tab.open(tmp_path / "page.html")
    assert tab.run("document.scripts.length") == 0
    assert tab.run("document.images[0].naturalWidth") > 500
    assert tab.complaints == []


def test_on_a_phone_nothing_hangs_over_and_figures_can_be_read(tab, file):
    tab.screen(390, 800, mobile=True)
    try:
        tab.open_drawn(file)
        assert tab.run("document.documentElement.scrollWidth") == 390
        inner = "[...document.querySelectorAll('.bar button, .bar select, .bar input:not([hidden]), #legend')].map(e => e.getBoundingClientRect())"
        assert all(low >= 0 and high <= 390 for low, high in tab.run(f"{inner}.map(b => [b.left, b.right])"))
        type_ = "[...document.querySelectorAll('figure svg text')].filter(t => t.textContent.trim())"
        sizes = tab.run(f"{type_}.map(t => parseFloat(getComputedStyle(t).fontSize) * t.getScreenCTM().a * 0.75)")
        assert len(sizes) > 100 and min(size for size in sizes if size > 0.0) > 6.5, "points"
    finally:
        tab.screen()


def test_markup_in_names_and_remarks_stays_text_and_nothing_runs(tab, tmp_path):
    """What users write holds scripts, handlers and ends of elements: the browser shows it as text and runs none of it."""
    nasty = "</script></title></style><script>window.hacked = 1</script><img src=x onerror='window.hacked = 2'>\"'`${window.hacked = 3}"
    details = ReportDetails(
        part_number=nasty, serial=nasty, customer=nasty, operator=nasty, instrument=nasty, date=nasty, remarks=nasty
    )
    results = fake_results()
    scan = replace(results.measured.scans[0], files=(nasty,))
    design = replace(results.design, source=nasty, report=details)
    results = replace(
        results, measured=replace(results.measured, scans=(scan,), design=design), notes=(nasty,), before_files=(nasty,)
    )
    view = view_of(results, fake_arrays(columns=16, rows=8), (nasty,), nasty)
    view.scene["labels"][0]["text"] = nasty
    file = tmp_path / "report.html"
    file.write_text(rendered(view), encoding="utf-8")
    tab.complaints.clear()
    tab.open(file)
    tab.frames(10)
    assert tab.run("window.hacked === undefined") is True
    assert tab.run("document.scripts.length") == len(VIEWER) + 1
    assert tab.run("document.images.length") == 1, "the still picture alone"
    assert tab.run("document.body.textContent").count(nasty) >= 10
    assert tab.complaints == []
    # the policy itself: a script that somehow came into the page is refused
    tab.run("(s => { s.textContent = 'window.hacked = 4'; document.body.append(s); })(document.createElement('script'))")
    tab.frames(2)
    assert tab.run("window.hacked === undefined") is True
    assert any("Content Security Policy" in said for said in tab.complaints)
    tab.complaints.clear()
