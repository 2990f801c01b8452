"""The page: well-formed, on its own, complete, and safe against what users write."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from html.parser import HTMLParser

import pytest

from gearwear.report.page import parts
from gearwear.report.page.html import CONTENTS, page, write_html
from tests.report.fake import bare_report, fake_arrays, fake_report

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
    return page(fake_report(), fake_arrays())


@pytest.fixture
def little(monkeypatch):
    """Arrays without anything that may be missing, and nothing rendered: for tests of the words."""
    monkeypatch.setattr(parts, "svg", lambda figure, ident, trim=True: "<svg></svg>")
    nothing = dict.fromkeys(("residual_before_um", "residual_after_um", "elsewhere", "meshing", "contact_share"))
    return replace(fake_arrays(columns=12, planar=True), **nothing)


@pytest.fixture(scope="module")
def bare():
    return page(bare_report(), fake_arrays(planar=True, worn=False))


def test_the_page_is_well_formed_and_below_15_mb(full, bare):
    for text in (full, bare):
        reader = Reader(text)
        assert text.startswith("<!DOCTYPE html>")
        idents = [attributes["id"] for _, attributes in reader.tags if "id" in attributes]
        assert len(idents) == len(set(idents))
        targets = {attributes["href"][1:] for tag, attributes in reader.tags if tag == "a"}
        assert targets <= set(idents)
    assert len(full.encode()) < 15e6
    assert len(bare.encode()) < 1e6, "a planar section needs no 3-D library"


def test_a_gear_of_many_teeth_and_fine_maps_stays_below_15_mb():
    text = page(fake_report(), fake_arrays(60, columns=60, rows=80))
    assert len(text.encode()) < 15e6


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


def test_all_sections_are_there_in_order(full):
    idents = [attributes.get("id") for tag, attributes in Reader(full).tags if tag == "section"]
    assert idents == [ident for ident, _ in CONTENTS]


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
    hostile = fake_report()
    nasty = "</script><script>alert(1)</script>"
    for part in (hostile["design"], hostile["scan"]):
        part["part"] = part["kind"] = nasty
    hostile["warnings"] = [nasty]
    hostile["files"] = [nasty]
    hostile["closed_loop"]["effects"][0]["name"] = nasty
    hostile["closed_loop"]["unexplained"] = {"found": True, "rms_um": 1.0, "pattern": nasty}
    hostile["closed_loop"]["changes"]["worn_volume_mm3"]["causes"][0]["name"] = nasty
    hostile["registration"]["datum"] = [nasty]
    text = page(hostile, fake_arrays(columns=8, rows=4))
    assert "<script>alert" not in text
    assert sum(tag == "script" for tag, _ in Reader(text).tags) == 3


def test_what_the_effects_would_have_cost_stands_at_the_loop(little):
    def rows(report):
        words = Reader(page(report, little)).text
        return (
            words.split("Closed loop: what else is in the scan", 1)[1].split("Tooth thickness", 1)[0]
            if "owing to" in words
            else ""
        )

    report = fake_report()
    report["closed_loop"]["changes"]["deepest_wear_um"]["matters"] = False
    shown = rows(report)
    for row in (
        "worn volume, mm³ coating 83.1 90.8 7.7\u202f±\u202f0.8 0.0",
        "deepest wear, µm no change to be seen 1\u202f531.2 1\u202f550.0 19\u202f±\u202f7 0.0",
        "backlash, greatest, mm coating 1.6033 1.6459 0.0426\u202f±\u202f0.0006 0.2286",
        "transmission error, peak to peak, µm turntable angle 1\u202f562.1 1\u202f549.2 −12.9\u202f±\u202f1.2 –",
    ):
        assert row.replace("\u202f", " ") in shown.replace("\u202f", " "), row
    assert rows(bare_report()) == ""


def test_the_scene_is_json_without_nan(full):
    packed = re.search(r'<script type="application/json" id="scene">(.*?)</script>', full, re.S)[1]
    scene = json.loads(packed, parse_constant=pytest.fail)
    assert {"data", "layout", "groups"} == set(scene)


def test_missing_parts_are_said_to_be_missing(bare):
    text = Reader(bare).text
    for sentence in (
        "No wear was found",
        "No region of wear stands out",
        "A planar section gives areas",
        "No effect of measurement or manufacture was looked for",
        "No tooth thickness could be measured",
        "names one gear and no mate",
    ):
        assert sentence in text
    assert "nan" not in text.lower().split()
    assert "None" not in text.replace("None.", "")


@pytest.mark.parametrize("key", sorted(fake_report()))
def test_a_report_without_any_one_part_still_makes_a_page(key, little):
    report = fake_report()
    del report[key]
    Reader(page(report, little))


def test_arrays_that_are_not_there_are_left_out(little):
    text = Reader(page(fake_report(), little)).text
    assert "No curves over the revolution" in text
    assert "Residual before" not in text
    assert "Contact pattern" not in text


def test_nan_in_the_report_is_a_dash_on_the_page(little):
    report = fake_report()
    report["wear"]["volume_mm3"]["std"] = float("nan")
    report["thickness"][3]["mean_mm"] = float("nan")
    report["closed_loop"]["after"]["heldout_rms_um"] = float("nan")
    assert "nan" not in Reader(page(report, little)).text.lower().split()


def test_the_same_input_gives_the_same_bytes(tmp_path, full):
    write_html(tmp_path / "report.html", fake_report(), fake_arrays())
    assert (tmp_path / "report.html").read_text("utf-8") == full
