"""The loop on fewer cells finds what it finds on all, and tells it on all."""

from __future__ import annotations

import numpy as np
import pytest

from gearwear.comparison.closing import find_effects
from gearwear.comparison.measured_gear import MeasuredGear, register
from gearwear.design import Design, Gear, GearSpec
from gearwear.design.side import Side
from gearwear.diagnose import pooled
from gearwear.diagnose.masks import sound_cells
from gearwear.diagnose.pooled import ENOUGH_CELLS, FEWEST_ROWS, MOST_CELLS, ROUGH_ROWS, loop_grid, rough_grid
from gearwear.diagnose.side_costs import SideCosts
from gearwear.diagnose.worn_sides import side_costs
from gearwear.placing.cells import CellGrid
from gearwear.scan.types import Scan
from tests.synthetic import Effect, GearNumbers, Patch, Recipe, SlidingWear, make_scan

pytestmark = pytest.mark.long

COAT, CROWNING = 15.0, 12.0
FEWER = 4000


@pytest.mark.parametrize(("teeth", "module", "width"), [(25, 3.0, 30.0), (80, 3.0, 60.0), (150, 3.0, 100.0), (600, 1.0, 20.0)])
@pytest.mark.parametrize("points", [500_000, 20_000_000])
def test_the_cells_are_bounded(teeth, module, width, points):
    grid = CellGrid.for_scan(Gear.from_spec(GearSpec("gear", teeth, module, width)), points)
    fewer = loop_grid(grid)
    assert grid.count > ENOUGH_CELLS >= fewer.count or fewer.rows == min(grid.rows, FEWEST_ROWS)
    assert fewer.rows <= grid.rows and fewer.ring <= grid.ring
    # Columns are kept as long as all cells are not too many.
    assert fewer.flank == grid.flank or (fewer.flank < grid.flank and fewer.count > MOST_CELLS / 2)
    rough = rough_grid(grid)
    assert rough.rows >= ROUGH_ROWS and rough.count < 0.6 * fewer.count


def test_a_small_gear_keeps_its_cells():
    grid = CellGrid.for_scan(Gear.from_spec(GearSpec("gear", 12, 6.35, 15.0)), 40_000)
    assert grid.count < ENOUGH_CELLS
    assert loop_grid(grid) is grid
    assert rough_grid(grid) is None


def test_a_dense_scan_of_a_small_gear_keeps_its_columns():
    grid = CellGrid.for_scan(Gear.from_spec(GearSpec("gear", 12, 6.35, 15.0)), 500_000)
    fewer = loop_grid(grid)
    assert fewer.count <= ENOUGH_CELLS < grid.count <= MOST_CELLS
    assert (fewer.flank, fewer.fillet, fewer.tip) == (grid.flank, grid.fillet, grid.tip)
    assert rough_grid(grid) is None  # the loop itself tells as soon


def test_a_scan_far_off_is_located_alike_by_a_rough_look():
    """A table off by 0.3° twice round moves points by a thirtieth of a module: what few cells say of it puts them where it belongs."""
    table = Effect("turntable_angle", {"amplitude_deg": 0.3, "order": 2, "phase_deg": 40.0})
    recipe = Recipe(noise_um=8.0, effects=(table,), wear=(Patch(1, 1, 200.0, (36.1, 44.6), (-4.0, 10.0)),)).of_size(40_000)
    points = make_scan(recipe, 5).points
    scan = Scan(points, None, None, "cloud", (), {}, np.zeros(len(points), np.int8))
    spec = GearSpec("gear", 12, 6.35, 15.0, rack_tip_radius=0.3)
    measured = register(Design({"gear": Gear.from_spec(spec)}), scan)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(pooled, "ENOUGH_CELLS", FEWER)
        patch.setattr(pooled, "MOST_CELLS", FEWER)
        patch.setattr(pooled, "ROUGH_CELLS", FEWER // 2)
        assert rough_grid(measured.first.grid).count < FEWER
        by_few = find_effects(measured)
        patch.setattr("gearwear.comparison.closing.rough_grid", lambda grid: None)
        patch.setattr("gearwear.comparison.closing.loop_grid", lambda grid: grid)
        by_many = find_effects(measured)
    (few,), (many,) = by_few.loop.effects, by_many.loop.effects
    assert few.name == many.name == "turntable_angle"
    assert by_few.placed.located is not measured.placed.located  # it is far
    for key, value in many.parameters.items():
        assert abs(few.parameters[key].value - value.value) <= 0.1 * value.std
    size = few.parameters["amplitude_deg"]
    assert abs(size.value - 0.3) < 3.0 * size.std


@pytest.mark.parametrize(("depth", "asked", "left_open"), [(60.0, 1, 1), (11.0, 2, 3), (4.0, 2, 4)])
def test_which_sides_are_worn_is_asked_again_where_there_is_doubt(depth, asked, left_open, monkeypatch):
    """Sliding wear of 60 µm is beyond doubt at the first look, of 4 µm at none; in between some sides are out of question, and not asked about again."""
    shares = (1.0, 0.85, 1.15, 0.9, 1.1, 1.05, 0.95, 1.0, 0.87, 1.12, 0.93, 1.08)
    recipe = Recipe(noise_um=8.0, wear=(SlidingWear(depth, 1, shares),)).of_size(40_000)
    points = make_scan(recipe, 5).points
    scan = Scan(points, None, None, "cloud", (), {}, np.zeros(len(points), np.int8))
    measured = register(Design({"gear": Gear.from_spec(GearSpec("gear", 12, 6.35, 15.0, rack_tip_radius=0.3))}), scan)
    for name, cells in (("ENOUGH_CELLS", FEWER), ("MOST_CELLS", FEWER), ("ROUGH_CELLS", FEWER // 2)):
        monkeypatch.setattr(pooled, name, cells)
    costs, looks = list[SideCosts](), list[bool]()

    def counted(*asked):
        looks.append(asked[-1])
        costs.append(side_costs(*asked))
        return costs[-1]

    monkeypatch.setattr("gearwear.diagnose.loop.side_costs", counted)
    found = find_effects(measured)
    assert looks == [True, False][:asked]
    assert costs[0].beyond_doubt == (asked == 1)
    ruled_out = costs[0].ruled_out
    assert len(costs[0].by_sides) - len(ruled_out) == left_open
    assert asked == 1 or not (ruled_out & costs[1].by_sides.keys())
    assert depth < 10.0 or found.loop.worn_sides == frozenset({Side.LEFT})


@pytest.fixture(scope="module")
def both() -> tuple[MeasuredGear, MeasuredGear]:
    """A coated and crowned gear with a worn place, its loop closed on all cells and on `FEWER`."""
    recipe = Recipe(
        noise_um=8.0,
        effects=(Effect("coating", {"thickness_um": COAT}), Effect("helix_crowning", {"crowning_um": CROWNING})),
        wear=(Patch(1, 1, 200.0, (36.1, 44.6), (-4.0, 10.0)),),
    ).of_size(60_000)
    points = make_scan(recipe, 3).points
    scan = Scan(points, None, None, "cloud", (), {}, np.zeros(len(points), np.int8))
    spec = GearSpec("gear", 12, 6.35, 15.0, rack_tip_radius=0.3)
    measured = register(Design({"gear": Gear.from_spec(spec)}), scan)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("gearwear.comparison.closing.loop_grid", lambda grid: grid)
        whole = find_effects(measured)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(pooled, "ENOUGH_CELLS", FEWER)
        patch.setattr(pooled, "MOST_CELLS", FEWER)
        assert loop_grid(measured.first.grid).count <= FEWER < measured.first.grid.count
        return whole, find_effects(measured)


def test_the_same_effects_of_the_same_size(both):
    whole, fewer = (
        {(one.name, key): value for one in measured.loop.effects for key, value in one.parameters.items()} for measured in both
    )
    assert whole.keys() == fewer.keys() == {("coating", "thickness_um"), ("helix_crowning", "crowning_um")}
    for key, truth in zip(sorted(whole), (COAT, CROWNING), strict=True):
        assert abs(fewer[key].value - truth) < 3.0 * fewer[key].std
        assert abs(fewer[key].value - whole[key].value) < whole[key].std
        assert fewer[key].std == pytest.approx(whole[key].std, rel=0.25)


def test_it_is_told_on_the_cells_of_the_scan(both):
    whole, fewer = both
    cells = fewer.first
    assert len(fewer.loop.use) == len(cells.count) == len(fewer.loop.residual_after)
    assert not (fewer.loop.use & ~sound_cells(cells, frozenset())).any()
    used = fewer.loop.use & whole.loop.use
    assert used.sum() > 0.8 * whole.loop.use.sum()
    for one, other in (
        (fewer.loop.residual_before, whole.loop.residual_before), (fewer.loop.residual_after, whole.loop.residual_after)
    ):  # fmt: skip
        assert np.std((one - other)[used]) < 0.3 * np.std(other[used])
    assert fewer.loop.covariance.grid is cells.grid
    assert fewer.loop.hidden.shape[0] == len(cells.count)


def test_worn_teeth_side_by_side_are_no_waves_round_the_gear():
    """Twenty of sixty, worn on both sides by 26 µm: on many cells of few points their wear stood out late, when waves had taken most of it."""
    teeth, worn = 60, (np.arange(60) >= 12) & (np.arange(60) < 32)
    factors = tuple(worn.astype(float))
    recipe = Recipe(
        gear=GearNumbers(teeth, 1.0, 10.0), jitter=1.0, noise_um=5.0, pose="none",
        wear=(SlidingWear(26.0, 1, factors), SlidingWear(26.0, -1, factors)),
    )  # fmt: skip
    scan = make_scan(recipe.of_size(110_000), 4)
    cloud = Scan(scan.points, None, None, "cloud", (), {}, np.zeros(len(scan.points), np.int8))
    loop = find_effects(register(Design({"gear": Gear.from_spec(GearSpec("gear", teeth, 1.0, 10.0))}), cloud)).loop
    assert [effect.name for effect in loop.effects] == []
    assert not loop.patterns and not loop.worn_sides
