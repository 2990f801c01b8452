"""A tip, a face width or a scale off the drawn one: no other effect is named for it, and wear does not follow.

The scans are those of the families, whose generator imports nothing of the package; tests of the loop alone take the scan of `tests.synthetic`.
"""

from __future__ import annotations

import numpy as np
import pytest

import gearwear as gw
from benchmarks.families.families import case
from benchmarks.families.files import write_case
from gearwear.comparison.closing import measure
from gearwear.design import read_design
from gearwear.design.surface import FLANK, locate
from gearwear.diagnose.loop import close_loop, make_context
from gearwear.diagnose.masks import sound_cells
from gearwear.placing.cells import CellGrid, bin_points, noise
from tests.placing.placing import designed
from tests.synthetic import Effect, GearNumbers, Recipe, SlidingWear, make_scan


@pytest.mark.long
@pytest.mark.parametrize("number", [0, 6], ids=["tips 50 µm low", "ends 40 µm low"])
def test_tips_and_ends_that_lie_low_are_no_relief(number, tmp_path):
    """Points of a land lie nearer to the flank, as that is drawn up to the higher tip: also where a worn side has turned the first pose."""
    design, scans, truth = write_case(case("a", number, 51, 40_000), tmp_path)
    measured = measure(read_design(design), scans)
    wear = gw.find_wear(measured)
    assert [effect.name for effect in measured.loop.effects] == []
    assert abs(wear.volume - truth["volume_mm3"]) < 2.0 * wear.volume_std


@pytest.mark.parametrize(("drawn", "left_out"), [(15.1, True), (15.0, False), (14.9, False)])
def test_rows_next_to_an_end_that_lies_low_tell_nothing(drawn, left_out):
    gear = designed(GearNumbers(face_width=drawn))
    points = make_scan(Recipe(noise_um=6.0, pose="none").of_size(20_000), 3).points
    points[:, 2] += 0.5 * (drawn - 15.0)
    located = locate(points, gear)
    cells = bin_points(located, CellGrid.for_scan(gear, len(located)), clip=0.3)
    sound = cells.grid.flank_shape(np.where(cells.points.surface == FLANK, sound_cells(cells, frozenset()), 0.0))
    rows = sound.mean(axis=(0, 1, 3))
    assert (rows[[0, -1]].max() == 0.0) == left_out
    assert rows[1:-1].min() > 0.5


@pytest.mark.long
def test_a_scale_is_found_beside_wear_of_both_sides():
    """Without wear it comes out of the search as it is, beside it a coat and an axis that is off would be in its place."""
    numbers = GearNumbers(21, 4.0, 20.0, profile_shift=0.2)
    wear = tuple(SlidingWear(37.0, side, law="archard") for side in (1, -1))
    recipe = Recipe(
        numbers, jitter=1.0, noise_um=9.0, pose="none", wear=wear, effects=(Effect("scale", {"relative_ppm": 1500.0}),)
    )
    gear = designed(numbers)
    located = locate(make_scan(recipe.of_size(30_000), 4).points, gear)
    cells = bin_points(located, CellGrid.for_scan(gear, len(located)), clip=0.3)
    loop = close_loop(cells, noise(cells), make_context(cells, np.eye(3), False))
    assert len(loop.worn_sides) == 2
    (scale,) = loop.effects
    value = scale.parameters["relative_ppm"]
    assert (scale.name, abs(value.value - 1500.0) < 3.0 * value.std) == ("scale", True)
