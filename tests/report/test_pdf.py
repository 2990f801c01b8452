"""`report.pdf`: text that can be selected, every page with its number, charts as lines, numbers those of `report.json`."""

from __future__ import annotations

import json
import re
from dataclasses import replace

import pytest
from pypdf import PdfReader

from gearwear.design.report_details import ReportDetails
from gearwear.report.page.inspection_view import inspection_view
from gearwear.report.page.view import view_of
from gearwear.report.pdf import write_pdf
from gearwear.report.records.comparison import document
from gearwear.report.write import write_results
from tests.report.fake import bare_results, changed, fake_arrays, fake_results, real_results

NASTY = "</font><b>&\"'<script>alert(1)</script>"
DETAILS = ReportDetails(part_number=NASTY, serial="S 12", customer="Söhne", remarks="first\nsecond <i>")


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    results = changed(fake_results(), "measured.design", replace(fake_results().design, report=DETAILS))
    results = changed(results, "inspection", real_results().inspection)
    arrays = replace(fake_arrays(columns=16, rows=8), inspection=results.inspection)
    file = tmp_path_factory.mktemp("pdf") / "report.pdf"
    view = view_of(results, arrays, ["report.json"], "gearwear compare 'a b.toml' scan.ply")
    write_pdf(file, view)
    return results, view, file


@pytest.fixture(scope="module")
def pages(written):
    return PdfReader(written[2]).pages


@pytest.fixture(scope="module")
def text(pages):
    return re.sub(r"\s+", " ", " ".join(page.extract_text() for page in pages))


def test_every_page_has_its_number_and_says_of_what(pages):
    assert len(pages) > 5
    for number, page in enumerate(pages, 1):
        words = page.extract_text()
        assert f"page {number} of {len(pages)}" in words
        assert "S 12" in words


def test_pages_are_a4_and_none_is_empty(pages):
    for page in pages:
        assert (float(page.mediabox.width), float(page.mediabox.height)) == pytest.approx((841.9, 595.3), abs=0.1)
        assert len(page.extract_text()) > 100


def test_the_numbers_are_those_of_report_json(written, text):
    report = document(written[0])
    wear = report["wear"]
    assert f"{wear['volume_mm3']['value']:.2f} ± {wear['volume_mm3']['std']:.2f}" in text
    for region in wear["regions"]:
        assert f"{region['max_depth_um']:,.0f}".replace(",", " ") in text
    for tooth in report["thickness"]:
        assert f"{tooth['mean_mm']:.3f}" in text and f"{tooth['min_mm']:.3f}" in text
    for finding in report["inspection"]["findings"]:
        if finding["value_um"] is not None:
            assert f"{finding['value_um']:.1f}".replace("-", "−") in text
    for digest in [report["design"]["sha256"], *report["scan"]["sha256"]]:
        assert digest in text.replace(" ", "")
    assert report["version"] in text


def test_what_users_write_is_text(text):
    squeezed = text.replace(" ", "")
    assert NASTY.replace(" ", "") in squeezed and "second<i>" in squeezed
    assert "gearwearcompare'ab.toml'scan.ply" in squeezed


def test_charts_are_lines_and_their_type_is_type(pages, text):
    assert "roll length" in text and "transmission error" in text
    forms = {
        name: form.get_object()
        for page in pages
        for name, form in page["/Resources"].get("/XObject", {}).items()
        if "Chart" in name
    }
    assert sum(form.get_data().count(b" l\n") for form in forms.values()) > 2000, "curves are paths"
    inner = {ref.idnum: ref.get_object() for form in forms.values() for ref in form["/Resources"]["/XObject"].values()}
    assert 0 < sum(one.get("/Subtype") == "/Image" for one in inner.values()) < 12, "maps and colour bars alone are pixels"


def test_the_same_view_gives_the_same_bytes(written, tmp_path):
    results, _, file = written
    arrays = replace(fake_arrays(columns=16, rows=8), inspection=results.inspection)
    write_pdf(tmp_path / "again.pdf", view_of(results, arrays, ["report.json"], "gearwear compare 'a b.toml' scan.ply"))
    assert (tmp_path / "again.pdf").read_bytes() == file.read_bytes()


def test_a_planar_section_has_a_report_too(tmp_path):
    write_pdf(tmp_path / "report.pdf", view_of(bare_results(), fake_arrays(columns=12, planar=True, worn=False)))
    assert "A planar section gives areas" in re.sub(
        r"\s+", " ", " ".join(page.extract_text() for page in PdfReader(tmp_path / "report.pdf").pages)
    )


def test_an_inspection_has_a_report_too(tmp_path):
    results = real_results()
    found = results.inspection
    view = inspection_view(
        results.design, results.measured.scans, found, "a pinion", ["a doubt"], ["tooth thickness 1"], ["inspection.json"]
    )
    write_pdf(tmp_path / "report.pdf", view)
    words = re.sub(r"\s+", " ", " ".join(page.extract_text() for page in PdfReader(tmp_path / "report.pdf").pages))
    for finding in found.findings:
        assert f"{1e3 * finding.value:.1f}".replace("-", "−") in words
    assert "Gear inspection report" in words and "A doubt." in words and results.design.sha256 in words.replace(" ", "")


def test_without_a_page_and_with_a_pdf(tmp_path):
    files = write_results(real_results(), tmp_path / "out", page=False, pdf=True, command="gearwear compare d.toml")
    assert sorted(files) == sorted(path.name for path in (tmp_path / "out").iterdir())
    assert "report.pdf" in files and "report.html" not in files
    report = json.loads((tmp_path / "out" / "report.json").read_text("utf-8"))
    assert report["command"] == "gearwear compare d.toml" and report["files"] == files
