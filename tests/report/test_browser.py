"""The page in a real browser: no errors, the 3-D canvas draws, the buttons work, a point can be read. Skips without Chromium."""

from __future__ import annotations

import io
import math

import numpy as np
import pytest

from gearwear.report.page.view import page
from tests.report.browser import CHROMIUM, browser
from tests.report.fake import bare_results, fake_arrays, fake_results

pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="no Chromium here")


@pytest.fixture(scope="module")
def tab(tmp_path_factory):
    with browser(tmp_path_factory.mktemp("profile")) as found:
        yield found


@pytest.fixture(scope="module")
def view(tab, tmp_path_factory):
    """The page, loaded and drawn."""
    file = tmp_path_factory.mktemp("page") / "report.html"
    file.write_text(page(fake_results(), fake_arrays()), encoding="utf-8")
    tab.complaints.clear()
    tab.open(file)
    if not tab.run("document.documentElement.classList.contains('drawn')"):
        pytest.skip("this Chromium has no WebGL")
    ready = "document.getElementById('view').dataset.ready"
    for _ in range(300):
        if tab.run(ready) == "yes":
            break
        tab.frames(2)
    assert tab.run(ready) == "yes"
    tab.frames(5)
    return tab


def box(view):
    """Left, top, width, height of the 3-D canvas in the window."""
    return view.run("(b => [b.left, b.top, b.width, b.height])(document.querySelector('#view canvas').getBoundingClientRect())")


def shares(view):
    """Parts of the canvas that are darker than the page, worn blue, and the colour of lost metal."""
    from PIL import Image

    pixels = np.asarray(Image.open(io.BytesIO(view.picture(*box(view)))).convert("RGB")).astype(int)[40:]  # below the buttons
    red, _, blue = pixels[..., 0], pixels[..., 1], pixels[..., 2]
    return (pixels.min(axis=2) < 220).mean(), (blue - red > 80).mean(), (red - blue > 130).mean()


def press(view, group):
    view.run(f"document.querySelector('[data-group=\"{group}\"]').click()")
    view.frames(6)
    return shares(view)


def test_the_gear_is_drawn_and_the_buttons_show_and_hide(view):
    start = drawn, blue, orange = shares(view)
    assert drawn > 0.15
    assert blue > 2e-3, "the worn flank faces the viewer"
    assert orange < 1e-4
    assert press(view, "lost")[2] > 2e-3, "lost metal lies on the gear"
    assert press(view, "worn")[0] < 0.5 * drawn, "lost metal alone"
    assert press(view, "lost")[0] == 0.0
    drawn, blue, orange = press(view, "nominal")
    assert drawn > 0.05
    assert blue == orange == 0.0
    press(view, "nominal")
    assert press(view, "worn") == pytest.approx(start, abs=1e-3)
    pressed = view.run("[...document.querySelectorAll('.bar button')].map(b => b.getAttribute('aria-pressed'))")
    assert pressed == ["true", "false", "false"]


def test_dragging_turns_and_the_wheel_zooms(view):
    left, top, width, height = box(view)
    x, y = left + 0.5 * width, top + 0.5 * height
    camera = "(c => [c.eye.x, c.eye.y, c.eye.z])(document.getElementById('view')._fullLayout.scene._scene.getCamera())"
    start = np.array(view.run(camera))
    view.mouse("mousePressed", x, y, button="left", buttons=1, clickCount=1)
    for step in range(1, 4):
        view.mouse("mouseMoved", x + 32 * step, y, button="left", buttons=1)
        view.frames(1)
    view.mouse("mouseReleased", x + 96, y, button="left", buttons=0, clickCount=1)
    view.frames(4)
    turned = np.array(view.run(camera))
    cosine = turned @ start / np.linalg.norm(turned) / np.linalg.norm(start)
    assert cosine < 0.98
    view.mouse("mouseWheel", x, y, deltaX=0, deltaY=-240)
    view.frames(4)
    assert np.linalg.norm(view.run(camera)) < np.linalg.norm(turned)
    view.run("document.querySelector('.modebar-btn[data-title^=\"Reset\"]').click()")
    view.frames(4)
    np.testing.assert_allclose(view.run(camera), start, atol=1e-6)


def test_a_point_reads_tooth_flank_radius_height_and_deviation(view):
    view.run("window.seen = []; document.getElementById('view').on('plotly_hover', e => window.seen.push(e.points[0])); null")
    last = "(p => p && {x: p.x, y: p.y, z: p.z, name: p.data.name, told: [...p.customdata]})(window.seen[window.seen.length - 1])"
    left, top, width, height = box(view)
    for row, column in ((r, c) for r in np.arange(0.8, 0.5, -0.05) for c in np.arange(0.2, 0.8, 0.05)):
        x, y = left + column * width, top + row * height
        view.mouse("mouseMoved", x, y)
        view.frames(3)
        point = view.run(last)
        if point and len(point["told"]) == 3:
            break
    else:
        pytest.fail("no flank was found under the mouse")
    label = view.run("[...document.querySelectorAll('#view .hovertext')].map(t => t.textContent).join()")
    for _ in range(2):  # the canvas takes a click as a press seen between two frames
        view.mouse("mousePressed", x, y, button="left", buttons=1, clickCount=1)
        view.frames(2)
        view.mouse("mouseReleased", x, y, button="left", buttons=0, clickCount=1)
        view.frames(2)
    tooth, radius, deviation = point["told"]
    gear = fake_arrays().gear
    assert radius == pytest.approx(math.hypot(point["x"], point["y"]), abs=1e-3)
    assert 0.0 <= point["z"] <= gear.face_width
    place = math.atan2(point["y"], point["x"]) / gear.pitch_angle - (tooth - 1)
    assert abs((place + 6.0) % 12.0 - 6.0) <= 0.75, "that tooth is there"
    readout = view.run("document.getElementById('readout').textContent")
    for text in (label, readout):
        for part in (
            f"tooth {tooth:g}",
            point["name"],
            f"r {radius:.2f}"[:-1],
            f"z {point['z']:.2f}"[:-1],
            f"{abs(deviation):.1f} µm",
        ):
            assert part in text


def test_no_button_sends_anything_anywhere(view):
    titles = view.run("[...document.querySelectorAll('#view .modebar-btn')].map(b => b.getAttribute('data-title'))")
    assert len(titles) == 5
    assert not [
        title for title in titles if any(word in title.lower() for word in ("cloud", "upload", "edit", "share", "plotly"))
    ]


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


def test_on_a_phone_nothing_hangs_over_and_figures_can_be_read(tab, tmp_path):
    file = tmp_path / "report.html"
    file.write_text(page(fake_results(), fake_arrays()), encoding="utf-8")
    tab.ask("Emulation.setDeviceMetricsOverride", width=390, height=800, deviceScaleFactor=1, mobile=True)
    try:
        tab.open(file)
        for _ in range(300):
            if tab.run("document.getElementById('view').dataset.ready") == "yes":
                break
            tab.frames(2)
        assert tab.run("document.documentElement.scrollWidth") == 390
        legend = "(b => [b.left, b.right, b.width / b.height])(document.querySelector('#view .cbfills').getBoundingClientRect())"
        left, right, shape = tab.run(legend)
        assert left >= 0 and right <= 390 and shape > 5.0, "the legend lies below the gear"
        widths = tab.run("[...document.querySelectorAll('figure svg')].map(svg => svg.getBoundingClientRect().width)")
        assert min(widths) >= 640.0
    finally:
        tab.ask("Emulation.setDeviceMetricsOverride", width=1280, height=900, deviceScaleFactor=1, mobile=False)
