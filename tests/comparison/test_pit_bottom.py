"""A pit that no section shows may lie where thickness is measured: how thin the tooth is then, by hand."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from gearwear.comparison.thick import _at_radius, _pit_bottom
from gearwear.design.surface import FLANK
from gearwear.placing.cells import CellGrid
from gearwear.wear.section_sums import SectionBand
from tests.placing.placing import designed
from tests.report.fake import fake_results, fake_thickness

TURN = 1.07
"""Arc per depth."""
THICK = replace(fake_thickness({}), turn=TURN)
REGIONS = fake_results().wear.found.regions
"""Of teeth 2, 1 and 3, 1550, 200 and 120 µm deep."""

THERE = np.ones((12, 2), dtype=bool), np.zeros((12, 2))
"""Pits of all flanks reach to where thickness is measured."""


@pytest.mark.parametrize(("teeth", "depth"), [((), -math.inf), ((2,), 0.12), ((0, 2), 0.2), ((5,), 0.0)])
def test_the_deepest_pits_of_both_flanks_may_meet(teeth, depth):
    wear, pits = fake_results().wear.found, np.isin(np.arange(12), teeth)
    assert _pit_bottom(THICK, wear, pits, THERE) == pytest.approx(THICK.nominal - TURN * depth)
    both = replace(wear, regions=(*REGIONS, *(replace(region, side=region.side.opposite) for region in REGIONS)))
    assert _pit_bottom(THICK, both, pits, THERE) == pytest.approx(THICK.nominal - 2.0 * TURN * depth)


def test_sections_that_were_pooled_do_not_tell_that_none_lies_there():
    for pooled, low in ((5, 9.5), (1, THICK.thinnest().low)):
        thickness = replace(THICK, pooled=pooled, pit_bottom=9.5)
        assert thickness.thinnest().low == pytest.approx(low, abs=0.01)
        assert thickness.thinnest().value == pytest.approx(THICK.thinnest().value, abs=0.01)


def test_pits_elsewhere_on_the_flank_take_nothing_off_beyond_what_is_worn_there():
    wear, elsewhere = fake_results().wear.found, np.zeros((12, 2), dtype=bool)
    worn = np.full((12, 2), 0.01)
    assert _pit_bottom(THICK, wear, np.arange(12) == 2, (elsewhere, worn)) == pytest.approx(THICK.nominal - TURN * 0.02)


@pytest.mark.parametrize(("off", "reaches"), [(0.0, True), (-1.2, False), (1.2, False)])
def test_a_pit_reaches_the_radius_by_its_cells(off, reaches):
    """A cell with a pit of 0.3 mm depth whose middle is some widths of a cell, and the band's half, off the radius."""
    gear = designed()
    grid, band = CellGrid.for_scan(gear, 100_000), SectionBand.of(gear)
    width = float(np.abs(np.diff(grid.roll_edges)).max())
    column = int(grid.flank_column(band.reach + off * width + np.sign(off) * band.half))
    on_flanks = np.zeros((12, 2, grid.rows, grid.flank), dtype=bool)
    on_flanks[4, 1, 3, column] = True
    hung = np.zeros(grid.count, dtype=bool)
    start, size = grid.blocks[FLANK]
    hung[start : start + size] = on_flanks.ravel()
    mask = grid.sides(hung)
    there, deep = _at_radius(
        SimpleNamespace(grid=grid, far=SimpleNamespace(hung=hung)),
        SimpleNamespace(mask=mask, depth=np.where(mask, 0.3, 0.0)),
        band,
    )
    assert np.argwhere(there).tolist() == ([[4, 1]] if reaches else [])
    assert deep.max() == (0.3 if reaches else 0.0)
