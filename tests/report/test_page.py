"""The page: well-formed, on its own, complete, and safe against what users write."""

from __future__ import annotations

import base64
import hashlib
import io
import json
import re
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
from markupsafe import Markup
from matplotlib import rc_context
from matplotlib.figure import Figure
from PIL import Image

from gearwear.comparison.contact_readings import ReadOtherwise
from gearwear.design.quantity import with_std
from gearwear.diagnose.correlations import Correlation
from gearwear.diagnose.pattern import Pattern
from gearwear.report import figures
from gearwear.report.page import svg, view
from gearwear.report.page.view import page, write_html
from tests.report.fake import bare_results, changed, fake_arrays, fake_results, open_contact

SECTIONS = ["wear", "loop", "thickness", "meshing", "inspection", "paper", "registration", "scan", "doubts", "files"]
FILES = ("report.json", "report.html", "worn_volume.stl")
VOID = {"meta", "br", "img", "link", "hr", "input", "source", "wbr", "col", "area", "base", "embed", "track", "param"}


class Reader(HTMLParser):
    """Elements, text and attributes; fails where tags do not nest."""

    def __init__(self, text):
        super().__init__(convert_charrefs=True)
        self.open, self.tags, self.words, self.scripts = [], [], [], []
        self.feed(text)
        self.close()
        assert self.open == [], f"never closed: {self.open}"

    def handle_starttag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))

    def handle_endtag(self, tag):
        assert self.open, f"</{tag}> with nothing open"
        assert self.open.pop() == tag

    def handle_data(self, data):
        (self.scripts if self.open and self.open[-1] in ("script", "style") else self.words).append(data)

    @property
    def text(self):
        return re.sub(r"\s+", " ", " ".join(self.words))


@pytest.fixture(scope="module")
def full():
    return page(fake_results(), fake_arrays(), FILES)


@pytest.fixture
def little(monkeypatch):
    """Arrays without anything that may be missing, and nothing rendered: for tests of the words."""
    monkeypatch.setattr(svg, "svg", lambda figure, ident, trim=True: Markup("<svg></svg>"))
    nothing = dict.fromkeys(("residual_before_um", "residual_after_um", "elsewhere", "meshing", "contact_share"))
    return replace(fake_arrays(columns=12, planar=True), **nothing)


@pytest.fixture(scope="module")
def bare():
    return page(bare_results(), fake_arrays(planar=True, worn=False))


@pytest.mark.long
def test_the_page_is_well_formed_and_below_4_5_mb(full, bare):
    for text in (full, bare):
        reader = Reader(text)
        assert text.startswith("<!DOCTYPE html>")
        idents = [attributes["id"] for _, attributes in reader.tags if "id" in attributes]
        assert len(idents) == len(set(idents))
        targets = {attributes["href"][1:] for tag, attributes in reader.tags if tag == "a"}
        assert targets <= set(idents)
    assert len(full.encode()) < 4.5e6
    assert len(bare.encode()) < 1e6, "a planar section needs no 3-D library"


@pytest.mark.long
def test_a_gear_of_many_teeth_and_fine_maps_stays_below_4_5_mb():
    text = page(fake_results(), fake_arrays(60, columns=60, rows=80))
    assert len(text.encode()) < 4.5e6


def test_nothing_is_fetched_from_anywhere(full, bare):
    for text in (full, bare):
        for tag, attributes in Reader(text).tags:
            for key in ("src", "href", "xlink:href", "action", "data", "poster"):
                address = attributes.get(key, "")
                assert address.startswith(("#", "data:image/png;base64,")) or not address, (tag, key, address[:80])
            assert "url(http" not in attributes.get("style", "")
    policy = re.search(r'Content-Security-Policy" content="([^"]+)"', full)[1]
    assert policy.startswith("default-src 'none'")
    assert "http" not in policy
    assert "unsafe" not in policy.split("script-src")[1].split(";")[0]


def test_the_policy_allows_the_scripts_of_the_page_and_no_other(full, bare):
    allowed = re.search(r"script-src ([^;]+);", full)[1].split()
    scripts = re.findall(r"<script>(.*?)</script>", full, re.S)
    digests = [base64.b64encode(hashlib.sha256(script.encode()).digest()).decode() for script in scripts]
    assert allowed == [f"'sha256-{digest}'" for digest in digests] and len(scripts) == len(view.VIEWER)
    assert re.search(r"script-src ([^;]+);", bare)[1] == "'none'"


def test_the_viewer_is_written_here_to_be_read_and_needs_nothing_from_outside():
    folder = Path(view.__file__).parent
    written = {file.relative_to(folder).as_posix() for file in folder.rglob("*.js")}
    assert written == set(view.VIEWER)
    for name in view.VIEWER:
        text = folder.joinpath(name).read_text("utf-8")
        assert max(map(len, text.splitlines())) <= 160, "not made by a machine"
        assert not re.search(
            r"\beval\b|new Function|\bimport\b|\bfetch\b|XMLHttp|innerHTML|outerHTML|insertAdjacent|https?://(?!www.w3.org)", text
        )


def test_all_sections_are_there_in_order(full):
    idents = [attributes.get("id") for tag, attributes in Reader(full).tags if tag == "section"]
    assert idents == SECTIONS


def test_every_figure_has_a_caption_and_a_unit(full):
    captions = re.findall(r"<figcaption>.*?</figcaption>", full, re.S)
    drawings = re.findall(r"<figure.*?</figure>", full, re.S)
    assert len(captions) == len(drawings) >= 7
    for drawing in drawings:
        words = " ".join(re.findall(r"<text[^>]*>([^<]*)", drawing))
        assert re.search(r"µm|mm|share of passings", words), drawing[:200]


def test_what_users_write_is_text_not_markup(full):
    assert "<b>&amp;" not in full
    assert 'scan <b>&"worn"</b>.ply' in Reader(full).text
    nasty = "</script><script>alert(1)</script>"
    results = fake_results()
    effect = results.loop.effects[0]
    loop = replace(
        results.loop,
        effects=(replace(effect, alternatives=(nasty,)), *results.loop.effects[1:]),
        patterns=(Pattern(5, nasty, 0.0, 0.0, 0.001, 0.002, 1e-9, np.zeros(1)),),
        correlations=(Correlation((nasty, nasty), (nasty, nasty), 0.95),),
    )
    results = replace(
        results, measured=replace(results.measured, part="pinion", loop=loop), notes=(nasty,), before_files=(nasty,)
    )
    results = replace(results, changes=(replace(results.changes[0], causes=((nasty, 1.0),)),))
    results = changed(results, "measured.placed.registration.datum.surfaces", (nasty,))
    text = page(results, fake_arrays(columns=8, rows=4), (nasty,))
    assert "<script>alert" not in text
    assert sum(tag == "script" for tag, _ in Reader(text).tags) == len(view.VIEWER) + 1
    assert Reader(text).text.count("alert(1)") >= 8


def test_what_the_effects_would_have_cost_stands_at_the_loop(little):
    def rows(results):
        words = Reader(page(results, little)).text
        return (
            words.split("Closed loop: what else is in the scan", 1)[1].split("Tooth thickness", 1)[0]
            if "owing to" in words
            else ""
        )

    results = fake_results()
    volume, deepest, *others = results.changes
    shown = rows(replace(results, changes=(volume, replace(deepest, std=71.0), *others)))
    for row in (
        "worn volume, mm³ coating 83.10 90.80 7.70 ± 0.80 0.00",
        "deepest wear, µm no change to be seen 1 531.2 1 550.0 19 ± 71 0.0",
        "backlash, greatest, mm coating 1.60330 1.64590 0.04260 ± 0.00060 0.22860",
        "transmission error, peak to peak, µm turntable angle 1 562.1 1 549.2 −12.9 ± 1.2 –",
    ):
        assert row in shown.replace("\u202f", " "), row
    assert rows(bare_results()) == rows(changed(results, "measured.loop.effects", ())) == ""


def test_correlations_stand_with_the_effects(full):
    shown = Reader(full).text
    assert "Correlations of their sizes" in shown and "coating, thickness scale, relative −0.42" in shown


def test_what_is_open_of_the_contact_stands_beside_it_with_why(little):
    text = Reader(page(open_contact(), little)).text.replace("\u202f", " ")
    table = text.split("Meshing: design against worn", 1)[1].split("Published", 1)[0]
    for row in ("(1.100 to 1.300)", "(1.0 to 1 600.0)"):
        assert row in table, row
    assert table.count(f"leaves open: {ReadOtherwise.SIDES}; {ReadOtherwise.PATTERN}.") == 1
    assert "In brackets: within" not in Reader(page(fake_results(), little)).text


def test_the_published_calculation_is_no_result_of_the_scan(full):
    """Its backlash and its contact length are the paper's numbers; the scan's stand under Meshing, once."""
    text = Reader(full).text
    _, _, paper = text.partition("The published calculation, not measured")
    paper = paper.split("Registration: how", 1)[0]
    assert "none is the result of this scan" in paper and "backlash, mm" not in paper
    for result in ("circumferential backlash, mm", "path of contact, mm"):
        assert full.count(f"<td>{result}</td>") == 1


def test_the_scene_is_json_without_nan(full):
    packed = re.search(r'<script type="application/json" id="scene">(.*?)</script>', full, re.S)[1]
    scene = json.loads(packed, parse_constant=pytest.fail)
    assert {"surfaces", "views", "labels", "faceWidth", "eye", "box", "colours"} == set(scene)


def test_missing_parts_are_said_to_be_missing(bare):
    text = Reader(bare).text
    for sentence in (
        "No wear was found",
        "No region of wear stands out",
        "A planar section gives areas",
        "No effect of measurement or manufacture was looked for",
        "is the furthest below the gear as made",
        "names one gear and no mate",
    ):
        assert sentence in text
    assert "nan" not in text.lower().split()
    assert "None" not in text.replace("None.", "")


def test_arrays_that_are_not_there_are_left_out(little):
    text = Reader(page(fake_results(), little)).text
    assert "No curves over the revolution" in text
    assert "Residual before" not in text
    assert "Contact pattern" not in text


@pytest.mark.long
@pytest.mark.parametrize("path", ["measured.loop", "pair", "inspection", "wear.solids", "pair.law", "pair.spread", "pair.shafts"])
def test_results_without_any_one_part_still_make_a_page(path, little):
    Reader(page(changed(fake_results(), path, None), little))


def test_a_least_thickness_has_its_own_uncertainty(full):
    """The ± of one section beside the least of many would be taken for that of the least."""
    results = fake_results()
    tooth = results.wear.lost_most
    assert tooth.least_std > 0.0 and tooth.loss_std > 0.0
    text = Reader(full).text
    for value, std in ((tooth.greatest_loss, tooth.loss_std), (tooth.least, tooth.least_std)):
        said = with_std(value, std).replace("\u202f", " ")
        assert f"{said} mm" in text and said in text[text.index("least at z, mm") :]


def test_no_thickness_is_said_so(little):
    unseen = np.full_like(fake_results().wear.thickness.arc, np.nan)
    assert (
        "No tooth thickness could be measured" in Reader(page(changed(fake_results(), "wear.thickness.arc", unseen), little)).text
    )


def test_nan_in_the_results_is_a_dash_on_the_page(little):
    arc = fake_results().wear.thickness.arc.copy()
    arc[3] = np.nan
    results = changed(fake_results(), "wear.thickness.arc", arc)
    for path in ("wear.found.volume_std", "measured.loop.held_out_after", "seen.base"):
        results = changed(results, path, float("nan"))
    assert "nan" not in Reader(page(results, little)).text.lower().split()


def test_what_is_spared_in_a_drawing_is_not_seen():
    """Corners are within a hundredth of a point of those that matplotlib writes, in both directions; pixels and words are its own."""
    shades = np.random.default_rng(1).integers(0, 200, (40, 30))
    figure = Figure()
    axis = figure.add_axes((0.1, 0.1, 0.8, 0.8))
    axis.plot(np.arange(50) * np.pi, np.sin(np.arange(50)), color="#123456")
    axis.imshow(shades, extent=(0.0, 157.0, -1.0, 1.0), aspect="auto", interpolation="none")
    axis.text(50.0, 0.0, "L 1.23456 2.34567")
    own = io.StringIO()
    with rc_context(figures.STYLE):
        figure.savefig(own, format="svg", transparent=True)
    written, spared = own.getvalue(), str(svg.svg(figure, "x", trim=False))
    assert len(spared) < 0.8 * len(written)
    assert "L 1.23456 2.34567" in spared

    def curve(text):
        return re.search(r'd="([^"]*)"[^>]*#123456', text)[1]

    exact = np.array(re.findall(r"[ML] (\S+) (\S+)", curve(written)), dtype=float)
    start, steps = curve(spared)[1:].split("l")
    corners = np.cumsum(np.array(f"{start} {steps}".split(), dtype=float).reshape(-1, 2), axis=0)
    np.testing.assert_allclose(corners, exact, atol=0.00501)
    one, other = (
        np.asarray(Image.open(io.BytesIO(base64.b64decode(re.search(r"base64,([^\"]*)", text)[1]))).convert("RGBA"))
        for text in (written, spared)
    )
    np.testing.assert_array_equal(one, other)


@pytest.mark.long
def test_the_same_input_gives_the_same_bytes(tmp_path, full):
    write_html(tmp_path / "report.html", view.view_of(fake_results(), fake_arrays(), FILES))
    assert (tmp_path / "report.html").read_text("utf-8") == full
