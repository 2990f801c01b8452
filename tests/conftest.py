"""Fixtures every room's tests share."""

from __future__ import annotations

import gc
import os
import sys
from collections.abc import Generator
from pathlib import Path
from typing import Any

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # as the commands do, before numpy: sums in one order, the same bytes
if "PYTEST_XDIST_WORKER" in os.environ:
    os.environ.setdefault("GEARWEAR_THREADS", "1")  # a worker has one processor
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)  # the workers and some sixty commands would each compile all of the package

import pytest
from _pytest.doctest import DoctestModule
from hypothesis import HealthCheck, settings

from gearwear.design.gear import Gear
from gearwear.design.spec import GearSpec

gc.disable()  # until all tests are known: what is imported stays
sys.dont_write_bytecode = False  # the same for this process, and the assertions of the tests

# The same examples in every run: what passes here passes there, and a busy machine is no failure.
settings.register_profile("alike", derandomize=True, deadline=None, suppress_health_check=[HealthCheck.too_slow])
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


TOGETHER = (
    {
        "test_api.py", "comparison/test_accord.py", "comparison/test_measured_thinning.py", "comparison/test_views.py",
        "diagnose/core/test_smoothing.py", "report/test_figures.py", "report/test_formats.py", "report/test_loaded_words.py",
        "report/test_page.py", "report/test_publishing.py", "report/test_schema.py", "report/test_summary.py",
        "report/test_surfaces.py", "report/test_wear_law_words.py", "report/test_words.py",
    },
    {
        "running/test_as_drawn.py", "running/test_forecast.py", "running/test_other_side.py", "running/test_search.py", "running/test_stated.py",
        "running/test_thresholds.py",
    },
    {"test_layers.py", "test_docstrings.py", "diagnose/test_one_place.py"},
)  # fmt: skip
"""Files that look at one costly result, the comparison of `tests.report.fake`, the runs of `tests.running.maps` or the package parsed: for one worker, which makes it once."""


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> Any:
    """As `--dist loadfile`, with the files of `TOGETHER` as one."""
    from xdist.scheduler import LoadFileScheduling

    if config.getvalue("dist") != "loadfile":
        return None
    place = {f"tests/{name}": str(number) for number, names in enumerate(TOGETHER) for name in names}
    lost = [name for name in place if not (TESTS.parent / name).exists()]
    assert not lost, f"TOGETHER of tests/conftest.py names files that are not there: {lost}"

    class TogetherScheduling(LoadFileScheduling):
        def _split_scope(self, nodeid: str) -> str:
            file: str = super()._split_scope(nodeid)
            return place.get(file, file)

    return TogetherScheduling(config, log)


@pytest.hookimpl(wrapper=True)
def pytest_collect_file() -> Generator[None, list[pytest.Collector], list[pytest.Collector]]:
    """Doctests are those of the package: to look for one in every name that a test file holds took every worker a second."""
    return [one for one in (yield) if not isinstance(one, DoctestModule)]


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Begin with the longest files."""
    rank = {TESTS / name: place for place, name in enumerate(LONGEST)}
    lost = [str(path) for path in rank if not path.exists()]
    assert not lost, f"LONGEST of tests/conftest.py names files that are not there: {lost}"
    items.sort(key=lambda item: rank.get(item.path, len(rank)))


def pytest_collection_finish() -> None:
    """What is there by now stays: the collector of cycles, which took a tenth of the time, looks at what tests make alone, and seldom."""
    gc.freeze()
    gc.enable()
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
