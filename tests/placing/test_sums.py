"""Cells of a scan in chunks are the cells of the scan."""

from __future__ import annotations

import numpy as np
import pytest

from gearwear.design.gear import Gear
from gearwear.design.spec import GearSpec
from gearwear.design.surface import FLANK, SurfacePoints, flank_points
from gearwear.placing.cells import CellGrid, Cells, bin_points, cells_of
from gearwear.placing.in_cells import InCells
from gearwear.placing.pits import FarReach, find_far_points, hanging_together
from gearwear.placing.strays import StrayLimits, near_centre
from gearwear.placing.sums import CellSums
from gearwear.wear.section_sums import SectionBand, SectionSums

PINION = Gear.from_spec(GearSpec("pinion", 12, 6.35, 15.0))
POINTS = 30_000
GRID = CellGrid.for_scan(PINION, POINTS)
CHUNKS = [POINTS, 10_000, 7_001, 997]


def scattered() -> SurfacePoints:
    """Points all over the flanks, worn half a millimetre at one place, with noise, strays, and a pit."""
    rng = np.random.default_rng(4)
    tooth, side = rng.integers(0, PINION.teeth, POINTS), rng.choice([-1, 1], POINTS)
    roll = rng.uniform(PINION.form_roll, PINION.tip_roll, POINTS)
    z = rng.uniform(0.0, PINION.face_width, POINTS)
    points = flank_points(PINION, tooth, side, roll, z)
    deviation = 0.01 * rng.standard_normal(POINTS) - 0.5 * np.exp(-((z - 7.0) ** 2)) * (tooth == 2)
    deviation[rng.random(POINTS) < 0.003] += 0.4
    pit = (tooth == 5) & (side > 0) & (np.hypot(z - 8.0, roll - 0.5 * (PINION.form_roll + PINION.tip_roll)) < 1.0)
    return points.with_deviation(deviation - 0.08 * (pit & (rng.random(POINTS) < 0.3)))


def parts(points: SurfacePoints, size: int) -> list[SurfacePoints]:
    return [points.take(np.arange(start, min(start + size, len(points)))) for start in range(0, len(points), size)]


def assert_same(cells: Cells, whole: Cells, accuracy: float) -> None:
    for one, other in (
        (cells.count, whole.count), (cells.points.position, whole.points.position), (cells.points.normal, whole.points.normal),
        (cells.lever, whole.lever), (cells.points.roll, whole.points.roll), (cells.points.deviation, whole.points.deviation),
        (cells.scatter, whole.scatter), (cells.highest, whole.highest),
    ):  # fmt: skip
        np.testing.assert_allclose(one, other, rtol=accuracy, atol=accuracy)  # type: ignore[arg-type]


@pytest.mark.parametrize("size", CHUNKS)
def test_chunks_of_any_size_give_the_cells_of_the_whole(size: int) -> None:
    points = scattered()
    whole = bin_points(points, GRID)

    sums = CellSums.empty(GRID.count)
    for part in parts(points, size):
        sums.add(part, GRID.index(part))

    # Lever arms are sums of products of 40 mm: 1e-12 of that.
    assert_same(cells_of(sums, GRID), whole, 0.0 if size == POINTS else 4e-11)


def test_scatter_does_not_suffer_from_what_all_points_have_in_common() -> None:
    points = scattered()
    far = points.with_deviation(points.deviation + 1000.0)

    sums = CellSums.empty(2)
    for part in parts(far, 997):
        sums.add(part, np.ones(len(part), np.int64))

    # By numpy, in two passes over all points at once.
    assert np.sqrt(sums.squares[1] / (POINTS - 1)) == pytest.approx(np.std(points.deviation, ddof=1), rel=1e-9)


@pytest.mark.parametrize("size", CHUNKS)
def test_strays_are_told_alike_chunk_by_chunk(size: int) -> None:
    points = scattered()
    cell = GRID.index(points)
    limits = StrayLimits.of(points.deviation, cell, GRID, 0.06)

    held = np.concatenate([limits.hold(part.deviation, GRID.index(part)) for part in parts(points, size)])

    np.testing.assert_array_equal(held, near_centre(points.deviation, cell, GRID, 0.06))
    assert 0 < (~held).sum() < 0.02 * POINTS


def test_cells_of_a_pass_before_tell_the_same_strays() -> None:
    points = scattered()
    cell = GRID.index(points)
    own = StrayLimits.of(points.deviation, cell, GRID, 0.06).hold(points.deviation, cell)
    before = bin_points(points, GRID, clip=0.06)

    held = StrayLimits.round(before, 0.06).hold(points.deviation, cell)

    strays = (points.deviation > 0.3) & (points.tooth != 2)  # beside deep wear one may lie among what is steep
    assert not own[strays].any() and not held[strays].any()
    assert (own != held).mean() < 1e-3


@pytest.mark.parametrize("size", CHUNKS)
def test_pits_are_told_alike_chunk_by_chunk(size: int) -> None:
    points = scattered()
    far, belongs = find_far_points(points, GRID.index(points), GRID)
    assert far.hung.any()  # the pit

    reach = FarReach.of(points, GRID.index(points), GRID)
    tally = None
    for part in parts(points, size):
        own = reach.tally(part, GRID.index(part))
        tally = own if tally is None else tally.plus(own)
    assert tally is not None
    pits = hanging_together(tally, reach)

    np.testing.assert_array_equal(pits.far.hung, far.hung)
    np.testing.assert_array_equal(pits.far.below, far.below)
    np.testing.assert_array_equal(pits.far.above, far.above)
    assert pits.far.depth == pytest.approx(far.depth, rel=1e-12)
    held = np.concatenate([pits.hold(part, GRID.index(part)) for part in parts(points, size)])
    np.testing.assert_array_equal(held, belongs)


@pytest.mark.parametrize("size", CHUNKS)
def test_sums_over_sections_add(size: int) -> None:
    points, band = scattered(), SectionBand.of(PINION)
    whole = SectionSums.of(points, band)

    sums = [SectionSums.of(part, band) for part in parts(points, size)]
    total = sums[0]
    for one in sums[1:]:
        total = total.plus(one)

    np.testing.assert_allclose(total.moments, whole.moments, rtol=1e-12, atol=1e-12)


def test_pooled_cells_hold_all_points() -> None:
    """Counts, means and squares about the common mean are those of the points, wherever the borders of cells lie."""
    points = scattered()
    fine = bin_points(points, GRID)
    coarse = CellGrid.for_scan(PINION, POINTS, size=3.0)

    pooled = fine.pooled(coarse)

    assert pooled.count.sum() == POINTS
    into = coarse.index(fine.points.take(fine.seen))
    cell = np.full(GRID.count, -1)
    cell[fine.seen] = into
    own = cell[GRID.index(points)]
    for one in np.unique(own)[::7]:
        deviation = points.deviation[own == one]
        assert pooled.points.deviation[one] == pytest.approx(deviation.mean(), rel=1e-12, abs=1e-12)
        assert pooled.scatter[one] == pytest.approx(deviation.std(ddof=1), rel=1e-10)
        assert pooled.highest is not None
        assert pooled.highest[one] == pytest.approx(deviation.max() - deviation.mean(), abs=1e-12)
    assert (pooled.points.surface[pooled.seen] == FLANK).all()


def test_points_in_cells_are_those_within_reach_and_those_of_pits() -> None:
    """Beside the pit the cells hold what `bin_points` leaves in them, and of the pit all its points."""
    points = scattered()
    lying = InCells.of(points, GRID, 0.06)
    np.testing.assert_array_equal(lying.cell, GRID.index(points))
    cells, belongs = lying.means()
    plain = bin_points(points, GRID, clip=0.06)
    assert cells.count.sum() == belongs.sum() > plain.count.sum() == lying.near.sum()
    assert cells.far is not None
    deep = (points.tooth == 5) & (points.side > 0) & (np.abs(points.deviation + 0.09) < 0.03)
    assert deep.any() and belongs[deep].all() and not lying.near[deep].all()
    np.testing.assert_array_equal(cells.count[~cells.far.hung], plain.count[~cells.far.hung])
    half = points.tooth < 6
    np.testing.assert_array_equal(lying.flanks(half).deviation, points.deviation[half & lying.near])
