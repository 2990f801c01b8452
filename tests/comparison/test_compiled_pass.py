"""A compiled pass over a streamed scan adds up what numpy does, point by point or in chunks."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from dataclasses import fields, replace

import numpy as np
import pytest

from gearwear import compiled
from gearwear.arrays import Floats
from gearwear.comparison.closing import measure
from gearwear.comparison.collecting import Collection, Cut, collected
from gearwear.comparison.on_design import OnDesign
from gearwear.comparison.pass_limits import PassLimits, grid_of_sample
from gearwear.design.files.toml import read_design
from gearwear.design.gear import Gear
from gearwear.design.surface import Bands, locate
from gearwear.placing.cells import CellGrid
from gearwear.placing.pits import hanging_together
from gearwear.placing.pose import small_motion
from gearwear.placing.sums import CellSums
from gearwear.scan import streaming
from gearwear.wear.section_sums import SectionBand
from tests.commands.doors import ONE, thinner_example
from tests.design.test_compiled import EVERY

pytestmark = pytest.mark.long

pytest.importorskip("numba")

KINDS = ("paper_pinion_030", "right 15", "double", "everything, helical", "ring, left 20")
MOTION = small_motion(np.array([0.002, -0.001, 0.003, 1e-5, -2e-5, 3e-5]))


def scan_of(gear: Gear, count: int = 40_000) -> Floats:
    """Points on and round a gear, mostly on its surfaces, with a few strays."""
    rng = np.random.default_rng(8)
    inner, outer = sorted((gear.root_radius, gear.tip_radius))
    radius = rng.uniform(inner, outer, 3 * count)
    angle, z = rng.uniform(-np.pi, np.pi, 3 * count), rng.uniform(0.0, gear.face_width, 3 * count)
    points = np.column_stack([radius * np.cos(angle), radius * np.sin(angle), z])
    located = locate(points, gear)
    on = np.flatnonzero(np.isfinite(located.deviation))[:count]
    off = 0.01 * rng.standard_normal(len(on)) + 0.2 * (rng.random(len(on)) < 0.005) * rng.choice([-1, 1], len(on))
    return located.position[on] + off[:, None] * located.normal[on]


@pytest.fixture
def both(monkeypatch: pytest.MonkeyPatch):
    """A pass by numpy, and compiled; the points come in three chunks."""

    def through(points: Floats, put: OnDesign, grid: CellGrid, by: PassLimits, cut: Cut) -> Iterator[Collection]:
        for least in (sys.maxsize, 0):
            monkeypatch.setattr(compiled, "LEAST", least)
            yield collected(np.array_split(points, 3), put, grid, by, cut)

    return through


@pytest.mark.parametrize("kind", KINDS)
def test_the_sums_are_the_same(kind, both):
    gear = EVERY[kind]
    points = scan_of(gear)
    put = OnDesign(gear, Bands.wide(gear), 0.01, -0.1, MOTION)  # low tips: some points of flanks are left out
    sample, grid = put.located(points), CellGrid.for_scan(gear, len(points))
    by = PassLimits.of_sample(sample, grid, 0.05)
    cut = Cut(SectionBand.of(gear), lambda part: part.deviation - 0.001 * part.own_height)

    reference, fast = both(points, put, grid, by, cut)
    assert_same(fast, reference)
    assert reference.other > 10 and len(reference.far.off) > 0 and reference.sections.moments[0].sum() > 500


def test_a_coarser_grid_and_pits_tell_strays_alike(both):
    gear = EVERY["paper_pinion_030"]
    points = scan_of(gear, 60_000)
    put = OnDesign(gear, Bands.wide(gear), 0.01, 0.0)
    grid = CellGrid.for_scan(gear, 4 * len(points))
    sample = put.located(points[::4])
    by = PassLimits.of_sample(sample, grid, 0.05)
    assert grid_of_sample(sample, grid) is not grid and by.grid is not grid
    pits = hanging_together(by.reach.tally(sample, grid.index(sample)), by.reach)
    deepest = np.zeros_like(pits.deepest)
    deepest[3:9] = 0.25
    centre = np.where(np.isfinite(pits.centre), pits.centre, 0.0)
    held = replace(by, pits=replace(pits, deepest=deepest, centre=centre))
    cut = Cut(SectionBand.of(gear))

    without, _ = both(points, put, grid, by, cut)
    reference, fast = both(points, put, grid, held, cut)
    assert_same(fast, reference)
    assert reference.sums.count.sum() > without.sums.count.sum() + 20  # what lies as deep as pits is kept


def assert_same(fast: Collection, reference: Collection) -> None:
    assert (fast.located, fast.other) == (reference.located, reference.other)
    for field in fields(CellSums):
        a, b = getattr(fast.sums, field.name), getattr(reference.sums, field.name)
        if field.name == "count":
            np.testing.assert_array_equal(a, b)
        else:  # points of a motion a rounding apart; a cell of some hundred points, with lever arms of a hundred mm
            np.testing.assert_allclose(a, b, rtol=1e-12, atol=1e-10 if field.name == "lever" else 1e-11, err_msg=field.name)
    for name in ("number", "below", "above", "cell"):
        np.testing.assert_array_equal(getattr(fast.far, name), getattr(reference.far, name))
    np.testing.assert_allclose(fast.far.off, reference.far.off, rtol=0.0, atol=1e-12)
    np.testing.assert_allclose(fast.sections.moments, reference.sections.moments, rtol=1e-11, atol=1e-10)


@pytest.mark.parametrize("stream", [False, True])
def test_a_scan_is_placed_and_binned_alike(stream, tmp_path, monkeypatch):
    """From the file to the cells: what the report rests on."""
    design, scan = tmp_path / "one.toml", thinner_example(tmp_path, 6)
    design.write_text(ONE)
    monkeypatch.setattr(streaming, "SAMPLE", 15_000)
    measured = []
    for least in (sys.maxsize, 0):
        monkeypatch.setattr(compiled, "LEAST", least)
        measured.append(measure(read_design(design), [scan], loop=False, stream=stream))
    reference, fast = measured
    for a, b in (
        (fast.placed.registration.pose.rotation, reference.placed.registration.pose.rotation),
        (fast.placed.registration.pose.translation, reference.placed.registration.pose.translation),
        (fast.first.points.deviation, reference.first.points.deviation),
        (fast.first.scatter, reference.first.scatter),
    ):
        np.testing.assert_allclose(a, b, rtol=0.0, atol=1e-10)  # a fit on these: rounding times its condition
    np.testing.assert_array_equal(fast.first.count, reference.first.count)
