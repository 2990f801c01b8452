"""`report.pdf`: text that can be selected, every page with its number, charts as lines, numbers those of `report.json`."""

from __future__ import annotations

import json
import re
from dataclasses import replace

import pytest
from pypdf import PdfReader

from gearwear.design.report_details import ReportDetails
from gearwear.report.page.blocks import Picture, Section
from gearwear.report.page.inspection_view import inspection_view
from gearwear.report.page.view import view_of
from gearwear.report.pdf import SHEET_LINE, Charts, Room, write_pdf
from gearwear.report.records.comparison import document
from gearwear.report.write import write_results
from tests.report.fake import bare_results, changed, fake_arrays, fake_results, real_results

pytestmark = pytest.mark.long

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


def test_there_is_a_line_to_sign_on_behind_the_text_and_before_the_charts(pages):
    """The report is "to be signed and sent", and had no place for it."""
    words = [re.sub(r"\s+", " ", page.extract_text()) for page in pages]
    (signed,) = [i for i, text in enumerate(words) if "date name signature" in text]
    assert next(i for i, text in enumerate(words) if "Files written" in text) == signed
    assert all("ISO 1328" in text for text in words[signed + 1 :])


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


@pytest.mark.usefixtures("blank_figures")
def test_without_a_page_and_with_a_pdf(tmp_path):
    files = write_results(real_results(), tmp_path / "out", page=False, pdf=True, command="gearwear compare d.toml")
    assert sorted(files) == sorted(path.name for path in (tmp_path / "out").iterdir())
    assert "report.pdf" in files and "report.html" not in files
    report = json.loads((tmp_path / "out" / "report.json").read_text("utf-8"))
    assert report["command"] == "gearwear compare d.toml" and report["files"] == files


def placed(page):
    """How the forms of a page are laid: (scale, left, lower edge)."""
    data = page.get_contents().get_data().decode("latin1")
    return [tuple(map(float, one)) for one in re.findall(r"q ([\d.]+) 0 0 [\d.]+ (-?[\d.]+) (-?[\d.]+) cm /Chart\d+ Do", data)]


def test_a_chart_with_a_magnification_is_on_paper_at_its_true_size(pages):
    sheets = [page for page in pages if "magnification" in page.extract_text()]
    assert len(sheets) >= 2
    for page in sheets:
        assert placed(page) == [(1.0, 0.0, pytest.approx(0.0, abs=0.01))]


def test_the_line_of_a_sheet_is_clear_of_its_words(written):
    sheets = [
        block.figure()
        for section in written[1].sections
        for block in section.blocks
        if isinstance(block, Picture) and not block.trim
    ]
    assert len(sheets) >= 3
    for figure in sheets:
        page, points = figure.axes[0], 72.0 / figure.dpi
        highest = max(text.get_window_extent().y1 for text in page.texts) * points
        below = figure.get_figheight() * 72.0 - highest
        assert below > SHEET_LINE + 0.24 * 7.0, "7 point DejaVu goes 0.24 of its size below its line"
    assert SHEET_LINE > 7.0


def test_text_goes_on_without_gaps_and_sheets_are_last(pages):
    is_sheet = ["page" in page.extract_text() and placed(page)[:1] == [(1.0, 0.0, 0.0)] for page in pages]
    assert any(is_sheet) and is_sheet == sorted(is_sheet)


def drawn(figures, tmp_path, **more):
    view = view_of(bare_results(), fake_arrays(columns=12, planar=True, worn=False))
    section = Section("s", "s", "s", [Picture(lambda: figures[0], "s", "A chart", "What is seen.", **more)])
    write_pdf(tmp_path / "report.pdf", replace(view, sections=[section]))
    return PdfReader(tmp_path / "report.pdf").pages


def test_a_chart_larger_than_paper_is_drawn_in_sheets_or_says_that_it_was_made_smaller(tmp_path):
    from matplotlib.figure import Figure

    long, sheets = Figure((297.0 / 25.4, 630.0 / 25.4)), [Figure((297.0 / 25.4, 210.0 / 25.4)) for _ in range(3)]
    in_sheets = drawn([long], tmp_path, trim=False, sheets=lambda: sheets)
    assert [placed(page) for page in in_sheets[-3:]] == [[(1.0, 0.0, pytest.approx(0.0, abs=0.01))]] * 3
    shrunk = drawn([long], tmp_path, trim=False)[-1]
    assert placed(shrunk)[0][0] == pytest.approx(1.0 / 3.0, abs=1e-4)
    assert "printed at 33 % of the size" in shrunk.extract_text()
    assert "printed at" not in in_sheets[-1].extract_text()


def test_a_chart_is_made_a_little_smaller_to_stand_on_the_page_begun():
    from matplotlib.figure import Figure

    room = Room(Picture(lambda: Figure((8.0, 4.0)), "s", "A chart", "What is seen.", trim=False), Charts(), 800.0, 500.0)
    _, natural = room.wrap(800.0, 500.0)
    below = natural - 4.0 * 72.0
    assert room.scale == 1.0
    _, height = room.wrap(800.0, 0.8 * 4.0 * 72.0 + below)
    assert room.scale == pytest.approx(0.8) and height <= 0.8 * 4.0 * 72.0 + below + 1e-9
    assert room.wrap(800.0, 0.5 * 4.0 * 72.0 + below)[1] == natural, "its type would be too small: the next page"


def test_the_traces_of_many_teeth_are_sheets_of_paper_that_show_every_tooth_once(monkeypatch):
    from gearwear.report.charts import traces
    from gearwear.report.page.pictures import inspection_charts

    monkeypatch.setattr(traces, "PER_ROW", 5)
    profile = next(chart for chart in inspection_charts(real_results().inspection) if chart.title == "Profile chart")
    sheets = list(profile.sheets())
    assert len(sheets) == 3
    common, teeth = magnification(profile.figure()), []
    for figure in sheets:
        assert figure.get_size_inches() * 25.4 == pytest.approx([297.0, 210.0])
        assert magnification(figure) == common
        words = figure.axes[0].texts
        row = max(word.get_position()[1] for word in words if word.get_text() == "mean")
        teeth += sorted({int(word.get_text()) for word in words if word.get_position()[1] == row and word.get_text().isdigit()})
    assert teeth == list(range(1, 13))


def magnification(figure):
    (words,) = {text.get_text() for text in figure.axes[0].texts if text.get_text().startswith("magnification")}
    return words.partition(" across")[0]
