"""The pages: every command and snippet runs and prints what is shown, links and anchors lead somewhere, keys and thresholds are those of the program."""

from __future__ import annotations

import json
import pickle
import re
import tomllib
from collections.abc import Callable, Iterator
from dataclasses import fields
from hashlib import sha256
from pathlib import Path
from typing import Any

import pytest

import gearwear as gw
from benchmarks import sensitivity
from docs.run_blocks import PAGES, ROOT, Block, Runner, blocks, difference
from gearwear.comparison import closing, worn_pair
from gearwear.design import parse_design
from gearwear.design.files.toml import read_design
from gearwear.diagnose.rules import RULES
from gearwear.inspection import read_k_bands

DOCS = ROOT / "docs"
BLOCKS = {page: blocks(page) for page in PAGES}
RUN = {page: [b for b in found if b.language in ("sh", "python") or b.file] for page, found in BLOCKS.items()}
INSTALLS = re.compile(r"(python3 -m venv|\. |pip install|\S+/pip install|\S+/python -m pytest|mkdocs|git clone|cd )")
FREE = {"parameters", "rejected"}
"""Keys whose own keys are names from elsewhere: an effect's parameters, reasons to reject a point."""

NUMERICAL = {
    "PITCHES",
    "PARTS",
    "ALIKE",
    "BATCH",
    "BORDERS",
    "CELLS_PER_WAVE",
    "ENOUGH_CELLS",
    "LOOK_CELLS",
    "FEW",
    "FEWEST_FREE",
    "FEWEST_RINGS",
    "FEWEST_ROWS",
    "FORM_GROUP",
    "FRAMES",
    "HIGHEST_ORDER",
    "LEAST",
    "LEAST_ORDER",
    "LEAST_ROWS",
    "LEVEL_GROUP",
    "MANY",
    "MOST_CELLS",
    "MOST_ROUNDS",
    "NEIGHBOURS",
    "NONE",
    "NOTHING",
    "NO_EVIDENCE",
    "OF_MEAN",
    "ORDERS_OF_A_PART",
    "PASSES",
    "PLACES",
    "QUARTERS",
    "REFINED",
    "REMEMBERED",
    "SEEN",
    "SHELL",
    "SWEEPS",
    "VOXELS_PER_WAVE",
    "WAVES_PER_RADIUS",
    "REWEIGHTED",
    "RIDGE",
    "ROUGH_CELLS",
    "ROUGH_ROWS",
    "ROUNDS",
    "SETTLED",
    "SHOWN",
    "SMOOTH",
    "SMOOTHER",
    "SPANNED",
    "STEP",
    "STEPS",
    "STILL",
    "TOGETHER",
    "TRIED",
    "UPPER",
    "WIDER",
}
"""Constants of the diagnosis that are numerical, bound the work or, as in `correlations`, are for display: they decide on nothing."""


def remembering(function: Callable[..., Any]) -> Callable[..., Any]:
    """The function, which works out once what it is asked again with equal arguments."""
    results: dict[bytes, Any] = {}

    def remembered(*arguments: Any, **named: Any) -> Any:
        key = sha256(pickle.dumps((arguments, named))).digest()
        if key not in results:
            results[key] = function(*arguments, **named)
        return results[key]

    return remembered


@pytest.fixture(scope="module")
def runner(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Runner]:
    """A folder that looks like a fresh clone, with the reader's scan in it. Many pages compare the same two scans: what takes longest of that, the
    loop and the contact with the mate, is done once."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(closing, "close_loop", remembering(closing.close_loop))
        patch.setattr(worn_pair, "mesh_contact", remembering(worn_pair.mesh_contact))
        yield Runner(tmp_path_factory.mktemp("clone"))


@pytest.mark.usefixtures("blank_figures")
@pytest.mark.long
@pytest.mark.parametrize("page", [page for page, found in RUN.items() if found], ids=lambda page: page.name)
def test_commands_and_snippets_print_what_is_shown(page, runner):
    for block in RUN[page]:
        if block.not_run:
            assert_has_a_reason(block)
            continue
        printed = runner.run(block)
        if block.output is not None:
            told = difference(block.output.text, printed)
            assert not told, f"{block.output.place}: {told}; python docs/run_blocks.py --write renews the pages"


def assert_has_a_reason(block: Block):
    """What is not run is an installation, or has its options in the test file that the reason names."""
    assert block.output is None, f"{block.place}: what is not run shows no output"
    named = re.search(r"tests/[\w/]+\.py", block.not_run)
    tested = (ROOT / named[0]).read_text(encoding="utf-8") if named else ""
    for command in block.commands:
        options = re.findall(r"--[a-z-]+", command)
        if not (options and all(f'"{option}"' in tested for option in options)):
            assert all(INSTALLS.match(part) for part in command.split(" && ")), f"{block.place}: {command} could be run"


def test_every_output_stands_behind_what_printed_it():
    """A text block of its own is a diagram: it holds no result."""
    for page, found in BLOCKS.items():
        for block in found:
            assert block.language != "text" or "─►" in block.text, f"{page.name}:{block.line}"


@pytest.mark.parametrize(("shown", "printed", "same"), [
    ("33.7 ± 0.2 mm³\nof metal", "33.7 ± 0.2\nmm³ of metal\n", True),
    ("33.7 ± 0.2", "33.6 ± 0.3", True),
    ("33.7 ± 0.2", "35.7 ± 0.2", False),
    ("tooth 2", "tooth 3", False),
    ("is gone", "was gone", False),
    ("one\n…\nfour", "one two three four five", True),
    ("one\n…\nfour", "four one", False),
    ("one", "one two", False),
    ("", "one", False),
])  # fmt: skip
def test_outputs_are_compared_by_words_and_numbers(shown, printed, same):
    assert (difference(shown, printed) == "") is same


EXAMPLE_GEAR = {"teeth": 24, "module": 5.0, "face_width": 40.0}


def test_designs_on_the_pages_are_legal(tmp_path):
    for page, found in BLOCKS.items():
        for block in found:
            if block.language == "toml":
                table = tomllib.loads(block.text)
                if table.keys() <= {"profile", "helix"}:  # the K bands of a drawing
                    (tmp_path / "k-chart.toml").write_text(block.text, encoding="utf-8")
                    assert read_k_bands(tmp_path / "k-chart.toml", read_design(gw.example()).gears["pinion"]).profile
                else:
                    # what stands beside the gear may be shown by itself
                    table = table if table.keys() & {"pinion", "gear"} else {"gear": EXAMPLE_GEAR, **table}
                    assert parse_design(table).gears, f"{page.name}:{block.line}"


def anchors(page: Path) -> set[str]:
    """Anchors of a page's headings, as mkdocs and GitHub make them of plain words."""
    titles = re.findall(r"^#+ (.+)$", re.sub(r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.M | re.S), flags=re.M)
    return {re.sub(r"[-\s]+", "-", re.sub(r"[^\w\s-]", "", title).strip().lower()) for title in titles}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_to_a_heading_find_it(page):
    for target, anchor in re.findall(r"\]\(([^)#:]*)#([^)]+)\)", page.read_text(encoding="utf-8")):
        assert anchor in anchors(page.parent / target if target else page), f"{target}#{anchor}"


def test_links_of_the_pages_stay_among_them():
    """So that the built site has no dead ends."""
    for page in DOCS.glob("*.md"):
        for target in re.findall(r"\]\(([^)#:]+)", page.read_text(encoding="utf-8")):
            assert (page.parent / target).resolve().is_relative_to(DOCS), f"{page.name}: {target}"


def test_every_page_is_in_the_contents():
    contents = (ROOT / "mkdocs.yml").read_text(encoding="utf-8")
    assert sorted(re.findall(r": (\S+\.md)$", contents, flags=re.M)) == sorted(page.name for page in DOCS.glob("*.md"))


def test_the_site_builds_without_a_warning_and_loads_nothing_from_elsewhere(tmp_path):
    pytest.importorskip("mkdocs", reason="needs the extra docs")
    from mkdocs.commands.build import build
    from mkdocs.config import load_config

    build(load_config(str(ROOT / "mkdocs.yml"), site_dir=str(tmp_path), strict=True))
    for page in tmp_path.glob("*.html"):
        assert not re.findall(r'(?:src|<link[^>]*href)="(?:https?:)?//[^"]+', page.read_text(encoding="utf-8")), page.name


def test_pictures_are_small_and_shown():
    text = "".join(page.read_text(encoding="utf-8") for page in PAGES)
    for picture in (DOCS / "pictures").iterdir():
        assert picture.stat().st_size < 200_000
        assert f"pictures/{picture.name})" in text, picture.name


def keys(value: object) -> set[str]:
    """All keys of an object, at any depth."""
    if isinstance(value, dict):
        return set(value) | {key for name, item in value.items() if name not in FREE for key in keys(item)}
    return {key for item in value for key in keys(item)} if isinstance(value, list) else set()


@pytest.mark.usefixtures("blank_figures")
@pytest.mark.long
def test_every_key_of_the_report_is_described(runner):
    report = example(runner)
    page = (DOCS / "report.md").read_text(encoding="utf-8")
    everywhere = set(re.findall(r"\w+", " ".join(re.findall(r"`([^`]+)`|\"(\w+)\"", page.split("\n## `", 1)[0])[0])))
    everywhere |= {"value", "std", "unit", "expanded"}
    for name, value in report.items():
        heading = re.search(rf"^## .*`{name}`.*$", page, flags=re.M)
        assert heading, name
        section = page[heading.end() :].split("\n## ", 1)[0]
        named = set(re.findall(r"\w+", " ".join(re.findall(r"`([^`]+)`", section))))
        named |= {f"{key}{suffix}" for key in named for suffix in ("_min", "_std", "_min_std")}
        assert keys(value) <= named | everywhere, sorted(keys(value) - named - everywhere)


def test_the_page_of_rules_is_that_of_the_code_and_the_study():
    measured = json.loads(sensitivity.STUDY.read_text(encoding="utf-8"))
    assert set(measured) == {one.name for one in fields(RULES)}
    assert sensitivity.PAGE.read_text(encoding="utf-8") == sensitivity.page(measured)


@pytest.mark.parametrize("module", sorted(path.stem for path in (ROOT / "gearwear" / "diagnose").glob("*.py")))
def test_the_diagnosis_keeps_its_thresholds_in_one_place(module):
    source = (ROOT / "gearwear" / "diagnose" / f"{module}.py").read_text(encoding="utf-8")
    assert set(re.findall(r"^([A-Z_]+)(?:, [A-Z_]+)* = [-\d.(]", source, flags=re.M)) <= NUMERICAL


def numbers_reached() -> str:
    return (ROOT / "README.md").read_text(encoding="utf-8").split("\n## Numbers reached\n", 1)[1].split("\n## ", 1)[0]


def test_numbers_reached_are_those_of_the_study():
    study = (DOCS / "study.md").read_text(encoding="utf-8")
    shown = re.findall(r"[\d.]+ % \(\d+ of \d+", numbers_reached())
    assert len(shown) == 8
    assert all(number in study for number in shown)


@pytest.mark.long
@pytest.mark.usefixtures("blank_figures")
def test_numbers_reached_are_those_of_the_example(runner):
    report = example(runner)
    wear, loop = report["wear"], report["closed_loop"]
    said = (
        f"{wear['volume_mm3']['value']:.1f} ± {wear['volume_mm3']['std']:.1f} mm³; without the closed loop"
        f" {wear['before_loop']['volume_mm3']['value']:.1f} mm³ noise {loop['noise_um']:.1f} µm"
        f" {loop['before']['rms_um']:.1f} → {loop['after']['rms_um']:.1f} µm;"
        f" {loop['before']['heldout_rms_um']:.1f} → {loop['after']['heldout_rms_um']:.1f} µm"
    )
    pattern = r"[\d.]+ ± [\d.]+ mm³; without the closed loop [\d.]+ mm³|noise [\d.]+ µm|[\d.]+ → [\d.]+ µm;?"
    assert not difference(" ".join(re.findall(pattern, numbers_reached())), said)


def example(runner: Runner) -> dict[str, Any]:
    """The bundled example's report."""
    runner.run(Block(DOCS / "report.md", 0, "sh", "gearwear compare"))
    return json.loads((runner.folder / "gearwear-out" / "report.json").read_text(encoding="utf-8"))
