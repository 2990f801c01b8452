"""Fixtures every room's tests share."""

from __future__ import annotations

import gc
import os
import sys
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # as the commands do, before numpy: sums in one order, the same bytes
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)  # the workers and some sixty commands would each compile all of the package

import pytest
from hypothesis import settings

from gearwear.design.gear import Gear
from gearwear.design.spec import GearSpec

sys.dont_write_bytecode = False  # the same for this process, and the assertions of the tests

settings.register_profile("alike", derandomize=True)  # the same examples in every run: what passes here passes there
settings.load_profile("alike")

TESTS = Path(__file__).resolve().parent
SHARED = TESTS.parents[1] / "shared"
LONGEST = (
    "test_docs.py",
    "brep/test_ends.py",
    "identify/test_kinds.py",
    "wear/test_volume.py",
    "comparison/test_compare.py",
    "comparison/test_helical_running.py",
    "running/test_search.py",
    "diagnose/core/test_worn_sides.py",
    "commands/test_another_pose.py",
    "commands/test_inspect_command.py",
    "commands/test_hostile.py",
    "commands/test_degenerate.py",
    "comparison/test_drawings.py",
    "comparison/test_dimensions_off.py",
    "comparison/test_ring.py",
    "running/test_helical_gears.py",
    "identify/test_survey.py",
    "diagnose/core/test_pooled.py",
    "commands/test_bad_input.py",
    "meshing/test_contact.py",
    "meshing/test_contact_of_scans.py",
    "placing/test_surroundings.py",
    "placing/test_registration.py",
    "comparison/test_consequences.py",
    "commands/test_degenerate_kinds.py",
    "test_api.py",
    "wear_law/test_rings_and_doubles.py",
    "wear_law/test_wear_study.py",
    "wear/test_regions.py",
    "fleet/test_cluster.py",
    "report/test_page.py",
    "report/test_browser.py",
    "report/test_publishing.py",
    "report/test_pdf.py",
    "report/test_viewer.py",
    "test_cad_scripts.py",
)
"""Files of more than some 10 s, the long tests too, longest first: begun last, one of them would keep a processor busy while the others have no work left."""


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Begin with the longest files."""
    rank = {TESTS / name: place for place, name in enumerate(LONGEST)}
    lost = [str(path) for path in rank if not path.exists()]
    assert not lost, f"LONGEST of tests/conftest.py names files that are not there: {lost}"
    items.sort(key=lambda item: rank.get(item.path, len(rank)))


def pytest_collection_finish() -> None:
    """What is there by now stays: the collector of cycles, which took a tenth of the time, looks at what tests make alone, and seldom."""
    gc.freeze()
    gc.set_threshold(50_000, 20, 20)


@pytest.fixture(scope="session")
def pinion() -> Gear:
    """The paper's pinion: z = 12, module 6.35, 20°, face 15, rack tip radius 0.25 m (the reference's)."""
    return Gear.from_spec(GearSpec("pinion", 12, 6.35, 15.0, rack_tip_radius=0.25))


@pytest.fixture(scope="session")
def wheel() -> Gear:
    """Its mate: z = 24."""
    return Gear.from_spec(GearSpec("gear", 24, 6.35, 15.0, rack_tip_radius=0.25))


@pytest.fixture
def blank_figures(monkeypatch: pytest.MonkeyPatch) -> None:
    """Pictures come out as blank sheets: for tests of words, numbers and files, as drawing takes longer than what they look at."""
    monkeypatch.setattr("matplotlib.figure.Figure.draw", lambda figure, renderer: None)


@pytest.fixture(scope="session")
def shared() -> Path:
    """The folder with practice scans, or a skip."""
    if not (SHARED / "scans").is_dir():
        pytest.skip("the practice scans are not beside this checkout")
    return SHARED
